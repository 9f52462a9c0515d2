#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "core/config/section.hpp"

namespace hybridtest {

/// A file that a scenario names by its path, and that a run keeps beside its scenario.
struct NamedFile {
  std::filesystem::path file;
  std::string written;      // the path in the scenario
  bool is_digested = true;  // its content is part of the scenario's digest
};

/// The file that the text at `key` names. A relative path starts at `directory`, the folder of the scenario file.
/// @return nothing for a file that is not there; it is reported at the key, with the full path that was tried.
[[nodiscard]] std::optional<std::filesystem::path> named_file(config::Section& section, std::string_view key,
                                                              const std::filesystem::path& directory);

}  // namespace hybridtest
