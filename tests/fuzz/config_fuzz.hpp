#pragma once

#include <cstddef>
#include <cstdint>

namespace hybridtest {

/// Result of one input.
enum class ConfigFuzzOutcome {
  refused,      // not a configuration at all
  with_errors,  // read to the end, errors listed
  accepted,     // no error; the effective configuration read back to the same text
};

/// Reads any bytes as a scenario. Lines that begin with `#set ` are its overrides.
/// Aborts when an accepted configuration does not read back to itself.
ConfigFuzzOutcome fuzz_config(const std::uint8_t* bytes, std::size_t size);

}  // namespace hybridtest
