#include "validation/studies/rths_benchmark/reference.hpp"

#include <algorithm>
#include <cmath>

#include "validation/studies/rths_benchmark/criteria.hpp"
#include "validation/studies/rths_benchmark/frame.hpp"

namespace hybridtest::rths {

Reference make_reference(int case_number, const GroundMotion& motion) {
  const Frame frame = Frame::of_case(case_number);
  const auto samples = static_cast<std::size_t>(motion.end_s() * kSampleRateHz) + 1;
  Reference reference;
  for (auto& floor : reference.displacement_m) floor.reserve(samples);
  Frame::State state{};
  for (std::size_t i = 0; i < samples; ++i) {
    for (std::size_t floor = 0; floor < kFloors; ++floor) reference.displacement_m[floor].push_back(state[floor]);
    frame.step(state, motion, static_cast<double>(i) * kPeriodS, 0.0);
  }
  reference.peak_force_n = TransferSystemModel{}.stiffness_n_per_m * largest_magnitude(reference.displacement_m[0]);
  reference.noise_floor_percent = 100.0 * kDisplacementNoiseM / standard_deviation(reference.displacement_m[0]);
  return reference;
}

Floors every(const Reference& reference, int samples) {
  Floors chosen;
  const auto stride = static_cast<std::size_t>(samples);
  for (std::size_t floor = 0; floor < kFloors; ++floor) {
    for (std::size_t i = 0; i < reference.samples(); i += stride) {
      chosen[floor].push_back(reference.displacement_m[floor][i]);
    }
  }
  return chosen;
}

}  // namespace hybridtest::rths
