#include "mechanics/laws/bouc_wen.hpp"

#include <algorithm>
#include <cmath>

#include "core/parameters/parameter_checker.hpp"
#include "mechanics/laws/power.hpp"
#include "mechanics/laws/runge_kutta.hpp"

namespace hybridtest {
namespace {

constexpr double kSubstepsPerLength = 64.0;
/// Where |w|^n has no fifth derivative at zero, substeps grow with the distance, from the power 10 / 3 of the usual
/// one.
constexpr double kFirstSubstep = 1.0 / (1U << 20U);
constexpr double kSubstepGrowth = 0.25;
/// Enough for z to reach its limit to rounding (exp(-37)) from any state.
constexpr int kSubstepsMax = 4096;

}  // namespace

BoucWen::BoucWen(const Parameters& parameters, Integration integration) : parameters_{checked(parameters)} {
  expect_in_range("gamma_per_m", parameters.gamma_per_m, {.low = -parameters.beta_per_m, .low_open = true});
  const double sum = parameters.gamma_per_m + parameters.beta_per_m;
  ultimate_m_ = std::pow(parameters.ao / sum, 1.0 / parameters.n);
  unloading_ = (parameters.gamma_per_m - parameters.beta_per_m) / sum;
  unloading_root_ = std::pow(std::abs(unloading_), 0.2);
  short_anywhere_ = 1.0 / (kSubstepsPerLength * parameters.n * std::max(1.0, std::abs(unloading_)));
  is_singular_at_zero_ = parameters.n < 5.0 && parameters.n != std::trunc(parameters.n);
  if (integration == Integration::table && parameters.n != 1.0) {
    loading_table_.emplace(parameters.n, 1.0);
    unloading_table_.emplace(parameters.n, unloading_);
  }
}

double BoucWen::initial_stiffness_n_per_m() const noexcept {
  return (parameters_.alpha + (1.0 - parameters_.alpha) * parameters_.ao) * parameters_.stiffness_n_per_m;
}

double BoucWen::trial(double displacement_m, double /*velocity_m_per_s*/) noexcept {
  const double increment_m = displacement_m - committed_.displacement_m;
  const double direction = increment_m < 0.0 ? -1.0 : 1.0;
  const double path = std::abs(increment_m) * parameters_.ao / ultimate_m_;
  trial_.displacement_m = displacement_m;
  trial_.hysteretic = direction * carried_along(direction * committed_.hysteretic, path);
  const double elastic_part = parameters_.alpha * displacement_m;
  const double hysteretic_part = (1.0 - parameters_.alpha) * ultimate_m_ * trial_.hysteretic;
  return parameters_.stiffness_n_per_m * (elastic_part + hysteretic_part);
}

// With w = z / zu, s = Ao |x| / zu, and w counted positive in the direction of motion, the
// equation loses all but two of its parameters: dw/ds = 1 - c |w|^n, where c is 1 while
// loading (w > 0) and (gamma - beta) / (gamma + beta) while unloading.
double BoucWen::slope(double w) const noexcept {
  return 1.0 - (w < 0.0 ? unloading_ : 1.0) * power_of(std::abs(w), parameters_.n);
}

double BoucWen::carried_along(double w, double path) const noexcept {
  if (parameters_.n == 1.0) return carried_exactly(w, path);
  return loading_table_ ? carried_by_table(w, path) : carried_by_substeps(w, path);
}

double BoucWen::carried_exactly(double w, double path) const noexcept {
  if (w < 0.0) {
    const double begin = 1.0 + unloading_ * w;
    if (begin <= 0.0) return w;  // without beta the limit is a rest on the way back, too
    const double to_zero = unloading_ == 0.0 ? -w : -std::log1p(unloading_ * w) / unloading_;
    if (path < to_zero) return unloading_ == 0.0 ? w + path : w + begin * std::expm1(unloading_ * path) / unloading_;
    path -= to_zero;
    w = 0.0;
  }
  return w - (1.0 - w) * std::expm1(-path);
}

double BoucWen::carried_by_table(double w, double path) const noexcept {
  if (w < 0.0) {
    const double to_zero = unloading_table_->path_to(-w);
    if (path < to_zero) return -unloading_table_->at(to_zero - path);
    path -= to_zero;
    w = 0.0;
  }
  return loading_table_->at(loading_table_->path_to(w) + path);
}

double BoucWen::carried_by_substeps(double w, double path) const noexcept {
  double left = path;
  for (int i = 0; i < kSubstepsMax && left > 0.0; ++i) {
    double step = substep(w, left);
    double next = runge_kutta_step(w, step, [this](double at) { return slope(at); });
    if (next == w) break;         // at its limit: the rest of the way changes nothing
    if (w < 0.0 && next > 0.0) {  // the slope has a kink at zero: stop there
      step = std::min(step, path_to_zero(w));
      next = 0.0;
    }
    w = next;
    left -= step;
  }
  return w;
}

double BoucWen::substep(double w, double left) const noexcept {
  double step = left;
  if (left > short_anywhere_) {
    const double n = parameters_.n;
    const double largest = w < 0.0 ? -w : std::min(1.0, w + 1.0 / kSubstepsPerLength);
    // n * share is the derivative of the slope; its own derivatives grow n times each, so that a
    // small share still counts with the fifth root.
    const double root = (w < 0.0 ? unloading_root_ : 1.0) * power_of(largest, 0.2 * (n - 1.0));
    const double change = n * (root > 1.0 ? root * root * root * root * root : root);
    step = std::min(left, 1.0 / (kSubstepsPerLength * std::max(1.0, change)));
  }
  return is_singular_at_zero_ ? std::min(step, std::max(kSubstepGrowth * std::abs(w), kFirstSubstep)) : step;
}

/// ds = dw / slope(w) from w < 0 to 0, by Simpson's rule; at most one substep away.
double BoucWen::path_to_zero(double w) const noexcept {
  return -w / 6.0 * (1.0 / slope(w) + 4.0 / slope(0.5 * w) + 1.0);
}

}  // namespace hybridtest
