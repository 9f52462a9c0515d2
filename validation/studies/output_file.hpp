#pragma once

#include <filesystem>
#include <string_view>

namespace hybridtest {

/// Makes the directory of a study's results, if it is not there.
/// @throws ConfigError where that cannot be.
void prepare_output_directory(const std::filesystem::path& directory);

/// Writes a whole file, over one that is there.
/// @throws ConfigError where it cannot be written in full.
void write_output_file(const std::filesystem::path& file, std::string_view text);

}  // namespace hybridtest
