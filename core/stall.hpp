#pragma once

namespace hybridtest {

/// Longer than a busy ordinary operating system keeps a process waiting.
inline constexpr double kStall_s_min = 0.05;

/// Whether a step of a paced test took so long that the sites had to hold their specimens: they move on for one
/// step beyond the last target, and hold then.
/// @param taken_s   wall time of this step.
/// @param step_s    wall time that a step has: its model time times `time_scale`.
[[nodiscard]] constexpr bool is_stall(double taken_s, double step_s) noexcept {
  return taken_s > 2.0 * step_s + kStall_s_min;
}

}  // namespace hybridtest
