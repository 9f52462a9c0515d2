#include "diagnosis/localisation/tracking_screens.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/assert.hpp"
#include "core/signal/frequency_evaluation.hpp"
#include "diagnosis/signals/signals.hpp"
#include "diagnosis/tuning.hpp"

namespace hybridtest {
std::vector<double> tracking_indicator_m2(std::span<const double> command_m, std::span<const double> measured_m) {
  HYBRIDTEST_ASSERT(command_m.size() == measured_m.size());
  std::vector<double> indicator(command_m.size(), 0.0);
  for (std::size_t i = 1; i < command_m.size(); ++i) {
    const double area = 0.5 * (command_m[i] + command_m[i - 1]) * (measured_m[i] - measured_m[i - 1]);
    const double turned = 0.5 * (measured_m[i] + measured_m[i - 1]) * (command_m[i] - command_m[i - 1]);
    indicator[i] = indicator[i - 1] + 0.5 * (area - turned);
  }
  return indicator;
}

std::vector<double> error_monitor(std::span<const double> command_m, std::span<const double> measured_m,
                                  std::span<const double> force_n, double stiffness_n_per_m) {
  HYBRIDTEST_ASSERT(command_m.size() == measured_m.size() && command_m.size() == force_n.size());
  HYBRIDTEST_ASSERT(stiffness_n_per_m > 0.0);
  std::vector<double> energy(command_m.size(), 0.0);
  double largest_m = command_m.empty() ? 0.0 : std::abs(command_m.front());
  for (std::size_t i = 1; i < command_m.size(); ++i) {
    const double error_now_m = command_m[i] - measured_m[i];
    const double error_before_m = command_m[i - 1] - measured_m[i - 1];
    energy[i] = energy[i - 1] + 0.5 * (force_n[i] + force_n[i - 1]) * (error_now_m - error_before_m);
    largest_m = std::max(largest_m, std::abs(command_m[i]));
  }
  const double strain_energy_j = 0.5 * stiffness_n_per_m * largest_m * largest_m;
  for (double& value : energy) value = strain_energy_j > 0.0 ? value / strain_energy_j : 0.0;
  return energy;
}

double secant_stiffness_n_per_m(std::span<const double> displacement_m, std::span<const double> force_n) {
  HYBRIDTEST_ASSERT(displacement_m.size() == force_n.size());
  const auto size = static_cast<double>(std::max<std::size_t>(1, displacement_m.size()));
  const double mean_m = std::accumulate(displacement_m.begin(), displacement_m.end(), 0.0) / size;
  const double mean_n = std::accumulate(force_n.begin(), force_n.end(), 0.0) / size;
  double product = 0.0;
  double square = 0.0;
  for (std::size_t i = 0; i < displacement_m.size(); ++i) {
    product += (displacement_m[i] - mean_m) * (force_n[i] - mean_n);
    square += (displacement_m[i] - mean_m) * (displacement_m[i] - mean_m);
  }
  return square > 0.0 ? product / square : 0.0;
}

std::optional<DelayConsequence> delay_consequence(std::span<const double> command_m, std::span<const double> measured_m,
                                                  std::span<const double> force_n, double period_s) {
  const auto tracking = evaluate_tracking_frequency(command_m, measured_m, period_s);
  const double stiffness_n_per_m = secant_stiffness_n_per_m(measured_m, force_n);
  if (!tracking || !(stiffness_n_per_m > 0.0)) return {};
  const double elastic = stiffness_n_per_m * stiffness_n_per_m * variance(measured_m);
  if (elastic < tuning::kElasticShareMin * variance(force_n)) return {};
  return DelayConsequence{.delay_s = tracking->delay_s,
                          .stiffness_n_per_m = stiffness_n_per_m,
                          .equivalent_damping_n_s_per_m = -stiffness_n_per_m * tracking->delay_s};
}

}  // namespace hybridtest
