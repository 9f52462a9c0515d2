#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "numerical_substructure/substructure_model.hpp"
#include "scenario/catalogue/part.hpp"
#include "scenario/named_file.hpp"

namespace hybridtest {

/// The degrees of freedom of an interface, as springs of a model name them.
struct NamedInterface {
  std::vector<std::string> names;  // in order
  /// The position of the one with this name or address; nothing for another one.
  std::function<std::optional<int>(const std::string& address)> find;
};

/// The model of a numerical substructure.
/// @param directory   where files that it names are looked for.
/// @param step_s      of the test.
/// @param files       those files are added.
[[nodiscard]] Maker<SubstructureModel> read_model(config::Section section, const NamedInterface& interface,
                                                  const std::filesystem::path& directory, double step_s,
                                                  std::vector<NamedFile>& files);

}  // namespace hybridtest
