#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "core/config/section.hpp"

namespace hybridtest {

/// The file that the text at `key` names. A relative path starts at `directory`, the folder of the scenario file.
/// @return nothing for a file that is not there; it is reported at the key, with the full path that was tried.
[[nodiscard]] std::optional<std::filesystem::path> named_file(config::Section& section, std::string_view key,
                                                              const std::filesystem::path& directory);

}  // namespace hybridtest
