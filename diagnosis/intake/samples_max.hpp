#pragma once

#include <cstddef>

namespace hybridtest::tuning {

/// Most rows of a recording: a diagnosis keeps all of them in memory. 70 minutes at 1 kHz.
inline constexpr std::size_t kSamplesMax = std::size_t{1} << 22U;

}  // namespace hybridtest::tuning
