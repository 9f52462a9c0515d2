#pragma once

namespace hybridtest {

/// From when on a line of `hybridtest check` is a caution. A line fails where the test would be unstable, break a
/// limit, or rest on a number that is plainly wrong; those bounds are nobody's choice.
struct CheckPolicy {
  /// Step over the stability limit: omega dt of the highest mode is 1 then, and its period 5 % too short.
  double step_use = 0.5;
  /// Period error of a mode that counts. A response spectrum changes by as much from one period to the next.
  double period_error = 0.05;
  /// Numerical damping of a mode that counts, over its physical one: the answer is then damped by half as much again.
  double numerical_damping = 0.5;
  /// A mode counts with this share of the mass: those that codes leave out together have a tenth (EN
  /// 1998-1, 4.3.3.3.1).
  double mass_share = 0.05;
  /// Delay that remains, as a share of the delay at which the test turns unstable. A delay takes damping away in
  /// proportion, so that half of the damping of some mode is gone.
  double delay_use = 0.5;
  /// Predicted peak over limit or rating. Strength and stiffness of a new specimen are rarely known to better than a
  /// fifth.
  double peak_use = 0.8;
  /// Standard deviation of a compensator's command or force over that of noise at its input. Third-order extrapolation
  /// by one spacing, which is common practice, has 8.4.
  double noise_gain = 10.0;
  /// Standard deviation of the command for noise of the load cell, over the displacement limit: what a displacement
  /// transducer does not show any more.
  double noise_use = 0.001;
};

}  // namespace hybridtest
