#include "validation/blind_batches/plant/sensors.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "validation/blind_batches/plant/foreign_effects.hpp"

namespace hybridtest::blind {
namespace {

/// Anti-aliasing filter of one pole, driven by straight lines.
History lagging(const History& truth, double period_s, double time_constant_s) {
  const double decay = std::exp(-period_s / time_constant_s);
  History read(truth.size());
  double state = truth.front();
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const double middle = 0.5 * (truth[i] + truth[i == 0 ? 0 : i - 1]);
    state = middle + (state - middle) * decay;
    read[i] = state;
  }
  return read;
}

}  // namespace

History reading(const char* interface, const PlantEffects& effects, const MotionHistory& motion, const History& truth) {
  History read = truth;
  for (const PlantEffect& effect : effects) {
    if (effect.interface != interface) continue;
    const std::string& name = effect.name;
    // Units differ between the two sensors, the keys with them.
    const auto value = [&](const char* of_force, const char* of_displacement) {
      return effect.interface == "force_sensor" ? effect.of(of_force) : effect.of(of_displacement);
    };
    if (name == "gain") {
      for (double& v : read) v *= effect.of("gain");
    } else if (name == "bias") {
      for (double& v : read) v += value("bias_n", "bias_m");
    } else if (name == "drift") {
      const double rate = value("drift_n_per_s", "drift_m_per_s");
      for (std::size_t i = 0; i < read.size(); ++i) read[i] += rate * static_cast<double>(i) * motion.period_s;
    } else if (name == "lag") {
      read = lagging(read, motion.period_s, effect.of("time_constant_s"));
    } else if (name == "time_skew") {
      read = delayed(read, effect.of("skew_s") / motion.period_s);
    } else if (name == "saturation") {
      for (double& v : read) v = std::clamp(v, -effect.of("limit_n"), effect.of("limit_n"));
    } else if (name == "quantization") {
      const double step = value("step_n", "step_m");
      for (double& v : read) v = step * std::round(v / step);
    } else {
      read_with_foreign(effect, motion, read);
    }
  }
  return read;
}

}  // namespace hybridtest::blind
