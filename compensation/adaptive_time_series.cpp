#include "compensation/adaptive_time_series.hpp"

#include <algorithm>

namespace hybridtest {

AdaptiveTimeSeries::AdaptiveTimeSeries(const Parameters& parameters, double control_period_s)
    : model_{parameters, control_period_s}, rows_(model_.window(), TimeSeriesModel::Row::Zero()) {}

void AdaptiveTimeSeries::slide(const TimeSeriesModel::Row& row) noexcept {
  const Eigen::Matrix4d square = row * row.transpose();
  TimeSeriesModel::Row& oldest = rows_[oldest_];
  sum_ += square - oldest * oldest.transpose();
  fresh_sum_ += square;
  oldest = row;
  if (++oldest_ < rows_.size()) return;
  oldest_ = 0;
  is_full_ = true;
  sum_ = fresh_sum_;
  fresh_sum_.setZero();
}

double AdaptiveTimeSeries::command(const CompensatorInput& input) noexcept {
  slide(model_.observe(input.measured_displacement_m));
  if (is_full_ && model_.is_motion(sum_)) {
    const TimeSeriesModel::Coefficients wanted = model_.solve(sum_);
    if (wanted.allFinite()) {
      for (Eigen::Index i = 0; i < wanted.size(); ++i) model_.approach(i, model_.clamped(i, wanted(i)));
    }
  }
  return model_.command(input);
}

void AdaptiveTimeSeries::reset() noexcept {
  model_.reset();
  std::fill(rows_.begin(), rows_.end(), TimeSeriesModel::Row::Zero());
  oldest_ = 0;
  is_full_ = false;
  sum_.setZero();
  fresh_sum_.setZero();
}

}  // namespace hybridtest
