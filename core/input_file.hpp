#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

/// Files that a user names: scenarios, site files, ground motions, recordings, profiles.
namespace hybridtest {

/// Why `file` cannot be read: "no such file", "it is a folder", "it is a named pipe". Nothing for a regular file.
///
/// Ask before opening: a program that opens a named pipe waits until somebody writes into it.
[[nodiscard]] std::optional<std::string> why_unreadable(const std::filesystem::path& file);

/// The whole file.
/// @param bytes_max   larger files are refused before they are read.
/// @param expected    what the file should be, for messages: "a ground motion".
/// @throws ConfigError at the file: see why_unreadable(); no permission, too large, or an error while reading.
[[nodiscard]] std::string read_input_file(const std::filesystem::path& file, std::size_t bytes_max,
                                          std::string_view expected);

}  // namespace hybridtest
