#pragma once

#include <filesystem>
#include <string_view>

namespace hybridtest {

/// Makes the directory of a study's results, if it is not there.
/// @throws ConfigError when this is not possible.
void prepare_output_directory(const std::filesystem::path& directory);

/// Writes a whole file; replaces an existing one.
/// @throws ConfigError when it cannot be written completely.
void write_output_file(const std::filesystem::path& file, std::string_view text);

}  // namespace hybridtest
