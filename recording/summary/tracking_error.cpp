#include "recording/summary/tracking_error.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/assert.hpp"

namespace hybridtest {
namespace {

/// Largest deviation of a sample interval from the usual one that still counts as even spacing.
constexpr double kEvenSpacing = 0.01;
/// The end of a long stretch counts when it has at least this share of a block: a shorter one shows no slow motion.
constexpr std::size_t kLastBlockShare = 8;

}  // namespace

UsualInterval::UsualInterval() : intervals_{[](std::size_t count) { return std::vector<std::size_t>{count / 2}; }} {}

void UsualInterval::add(double time_s) {
  is_finite_ = is_finite_ && std::isfinite(time_s);
  if (last_s_ && is_finite_) intervals_.add(time_s - *last_s_);
  last_s_ = time_s;
}

bool UsualInterval::end_pass() {
  last_s_.reset();
  return is_finite_ && intervals_.end_pass();
}

std::optional<double> UsualInterval::result() const {
  if (!is_finite_ || intervals_.values().empty()) return {};
  return intervals_.values().front();
}

void StretchEvaluation::add(double time_s, double target_m, double measured_m) {
  const bool is_finite = std::isfinite(target_m) && std::isfinite(measured_m);
  const bool joins = current_.count > 0 && std::abs(time_s - last_time_s_ - period_s_) <= kEvenSpacing * period_s_;
  last_time_s_ = time_s;
  if (!is_finite || !joins) end_stretch();
  if (!is_finite) return;
  if (current_.target_m.size() == kBlock) end_block();
  ++current_.count;
  current_.target_m.push_back(target_m);
  current_.measured_m.push_back(measured_m);
}

void StretchEvaluation::end_block() {
  if (!current_.sum) current_.sum.emplace(period_s_, kBlock);
  current_.sum->add(current_.target_m, current_.measured_m);
  current_.target_m.clear();
  current_.measured_m.clear();
}

void StretchEvaluation::end_stretch() {
  if (current_.count > best_.count) std::swap(current_, best_);
  current_.count = 0;
  current_.target_m.clear();
  current_.measured_m.clear();
  current_.sum.reset();
}

std::optional<FrequencyEvaluation> StretchEvaluation::result() {
  end_stretch();
  if (!best_.sum) return evaluate_tracking_frequency(best_.target_m, best_.measured_m, period_s_);
  FrequencyEvaluationSum sum = *best_.sum;
  if (kLastBlockShare * best_.target_m.size() >= kBlock) sum.add(best_.target_m, best_.measured_m);
  return sum.result();
}

void TrackingSearch::add_error(double target_m, double measured_m) {
  const double difference = measured_m - target_m;
  if (!std::isfinite(difference)) return;
  error_squares_ += difference * difference;
  target_squares_ += target_m * target_m;
  error_.peak_m = std::max(error_.peak_m, std::abs(difference));
  ++error_.samples;
}

void TrackingSearch::begin_delay(std::optional<double> period_s) {
  if (period_s && error_.samples > 0) stretch_.emplace(*period_s);
}

void TrackingSearch::add_delay(double time_s, double target_m, double measured_m) {
  if (stretch_) stretch_->add(time_s, target_m, measured_m);
}

std::optional<TrackingError> TrackingSearch::result() {
  if (error_.samples == 0) return {};
  TrackingError error = error_;
  error.rms_m = std::sqrt(error_squares_ / static_cast<double>(error.samples));
  if (target_squares_ > 0.0) error.rms_relative = std::sqrt(error_squares_ / target_squares_);
  const auto delay = stretch_ ? stretch_->result() : std::nullopt;
  if (!delay) return error;
  error.amplitude = delay->amplitude;
  error.equivalent_delay_s = delay->delay_s;
  error.equivalent_frequency_hz = delay->frequency_hz;
  return error;
}

std::optional<TrackingError> evaluate_tracking(std::string dof, std::span<const double> time_s,
                                               std::span<const double> target_m, std::span<const double> measured_m) {
  HYBRIDTEST_ASSERT(time_s.size() == target_m.size() && target_m.size() == measured_m.size());
  TrackingSearch search{std::move(dof)};
  for (std::size_t i = 0; i < time_s.size(); ++i) search.add_error(target_m[i], measured_m[i]);
  UsualInterval interval;
  do {
    for (const double time : time_s) interval.add(time);
  } while (interval.end_pass());
  search.begin_delay(interval.result());
  for (std::size_t i = 0; i < time_s.size(); ++i) search.add_delay(time_s[i], target_m[i], measured_m[i]);
  return search.result();
}

}  // namespace hybridtest
