#pragma once

#include <array>
#include <vector>

#include "coordinator/excitation/ground_motion.hpp"
#include "validation/studies/rths_benchmark/constants.hpp"

namespace hybridtest::rths {

/// The motion of the whole computed frame: the exact result of a hybrid test.
struct Reference {
  std::array<std::vector<double>, kFloors> displacement_m;  // by floor, each sample
  double peak_force_n = 0.0;                                // of the specimen, k x_1
  double noise_floor_percent = 0.0;                         // sensor noise over the deviation of x_1

  [[nodiscard]] std::size_t samples() const noexcept { return displacement_m[0].size(); }
  /// The force of the reference specimen is so near to the limit that reaching it does not mean a lost run.
  [[nodiscard]] bool is_near_force_limit() const noexcept { return peak_force_n >= kExcusedShare * kForceLimitN; }
};

/// @param case_number   1 to 4.
/// @param motion        already scaled; the record ends with it.
[[nodiscard]] Reference make_reference(int case_number, const GroundMotion& motion);

/// By floor, one sample in `samples`, beginning with the first.
using Floors = std::array<std::vector<double>, kFloors>;
[[nodiscard]] Floors every(const Reference& reference, int samples);

}  // namespace hybridtest::rths
