#include "validation/blind_batches/plant/plant.hpp"

#include <algorithm>
#include <utility>

#include "validation/blind_batches/plant/actuator.hpp"
#include "validation/blind_batches/plant/sensors.hpp"
#include "validation/blind_batches/plant/signal_path.hpp"
#include "validation/blind_batches/plant/specimen.hpp"

namespace hybridtest::blind {
namespace {

/// Well above the motions of excitation.cpp and below the noise that differentiation amplifies.
constexpr double kDerivativeCutoffHz = 40.0;

double fine_period_s(const Site& site) { return 1.0 / (site.rate_hz * static_cast<double>(kFineSteps)); }

LoadOf load_of(const Site& site, const PlantEffects& effects) {
  return [&](const MotionHistory& motion) { return specimen_force(site, effects, motion); };
}

void add_noise(History& values, double standard_deviation, RandomStream& random) {
  for (double& value : values) value += standard_deviation * random.normal();
}

/// A motion that was measured: the displacement as it is, its derivatives from a smoothed copy.
MotionHistory measured_motion(const Site& site, const History& displacement_m) {
  MotionHistory motion =
      motion_of(spline(smoothed(displacement_m, 1.0 / site.rate_hz, kDerivativeCutoffHz)), fine_period_s(site));
  motion.displacement_m = spline(displacement_m);
  return motion;
}

}  // namespace

TrueSignals run_plant(const Site& site, const PlantEffects& effects, const History& sent_m) {
  TrueSignals signals;
  signals.sent_m = sent_m;
  signals.target_m = through_network(site, effects, sent_m);
  signals.command_m = compensated(site, effects, signals.target_m);
  signals.motion = actuator_motion(site, effects, signals.command_m, load_of(site, effects));
  signals.force_n = specimen_force(site, effects, signals.motion);
  signals.read_m = sampled(reading("displacement_sensor", effects, signals.motion, signals.motion.displacement_m));
  signals.read_n = sampled(reading("force_sensor", effects, signals.motion, signals.force_n));
  return signals;
}

PlantRecording record(const Site& site, const TrueSignals& signals, RandomStream& random) {
  PlantRecording recording{signals.sent_m, signals.target_m, signals.command_m, signals.read_m, signals.read_n};
  add_noise(recording.measured_m, site.displacement_noise_m, random);
  add_noise(recording.measured_n, site.force_noise_n, random);
  return recording;
}

History stage_output(Residual residual, const Site& site, const PlantEffects& effects, const History& driven_m) {
  switch (residual) {
    case Residual::network: return through_network(site, effects, driven_m);
    case Residual::compensator: return compensated(site, effects, driven_m);
    case Residual::transfer_system: {
      const MotionHistory motion = actuator_motion(site, effects, driven_m, load_of(site, effects));
      return sampled(reading("displacement_sensor", effects, motion, motion.displacement_m));
    }
    case Residual::specimen: {
      const MotionHistory motion = measured_motion(site, driven_m);
      return sampled(reading("force_sensor", effects, motion, specimen_force(site, effects, motion)));
    }
  }
  return {};
}

}  // namespace hybridtest::blind
