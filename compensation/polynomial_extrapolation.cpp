#include "compensation/polynomial_extrapolation.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/config_error.hpp"
#include "core/parameters/parameter_checker.hpp"
#include "core/text/scalar.hpp"

namespace hybridtest {
namespace {

constexpr double kMaxPeriodsPerPoint = 10'000.0;
constexpr double kRounding = 1e-9;  // of a duration, through its conversions

std::string written(double duration_s) { return written_number(duration_s) + " s"; }

int checked_order(int order) {
  if (contains(kPolynomialOrders, order)) return order;
  throw ConfigError{"order is " + std::to_string(order) + "; expected an integer from 1 to " +
                    std::to_string(kMaxPolynomialOrder)};
}

/// @return control periods from one fitted point to the next.
double checked_spacing(const PolynomialParameters& parameters, double period_s) {
  const double delay_s = parameters.delay_s;
  const double spacing_s = parameters.point_spacing_s;
  if (!(period_s > 0.0)) throw ConfigError{"control period is " + written(period_s) + "; expected more than 0 s"};
  if (!(delay_s >= 0.0)) throw ConfigError{"delay is " + written(delay_s) + "; expected at least 0 s"};
  if (!(spacing_s >= 0.0)) {
    throw ConfigError{"point spacing is " + written(spacing_s) + "; expected at least one control period, or 0 s"};
  }
  const bool is_given = spacing_s > 0.0;
  const double wanted_s = is_given ? spacing_s : delay_s;
  const double count = std::max(std::round(wanted_s / period_s), 1.0);
  if (count > kMaxPeriodsPerPoint) {
    throw ConfigError{(is_given ? "point spacing is " : "delay is ") + written(wanted_s) + "; expected at most " +
                      written_integer(static_cast<std::int64_t>(kMaxPeriodsPerPoint)) + " control periods of " +
                      written(period_s)};
  }
  const double delay_s_max = PolynomialExtrapolation::kMaxSpacingsAhead * count * period_s;
  if (delay_s > delay_s_max * (1.0 + kRounding)) {
    throw ConfigError{"delay is " + written(delay_s) + "; expected at most " +
                      std::to_string(PolynomialExtrapolation::kMaxSpacingsAhead) + " point spacings of " +
                      written(count * period_s)};
  }
  return count;
}

}  // namespace

PolynomialExtrapolation::PolynomialExtrapolation(const PolynomialParameters& parameters, double control_period_s)
    : order_{checked_order(parameters.order)}, initial_delay_s_{parameters.delay_s} {
  const double count = checked_spacing(parameters, control_period_s);
  checked_control_period(control_period_s);
  periods_per_point_ = static_cast<std::size_t>(count);
  point_spacing_s_ = count * control_period_s;
  samples_.resize(static_cast<std::size_t>(order_) * periods_per_point_ + 1);
  set_delay(initial_delay_s_);
}

double PolynomialExtrapolation::advance(double newest) noexcept {
  const std::size_t size = samples_.size();
  newest_ = newest_ + 1 == size ? 0 : newest_ + 1;
  samples_[newest_] = newest;
  known_ = std::min(known_ + 1, size);

  const std::size_t order = (known_ - 1) / periods_per_point_;
  const PolynomialWeights& weights = weights_[order];
  double sum = 0.0;
  std::size_t place = newest_;
  for (std::size_t j = 0; j <= order; ++j) {
    sum += weights[j] * samples_[place];
    place = place >= periods_per_point_ ? place - periods_per_point_ : place + size - periods_per_point_;
  }
  return sum;
}

void PolynomialExtrapolation::reset() noexcept {
  known_ = 0;
  set_delay(initial_delay_s_);
}

void PolynomialExtrapolation::set_delay(double delay_s) noexcept {
  if (!std::isfinite(delay_s)) return;
  delay_s_ = std::clamp(delay_s, 0.0, delay_s_max());
  const double ahead = delay_s_ / point_spacing_s_;
  for (int order = 0; order <= order_; ++order) {
    weights_[static_cast<std::size_t>(order)] = polynomial_weights(order, ahead);
  }
}

double PolynomialExtrapolation::noise_gain() const noexcept {
  double sum = 0.0;
  for (const double weight : weights_[static_cast<std::size_t>(order_)]) sum += std::abs(weight);
  return sum;
}

}  // namespace hybridtest
