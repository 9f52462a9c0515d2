#pragma once

#include <cmath>
#include <functional>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "plant/effects/effect_type.hpp"
#include "plant/effects/stage.hpp"

namespace hybridtest {

inline constexpr double kBenchPeriod_s = 1e-3;

/// One effect of the library by name.
[[nodiscard]] inline std::unique_ptr<Effect> made(EffectInterface interface, std::string_view name,
                                                  std::vector<double> values) {
  const EffectType* const type = find_effect(interface, name);
  if (type == nullptr || type->parameters.size() != values.size()) {
    throw std::invalid_argument{"no such effect or not its parameters: " + std::string{name}};
  }
  return type->make(values, kBenchPeriod_s);
}

/// A motion with its exact derivatives.
struct Driver {
  std::function<double(double)> displacement_m;
  std::function<double(double)> velocity_m_per_s;
  std::function<double(double)> acceleration_m_per_s2;
};

[[nodiscard]] inline Driver sine(double amplitude, double omega_rad_per_s) {
  return {[=](double t) { return amplitude * std::sin(omega_rad_per_s * t); },
          [=](double t) { return amplitude * omega_rad_per_s * std::cos(omega_rad_per_s * t); },
          [=](double t) { return -amplitude * omega_rad_per_s * omega_rad_per_s * std::sin(omega_rad_per_s * t); }};
}

/// The base with a wrong number, where the effect is one.
[[nodiscard]] inline double base_under(Effect& effect, Motion motion,
                                       const std::function<double(const Motion&)>& base) {
  effect.before_base(motion);
  double output = base(motion);
  effect.after_base(output);
  return output;
}

/// What comes out of a base under one effect at each of `samples` samples.
[[nodiscard]] inline std::vector<double> response(
    Effect& effect, const Driver& driver, int samples,
    const std::function<double(const Motion&)>& base = [](const Motion&) { return 0.0; }) {
  std::vector<double> outputs;
  double output = 0.0;
  for (int i = 0; i < samples; ++i) {
    const double time_s = kBenchPeriod_s * i;
    const StageSample sample{.motion = {.displacement_m = driver.displacement_m(time_s),
                                        .velocity_m_per_s = driver.velocity_m_per_s(time_s),
                                        .acceleration_m_per_s2 = driver.acceleration_m_per_s2(time_s)},
                             .time_s = time_s,
                             .force_n = output};
    Motion motion = sample.motion;
    effect.before(sample, motion);
    output = base_under(effect, motion, base);
    effect.after(sample, motion, output);
    outputs.push_back(output);
  }
  return outputs;
}

/// The output of one path of displacements at rest, one sample each.
[[nodiscard]] inline std::vector<double> along(
    Effect& effect, const std::vector<double>& path,
    const std::function<double(const Motion&)>& base = [](const Motion&) { return 0.0; }) {
  std::vector<double> outputs;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const StageSample sample{.motion = {.displacement_m = path[i]}, .time_s = kBenchPeriod_s * static_cast<double>(i)};
    Motion motion = sample.motion;
    effect.before(sample, motion);
    double output = base_under(effect, motion, base);
    effect.after(sample, motion, output);
    outputs.push_back(output);
  }
  return outputs;
}

/// Work of `forces` over samples begin to end of the motion, by the trapezium.
[[nodiscard]] inline double work_j(const std::vector<double>& forces, const Driver& driver, std::size_t begin,
                                   std::size_t end) {
  const auto at_m = [&](std::size_t i) { return driver.displacement_m(kBenchPeriod_s * static_cast<double>(i)); };
  double work = 0.0;
  for (std::size_t i = begin + 1; i <= end; ++i) work += 0.5 * (forces[i] + forces[i - 1]) * (at_m(i) - at_m(i - 1));
  return work;
}

}  // namespace hybridtest
