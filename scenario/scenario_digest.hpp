#pragma once

#include <string_view>

#include "core/messages.hpp"

namespace hybridtest {

/// SHA-256 (FIPS 180-4) of a text, by OpenSSL.
/// @throws std::runtime_error when the library cannot compute it.
[[nodiscard]] ScenarioDigest sha256(std::string_view text);

}  // namespace hybridtest
