#pragma once

#include <filesystem>

#include "numerical_substructure/substructure_model.hpp"
#include "scenario/catalogue/part.hpp"

namespace hybridtest {

/// The model of a numerical substructure with `dofs` interface degrees of freedom.
/// @param directory   where files that it names are looked for.
[[nodiscard]] Maker<SubstructureModel> read_model(config::Section section, int dofs,
                                                  const std::filesystem::path& directory);

}  // namespace hybridtest
