#pragma once

#include <cstdint>
#include <vector>

#include "core/ground_motion_facts.hpp"

namespace hybridtest {

/// Acceleration of the ground at equally spaced times; linear in between, zero outside.
struct GroundMotion {
  double dt_s = 0.0;
  double start_s = 0.0;  // time of the first value
  std::vector<double> acceleration_m_per_s2;

  /// Linear interpolation; zero before the first value and after the last.
  [[nodiscard]] double at(double model_time_s) const noexcept;
  /// Time of the last value.
  [[nodiscard]] double end_s() const noexcept;
  /// Largest magnitude.
  [[nodiscard]] double peak_m_per_s2() const noexcept;
  [[nodiscard]] GroundMotionFacts facts() const noexcept;
  /// The values at 0, step_s, 2 step_s … last_step step_s.
  /// @param step_s      positive. @param last_step   not negative.
  [[nodiscard]] std::vector<double> sampled(double step_s, std::int64_t last_step) const;
  void multiply(double factor) noexcept;
};

}  // namespace hybridtest
