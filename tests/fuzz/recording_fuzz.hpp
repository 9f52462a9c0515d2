#pragma once

#include <cstddef>
#include <cstdint>

namespace hybridtest {

/// Reads any bytes as a recording. Aborts when an accepted one is not finite, not even or ragged, when it
/// does not read back to itself, or when a refused one comes without a reason.
/// @return whether it was accepted.
bool fuzz_recording(const std::uint8_t* bytes, std::size_t size);

}  // namespace hybridtest
