#include "mechanics/laws/parallel.hpp"

#include <utility>

#include "core/config_error.hpp"

namespace hybridtest {

Parallel::Parallel(std::vector<std::unique_ptr<Law>> laws) : laws_{std::move(laws)} {
  if (laws_.empty()) throw ConfigError{"0 laws in parallel; expected at least one"};
}

double Parallel::trial(double displacement_m, double velocity_m_per_s) noexcept {
  double force_n = 0.0;
  for (const auto& law : laws_) force_n += law->trial(displacement_m, velocity_m_per_s);
  return force_n;
}

void Parallel::commit() noexcept {
  for (const auto& law : laws_) law->commit();
}

void Parallel::revert() noexcept {
  for (const auto& law : laws_) law->revert();
}

void Parallel::reset() noexcept {
  for (const auto& law : laws_) law->reset();
}

double Parallel::initial_stiffness_n_per_m() const noexcept {
  double stiffness_n_per_m = 0.0;
  for (const auto& law : laws_) stiffness_n_per_m += law->initial_stiffness_n_per_m();
  return stiffness_n_per_m;
}

void Parallel::ignore_reversals_within(double distance_m) noexcept {
  for (const std::unique_ptr<Law>& law : laws_) law->ignore_reversals_within(distance_m);
}

}  // namespace hybridtest
