#pragma once

#include <cstddef>
#include <cstdint>

namespace hybridtest {

/// What became of one input.
enum class WireFuzzOutcome {
  unreadable,  // not a sample of the type
  refused,     // a sample, but of no valid message
  accepted,
};

inline constexpr std::uint8_t kWireFuzzTopics = 7;

/// Reads any bytes as a sample from the network: the first byte picks the topic, the others are
/// the payload with its encapsulation header. Aborts when an accepted message does not come back
/// the same from being sent on.
WireFuzzOutcome fuzz_wire(const std::uint8_t* bytes, std::size_t size);

}  // namespace hybridtest
