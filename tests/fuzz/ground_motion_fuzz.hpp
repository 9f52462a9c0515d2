#pragma once

#include <cstddef>
#include <cstdint>

namespace hybridtest {

/// Reads any bytes as a ground motion, by content and as AT2, with and without unit and step given.
/// Aborts when an accepted motion holds numbers that are not finite or no positive step, when it
/// leaves its own range between samples, or when it does not read back to itself.
/// @return whether any of the readings was accepted.
bool fuzz_ground_motion(const std::uint8_t* bytes, std::size_t size);

}  // namespace hybridtest
