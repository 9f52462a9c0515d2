#pragma once

#include <cstddef>
#include <cstdint>

namespace hybridtest {

/// What a session of an element of two degrees of freedom made of the bytes.
enum class GenericClientOutcome : std::uint8_t {
  waiting,   // the first eleven sizes did not come
  refused,   // a fault in them
  accepted,  // its client, and all that followed was understood
  lost,      // its client, and then a fault
};

/// Reads any bytes as those of an element genericClient, whole and in portions. Aborts when the portions change what is
/// understood, when a trial is not finite or has another size, or when a reply has not the size of a message.
GenericClientOutcome fuzz_generic_client(const std::uint8_t* bytes, std::size_t size);

}  // namespace hybridtest
