#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <numbers>

#include "core/random.hpp"
#include "diagnosis/recording.hpp"
#include "mechanics/laws/elastic.hpp"
#include "plant/site_model.hpp"
#include "plant/transfer_systems/ideal.hpp"

namespace hybridtest {

inline constexpr double kSitePeriod_s = 0.002;
inline constexpr double kMadeStiffness_n_per_m = 2.0e6;

/// Two sines, so that velocity and displacement are not locked to each other; at rest in the beginning.
inline double made_motion_m(double time_s) {
  const double growth = std::min(1.0, time_s);
  return growth * (0.02 * std::sin(2.0 * std::numbers::pi * 0.9 * time_s) +
                   0.008 * std::sin(2.0 * std::numbers::pi * 2.3 * time_s));
}

inline double made_velocity_m_per_s(double time_s) {
  constexpr double kStep_s = 1e-5;
  return (made_motion_m(time_s + kStep_s) - made_motion_m(time_s - kStep_s)) / (2.0 * kStep_s);
}

/// 12 s of a site whose transducer reads `measured_m(t)` and whose load cell `force_n(t)`, with noise.
inline Recording made_recording(const std::function<double(double)>& measured_m,
                                const std::function<double(double)>& force_n, double force_noise_n = 20.0,
                                std::uint64_t seed = 3) {
  Recording recording;
  recording.file = "made.csv";
  recording.sample_period_s = kSitePeriod_s;
  recording.samples = 6000;
  recording.dofs.resize(1);
  Random random{seed};
  for (std::size_t i = 0; i < recording.samples; ++i) {
    const double time_s = kSitePeriod_s * static_cast<double>(i);
    recording.dofs[0].of(Channel::command_displacement).push_back(made_motion_m(time_s));
    recording.dofs[0].of(Channel::measured_displacement).push_back(measured_m(time_s) + 1e-6 * random.normal());
    recording.dofs[0].of(Channel::measured_force).push_back(force_n(time_s) + force_noise_n * random.normal());
  }
  return recording;
}

/// An ideal actuator on a spring.
inline SiteModel made_model() {
  SiteModel model;
  model.make_transfer_system = [](double, double) { return std::make_unique<Ideal>(); };
  model.make_law = [] { return std::make_unique<Elastic>(kMadeStiffness_n_per_m); };
  return model;
}

}  // namespace hybridtest
