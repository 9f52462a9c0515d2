#pragma once

#include <filesystem>
#include <string_view>

#include "core/messages.hpp"

namespace hybridtest {

/// SHA-256 (FIPS 180-4) of a text, by OpenSSL.
/// @throws std::runtime_error when the library cannot compute it.
[[nodiscard]] ScenarioDigest sha256(std::string_view text);
/// Of a file, of which a block is in memory. @throws ConfigError when it cannot be read.
[[nodiscard]] ScenarioDigest sha256_of_file(const std::filesystem::path& file);

}  // namespace hybridtest
