#include "compensation/conditional_adaptive_time_series.hpp"

#include <algorithm>

namespace hybridtest {

ConditionalAdaptiveTimeSeries::ConditionalAdaptiveTimeSeries(const Parameters& parameters, double control_period_s)
    : model_{parameters, control_period_s}, keep_{1.0 - 1.0 / static_cast<double>(model_.window())} {}

double ConditionalAdaptiveTimeSeries::command(const CompensatorInput& input) noexcept {
  const TimeSeriesModel::Row row = model_.observe(input.measured_displacement_m);
  sum_ = keep_ * sum_ + row * row.transpose();
  observed_ = std::min(observed_ + 1, model_.window());
  if (observed_ == model_.window() && model_.is_motion(sum_)) {
    const TimeSeriesModel::Coefficients wanted = model_.solve(sum_);
    for (Eigen::Index i = 0; i < wanted.size(); ++i) {
      if (model_.is_in_range(i, wanted(i))) model_.approach(i, wanted(i));
    }
  }
  return model_.command(input);
}

void ConditionalAdaptiveTimeSeries::reset() noexcept {
  model_.reset();
  observed_ = 0;
  sum_.setZero();
}

}  // namespace hybridtest
