#pragma once

#include <memory>

#include "validation/studies/compensation_methods.hpp"
#include "validation/studies/compensator_character/test_stand.hpp"

namespace hybridtest::character {

/// Amplitude of the sines that the study drives.
inline constexpr double kAmplitudeM = 0.003;

/// Displacement and its first two derivatives.
struct Motion {
  double displacement_m = 0.0;
  double velocity_m_per_s = 0.0;
  double acceleration_m_per_s2 = 0.0;
};

/// A sine that begins smoothly: for one second its amplitude grows as 3 t^2 - 2 t^3, derivatives exact.
class DrivenTarget {
 public:
  DrivenTarget(double amplitude_m, double frequency_hz);
  [[nodiscard]] Motion at(double time_s) const noexcept;

 private:
  double amplitude_m_;
  double omega_;
};

/// Noise added to the sensors and to the target.
struct Disturbance {
  double target_m = 0.0;
  double measured_displacement_m = 0.0;
  double measured_force_n = 0.0;
};

struct LoopSample {
  double command_m = 0.0;
  double structure_force_n = 0.0;  // received by the structure at this sample
};

/// A method on a stand, one sample at a time. Compensators on commands see the measurements of the sample before.
class MeasuredLoop {
 public:
  MeasuredLoop(const CompensationMethod& method, const StandKind& stand);
  [[nodiscard]] LoopSample advance(const Motion& target, const Disturbance& disturbance) noexcept;

 private:
  struct Measured {
    double displacement_m = 0.0;
    double force_n = 0.0;
  };
  bool has_loop_delay_;
  std::unique_ptr<TestStand> stand_;
  std::unique_ptr<Compensator> compensator_;
  std::unique_ptr<ForceCompensator> force_compensator_;
  Measured before_;
};

}  // namespace hybridtest::character
