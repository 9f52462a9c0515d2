#include "experimental_site/trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/message_copies.hpp"

namespace hybridtest {
namespace {

/// Path times that differ by less than this share of a step are equal up to the rounding of the sum of
/// sampling intervals.
constexpr double kSameTime = 1e-7;

/// In real time a target that comes later in its step is too late to be reached smoothly.
constexpr double kJoinBefore = 0.8;

/// Below this rate the path counts as held.
constexpr double kHeldBelow = 0.05;

void copy_target(const TargetPoint& from, TargetPoint& to) noexcept {
  to.step = from.step;
  to.model_time_s = from.model_time_s;
  copy_values(from.displacement_m, to.displacement_m);
  copy_values(from.velocity_m_per_s, to.velocity_m_per_s);
  copy_values(from.acceleration_m_per_s2, to.acceleration_m_per_s2);
}

}  // namespace

Trajectory::Trajectory(int dofs, double step_s, double time_scale, const TrajectorySettings& settings) noexcept
    : settings_{settings}, step_s_{step_s}, time_scale_{time_scale} {
  reset(SiteVector::Zero(dofs));
}

void Trajectory::reset(const SiteVector& displacement_m) noexcept {
  const SiteVector zero = SiteVector::Zero(displacement_m.size());
  is_running_ = false;
  has_target_ = false;
  aims_ = false;
  stands_ = false;
  last_step_ = kNoStep;
  has_missed_ = false;
  early_count_ = 0;
  path_time_s_ = 0.0;
  rate_ = 1.0;
  interval_begin_s_ = 0.0;
  slope_m_per_s_ = zero;
  segment_begin_s_ = 0.0;
  begin_displacement_m_ = displacement_m;
  begin_velocity_m_per_s_ = zero;
  begin_acceleration_m_per_s2_ = zero;
  begin_jerk_m_per_s3_ = zero;
  has_left_target_ = false;
  end_velocity_m_per_s_ = zero;
  end_acceleration_m_per_s2_ = zero;
  flags_ = MeasurementFlags::none;
  point_ = {displacement_m, zero, zero, 0.0, false};
}

void Trajectory::set_target(const TargetPoint& target) noexcept {
  if (settings_.keeps_time && is_running_) {
    learn_target(target);
    return;
  }
  is_first_target_ = !is_running_;
  if (is_first_target_) {
    last_step_ = target.step - 1;
    is_running_ = true;
    path_time_s_ = target.model_time_s * time_scale_;
    interval_begin_s_ = path_time_s_ - step_s_;
  }
  adopt(target);

  if (!is_first_target_) {
    const double slow_down_s = interval_begin_s_ + kSlowDownAt * step_s_;
    // With few samples per step a target can be late although no sample was slowed down.
    if (path_time_s_ > slow_down_s + kSameTime * step_s_) flags_ |= MeasurementFlags::late;
    path_time_s_ = std::min(path_time_s_, slow_down_s);
  }
  begin_segment();
}

void Trajectory::adopt(const TargetPoint& target) noexcept {
  copy_target(target, target_);
  if (settings_.keeps_time) known_ = target;
  has_target_ = true;
  aims_ = false;
  end_velocity_m_per_s_ = target.velocity_m_per_s / time_scale_;
  end_acceleration_m_per_s2_ = target.acceleration_m_per_s2 / (time_scale_ * time_scale_);
}

void Trajectory::begin_segment() noexcept {
  segment_begin_s_ = path_time_s_;
  copy_values(point_.displacement_m, begin_displacement_m_);
  copy_values(slope_m_per_s_, begin_velocity_m_per_s_);
}

void Trajectory::learn_target(const TargetPoint& target) noexcept {
  if (stands_) {
    if (target.step <= last_step_) return;
    stands_ = false;
    // Behind lost commands the path joins at the step that is due.
    last_step_ = target.step - 1;
    path_time_s_ = interval_begin_s_ = target.model_time_s * time_scale_ - step_s_;
    begin_segment();
    adopt(target);
    return;
  }
  if (target.step > last_step_ + 1) {
    const bool is_next = early_count_ == 0 || target.step > early_[early_count_ - 1].step;
    if (is_next && early_count_ < early_.size()) early_[early_count_++] = target;
    return;
  }
  if (target.step <= known_.step || has_target_) return;
  known_ = target;
  const double share = (path_time_s_ - interval_begin_s_) / step_s_;
  if (target.step == last_step_ + 1 && share <= kJoinBefore + kSameTime) {
    if (share > kSlowDownAt + kSameTime) flags_ |= MeasurementFlags::late;
    begin_segment();
    adopt(target);
  } else if (share <= kJoinBefore + kSameTime) {
    begin_segment();
    aim();
  }
}

/// Makes the end of the present step the point to which the newest known target leads.
void Trajectory::aim() noexcept {
  aims_ = true;
  const Step ahead = last_step_ + 1 - known_.step;
  if (ahead > settings_.missed_most) {
    const double left_s = interval_begin_s_ + step_s_ - segment_begin_s_;
    target_.displacement_m = begin_displacement_m_ + 0.75 * left_s * begin_velocity_m_per_s_;
    end_velocity_m_per_s_ = 0.5 * begin_velocity_m_per_s_;
    end_acceleration_m_per_s2_.setZero();
    return;
  }
  const double ahead_s = step_s_ * static_cast<double>(ahead);
  const SiteVector velocity = known_.velocity_m_per_s / time_scale_;
  target_.displacement_m = known_.displacement_m + ahead_s * velocity;
  end_velocity_m_per_s_ = velocity;
  end_acceleration_m_per_s2_ = known_.acceleration_m_per_s2 / (time_scale_ * time_scale_);
  if (settings_.order < 2) return;
  target_.displacement_m += (0.5 * ahead_s * ahead_s) * end_acceleration_m_per_s2_;
  end_velocity_m_per_s_ += ahead_s * end_acceleration_m_per_s2_;
}

/// The step is over without its target.
void Trajectory::miss_target(ReachedTarget& reached) noexcept {
  evaluate();  // at the end of the step
  has_missed_ = true;
  reached.step = last_step_ + 1;
  reached.model_time_s = (interval_begin_s_ + step_s_) / time_scale_;
  reached.displacement_m = point_.displacement_m;
  flags_ |= MeasurementFlags::extrapolated | MeasurementFlags::late | MeasurementFlags::missed;
  if (last_step_ + 1 - known_.step > settings_.missed_most) flags_ |= MeasurementFlags::held;
  interval_begin_s_ += step_s_;
  has_left_target_ = false;
  begin_segment();
}

/// After the end of a step: the target of the next one, if it came early, or where the known ones lead.
void Trajectory::begin_step_in_time() noexcept {
  ++last_step_;
  aims_ = false;
  if (early_count_ > 0 && early_[0].step == last_step_ + 1) {
    adopt(early_[0]);
    std::move(early_.begin() + 1, early_.begin() + static_cast<std::ptrdiff_t>(early_count_), early_.begin());
    --early_count_;
    return;
  }
  // Behind a target that was reached, the predictor goes on from it.
  if (has_missed_) aim();
}

bool Trajectory::advance(double interval_s, ReachedTarget& reached) noexcept {
  if (!is_running_ || stands_) return false;
  const double before_s = path_time_s_;
  const double target_time_s = interval_begin_s_ + step_s_;
  const bool is_initial = is_first_target_;
  const bool waits = !has_target_ && settings_.type == TrajectoryType::ramp_and_hold;
  if (!std::exchange(is_first_target_, false) && !waits) {
    choose_rate(interval_s);
    path_time_s_ += rate_ * interval_s;
  }
  if (has_target_ && std::abs(path_time_s_ - target_time_s) < kSameTime * step_s_) path_time_s_ = target_time_s;
  if (settings_.keeps_time && std::abs(path_time_s_ - target_time_s) < kSameTime * step_s_)
    path_time_s_ = target_time_s;
  const bool is_missed = settings_.keeps_time && !has_target_ && path_time_s_ >= target_time_s;
  if (is_missed) {
    const double now_s = std::exchange(path_time_s_, target_time_s);
    reached.fraction = now_s > before_s ? (target_time_s - before_s) / (now_s - before_s) : 1.0;
    miss_target(reached);
    reached.flags = std::exchange(flags_, MeasurementFlags::none);
    begin_step_in_time();
    path_time_s_ = now_s;
    evaluate();
    return true;
  }
  if (!has_target_ || path_time_s_ < target_time_s) {
    evaluate();
    return false;
  }
  reached.step = target_.step;
  reached.model_time_s = target_.model_time_s;
  copy_values(target_.displacement_m, reached.displacement_m);
  reached.fraction = path_time_s_ > before_s ? (target_time_s - before_s) / (path_time_s_ - before_s) : 1.0;
  reached.flags = std::exchange(flags_, MeasurementFlags::none);
  leave_target();
  if (settings_.keeps_time && is_initial) {
    last_step_ = target_.step;
    stands_ = true;
  } else if (settings_.keeps_time) {
    has_missed_ = false;
    begin_step_in_time();
  }
  evaluate();
  if (stands_) point_.velocity_m_per_s.setZero();
  return true;
}

void Trajectory::choose_rate(double interval_s) noexcept {
  if (settings_.keeps_time) {
    rate_ = 1.0;
    if (!has_target_) flags_ |= MeasurementFlags::extrapolated;
    return;
  }
  if (has_target_) {
    rate_ = std::min(1.0, rate_ + kRateRecovery * interval_s / step_s_);
    return;
  }
  flags_ |= MeasurementFlags::extrapolated;
  const double share = (path_time_s_ - interval_begin_s_) / step_s_;
  if (share <= kSlowDownAt) return;
  rate_ = std::min(rate_, std::max(0.0, (1.0 - share) / (1.0 - kSlowDownAt)));
  flags_ |= MeasurementFlags::late;
  if (rate_ < kHeldBelow) flags_ |= MeasurementFlags::held;
}

void Trajectory::leave_target() noexcept {
  has_target_ = false;
  interval_begin_s_ += step_s_;
  segment_begin_s_ = interval_begin_s_;
  copy_values(target_.displacement_m, begin_displacement_m_);
  copy_values(end_velocity_m_per_s_, begin_velocity_m_per_s_);
  if (std::exchange(has_left_target_, true)) {
    begin_jerk_m_per_s3_ = (end_acceleration_m_per_s2_ - begin_acceleration_m_per_s2_) / step_s_;
  }
  copy_values(end_acceleration_m_per_s2_, begin_acceleration_m_per_s2_);
}

void Trajectory::halt() noexcept {
  rate_ = 0.0;
  point_.velocity_m_per_s.setZero();
  point_.acceleration_m_per_s2.setZero();
}

void Trajectory::evaluate() noexcept {
  const double since_s = path_time_s_ - segment_begin_s_;
  if (settings_.type == TrajectoryType::ramp_and_hold) {
    ramp(since_s);
  } else if (has_target_ || aims_) {
    correct(since_s);
  } else {
    predict(since_s);
  }
  point_.velocity_m_per_s = rate_ * slope_m_per_s_;
  point_.path_time_s = path_time_s_;
  point_.is_held = any(flags_ & MeasurementFlags::held);
}

/// Cubic Hermite polynomial from the present position to the target.
void Trajectory::correct(double since_s) noexcept {
  const double length_s = interval_begin_s_ + step_s_ - segment_begin_s_;
  const double x = since_s / length_s;
  const double at_target = x * x * (3.0 - 2.0 * x);
  const double at_begin_slope = x * (1.0 - x) * (1.0 - x) * length_s;
  const double at_end_slope = x * x * (x - 1.0) * length_s;
  point_.displacement_m = (1.0 - at_target) * begin_displacement_m_ + at_target * target_.displacement_m +
                          at_begin_slope * begin_velocity_m_per_s_ + at_end_slope * end_velocity_m_per_s_;
  slope_m_per_s_ = (6.0 * x * (1.0 - x) / length_s) * (target_.displacement_m - begin_displacement_m_) +
                   (1.0 - x) * (1.0 - 3.0 * x) * begin_velocity_m_per_s_ + x * (3.0 * x - 2.0) * end_velocity_m_per_s_;
  point_.acceleration_m_per_s2 = (1.0 - x) * begin_acceleration_m_per_s2_ + x * end_acceleration_m_per_s2_;
}

/// Taylor series from the last target, up to the order of the predictor.
void Trajectory::predict(double since_s) noexcept {
  point_.displacement_m = begin_displacement_m_ + since_s * begin_velocity_m_per_s_;
  slope_m_per_s_ = begin_velocity_m_per_s_;
  point_.acceleration_m_per_s2.setZero();
  if (settings_.order < 2) return;
  point_.displacement_m += (0.5 * since_s * since_s) * begin_acceleration_m_per_s2_;
  slope_m_per_s_ += since_s * begin_acceleration_m_per_s2_;
  point_.acceleration_m_per_s2 = begin_acceleration_m_per_s2_;
  if (settings_.order < 3) return;
  point_.displacement_m += (since_s * since_s * since_s / 6.0) * begin_jerk_m_per_s3_;
  slope_m_per_s_ += (0.5 * since_s * since_s) * begin_jerk_m_per_s3_;
  point_.acceleration_m_per_s2 += since_s * begin_jerk_m_per_s3_;
}

/// Raised cosine from rest to rest over the first part of the step.
void Trajectory::ramp(double since_s) noexcept {
  const double length_s = (1.0 - settings_.hold_share) * (interval_begin_s_ + step_s_ - segment_begin_s_);
  const double pi_x = std::numbers::pi * since_s / length_s;
  if (!has_target_ || since_s >= length_s) {
    point_.displacement_m = has_target_ ? target_.displacement_m : begin_displacement_m_;
    slope_m_per_s_.setZero();
    point_.acceleration_m_per_s2.setZero();
    return;
  }
  const double frequency_per_s = std::numbers::pi / length_s;
  const SiteVector half_way_m = 0.5 * (target_.displacement_m - begin_displacement_m_);
  point_.displacement_m = begin_displacement_m_ + (1.0 - std::cos(pi_x)) * half_way_m;
  slope_m_per_s_ = (frequency_per_s * std::sin(pi_x)) * half_way_m;
  point_.acceleration_m_per_s2 = (frequency_per_s * frequency_per_s * std::cos(pi_x)) * half_way_m;
}

}  // namespace hybridtest
