#include "validation/studies/compensator_character/noise_gain.hpp"

#include <cmath>

#include "core/random.hpp"
#include "validation/studies/compensator_character/driven_target.hpp"

namespace hybridtest::character {
namespace {

constexpr double kFrequencyHz = 1.0;
constexpr double kNoiseSettleS = 8.0;
constexpr double kNoiseMeasureS = 8.0;
// Sensor noise of the benchmark; the small noise of a target comes from the measured forces that it is integrated from.
constexpr double kDisplacementNoiseM = 1.6e-5;
constexpr double kForceNoiseN = 2.18;
constexpr double kTargetNoiseM = 1e-6;

struct Spread {
  double command = 0.0;
  double force = 0.0;
};

/// Root mean squares of the difference that a disturbance makes, over that of the disturbance.
Spread spread(const CompensationMethod& method, const StandKind& stand, double Disturbance::*where, double deviation) {
  MeasuredLoop disturbed{method, stand};
  MeasuredLoop quiet{method, stand};
  const DrivenTarget target{kAmplitudeM, kFrequencyHz};
  Random random{1};
  double command_square = 0.0;
  double force_square = 0.0;
  long count = 0;
  for (long i = 0; static_cast<double>(i) * stand.period_s < kNoiseSettleS + kNoiseMeasureS; ++i) {
    const double time_s = static_cast<double>(i) * stand.period_s;
    Disturbance disturbance;
    disturbance.*where = deviation * random.normal();
    const LoopSample with = disturbed.advance(target.at(time_s), disturbance);
    const LoopSample without = quiet.advance(target.at(time_s), {});
    if (time_s < kNoiseSettleS) continue;
    command_square += std::pow(with.command_m - without.command_m, 2);
    force_square += std::pow(with.structure_force_n - without.structure_force_n, 2);
    ++count;
  }
  const auto samples = static_cast<double>(count);
  return {std::sqrt(command_square / samples) / deviation, std::sqrt(force_square / samples) / deviation};
}

}  // namespace

NoiseGain measured_noise_gain(const CompensationMethod& method, const StandKind& stand) {
  const Spread of_displacement = spread(method, stand, &Disturbance::measured_displacement_m, kDisplacementNoiseM);
  return {.target_to_command = spread(method, stand, &Disturbance::target_m, kTargetNoiseM).command,
          .displacement_to_command = of_displacement.command,
          .force_to_force = spread(method, stand, &Disturbance::measured_force_n, kForceNoiseN).force,
          .displacement_to_force_n_per_m = of_displacement.force};
}

}  // namespace hybridtest::character
