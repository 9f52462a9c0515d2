#pragma once

#include <cstddef>

namespace hybridtest::tuning {

/// Most rows of a recording: a diagnosis keeps all of them in memory, with all that it makes of them about 2.6 kB per
/// row and degree of freedom. 35 minutes at 1 kHz.
inline constexpr std::size_t kSamplesMax = std::size_t{1} << 21U;

}  // namespace hybridtest::tuning
