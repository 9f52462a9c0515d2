#pragma once

#include <algorithm>
#include <cmath>
#include <string_view>

#include "plant/effects/effect.hpp"

namespace hybridtest {

/// What an effect of degradation says of itself under one driver.
struct DegradationWords {
  std::string_view equation;
  std::string_view parameter;
  std::string_view what;
};

// What a specimen degrades with. Each driver is given every sample once and returns how much of it there has been,
// never less than before; StiffnessDegradation and StrengthDegradation take one of them.

/// Path: what a specimen without hysteresis has in place of dissipated energy.
class TravelledPath {
 public:
  static constexpr std::string_view kUnit = "m";
  static constexpr std::string_view kSource = "after Baber and Wen (1981)";
  static constexpr bool kNeedsTime = false;
  static constexpr DegradationWords kStiffness{"F = s^q F0(x s^(1 - q)), s = 1 / (1 + S / L), S = travelled path",
                                               "half_life_m", "L, path after which it is half as stiff"};
  static constexpr DegradationWords kStrength{"F = s F0(x / s), s = exp(-S / L), S = travelled path", "path_m",
                                              "L, path after which 37 % of the strength are left"};

  [[nodiscard]] double after(const StageSample& sample) noexcept {
    path_m_ += std::abs(sample.motion.displacement_m - displacement_m_);
    displacement_m_ = sample.motion.displacement_m;
    return path_m_;
  }

 private:
  double path_m_ = 0.0;
  double displacement_m_ = 0.0;
};

class LargestDisplacement {
 public:
  static constexpr std::string_view kUnit = "m";
  static constexpr std::string_view kSource = "after Park and Ang (1985)";
  static constexpr bool kNeedsTime = false;
  static constexpr DegradationWords kStiffness{
      "F = s^q F0(x s^(1 - q)), s = 1 / (1 + X / L), X = largest displacement so far", "half_life_m",
      "L, largest displacement at which it is half as stiff"};
  static constexpr DegradationWords kStrength{"F = s F0(x / s), s = exp(-X / L), X = largest displacement so far",
                                              "decay_m",
                                              "L, largest displacement at which 37 % of the strength are left"};

  [[nodiscard]] double after(const StageSample& sample) noexcept {
    largest_m_ = std::max(largest_m_, std::abs(sample.motion.displacement_m));
    return largest_m_;
  }

 private:
  double largest_m_ = 0.0;
};

/// Work of the specimen's force between two of its zeros, where nothing is stored. The force of a sample is known at
/// the next one.
class DissipatedEnergy {
 public:
  static constexpr std::string_view kUnit = "J";
  static constexpr std::string_view kSource = "Baber and Wen (1981)";
  static constexpr bool kNeedsTime = false;
  static constexpr DegradationWords kStiffness{"F = s^q F0(x s^(1 - q)), s = 1 / (1 + E / L), E = dissipated energy",
                                               "half_life_j", "L, energy after which it is half as stiff"};
  static constexpr DegradationWords kStrength{"F = s F0(x / s), s = exp(-E / L), E = dissipated energy", "decay_j",
                                              "L, energy after which 37 % of the strength are left"};

  [[nodiscard]] double after(const StageSample& sample) noexcept {
    const double way_m = displacement_m_ - before_m_;
    if (force_n_ * sample.force_n <= 0.0 && force_n_ != sample.force_n) {
      const double at_zero_j = work_j_ + 0.5 * force_n_ * way_m * force_n_ / (force_n_ - sample.force_n);
      dissipated_j_ = std::max(dissipated_j_, at_zero_j);
    }
    work_j_ += 0.5 * (force_n_ + sample.force_n) * way_m;
    force_n_ = sample.force_n;
    before_m_ = displacement_m_;
    displacement_m_ = sample.motion.displacement_m;
    return dissipated_j_;
  }

 private:
  double work_j_ = 0.0;
  double dissipated_j_ = 0.0;
  double force_n_ = 0.0;
  double before_m_ = 0.0;
  double displacement_m_ = 0.0;
};

/// Cycles about zero, in halves: the motion has come to the other side by a tenth of the largest displacement so far.
/// Smaller motions, noise among them, are not counted.
class CountedCycles {
 public:
  static constexpr std::string_view kUnit = "";
  static constexpr std::string_view kSource = "after Krawinkler and Zohrei (1983)";
  static constexpr bool kNeedsTime = false;
  static constexpr DegradationWords kStiffness{"F = s^q F0(x s^(1 - q)), s = 1 / (1 + N / L), N = cycles so far",
                                               "half_life_cycles", "L, cycles after which it is half as stiff"};
  static constexpr DegradationWords kStrength{"F = s F0(x / s), s = exp(-N / L), N = cycles so far", "decay_cycles",
                                              "L, cycles after which 37 % of the strength are left"};

  [[nodiscard]] double after(const StageSample& sample) noexcept {
    constexpr double kSmallestShare = 0.1;
    const double displacement_m = sample.motion.displacement_m;
    largest_m_ = std::max(largest_m_, std::abs(displacement_m));
    if (side_ == 0.0) {
      if (displacement_m != 0.0) side_ = std::copysign(1.0, displacement_m);
    } else if (side_ * displacement_m < -kSmallestShare * largest_m_) {
      side_ = -side_;
      cycles_ += 0.5;
    }
    return cycles_;
  }

 private:
  double largest_m_ = 0.0;
  double side_ = 0.0;
  double cycles_ = 0.0;
};

/// Time, as where a specimen warms up.
class ElapsedTime {
 public:
  static constexpr std::string_view kUnit = "s";
  static constexpr std::string_view kSource = "after Makris (1998)";
  static constexpr bool kNeedsTime = true;
  static constexpr DegradationWords kStiffness{"F = s^q F0(x s^(1 - q)), s = 1 / (1 + t / L), t = time", "half_life_s",
                                               "L, time after which it is half as stiff"};
  static constexpr DegradationWords kStrength{"F = s F0(x / s), s = exp(-t / L), t = time", "decay_s",
                                              "L, time after which 37 % of the strength are left"};

  [[nodiscard]] double after(const StageSample& sample) noexcept {
    time_s_ = std::max(time_s_, sample.time_s);
    return time_s_;
  }

 private:
  double time_s_ = 0.0;
};

}  // namespace hybridtest
