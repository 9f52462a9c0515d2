#include "diagnosis/identification/smoothing_choice.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "diagnosis/identification/search_table.hpp"
#include "diagnosis/signals/signals.hpp"
#include "diagnosis/traces/traces.hpp"
#include "diagnosis/tuning.hpp"

namespace hybridtest {

namespace {

/// Whether the model has inertia or damping in addition to its law.
bool follows_derivatives(const SiteModel& model) {
  return std::ranges::any_of(model.effects, [](const EffectSetting& effect) {
    return effect.type->interface == EffectInterface::specimen && effect.type->traits.follows_derivatives;
  });
}

bool can_be_smoothed(const Segment& segment) {
  return segment.to == Channel::measured_force && !segment.is_quasi_static;
}

/// The corners of its force are predicted as they are, not smoothed with the measured ones.
Segment with_corners(Segment segment) {
  segment.smoothed_by = 0.0;
  return segment;
}

/// See Segment::smoothing_errors.
std::vector<double> smoothing_errors(const SiteModel& model, const Segment& smooth, const DofRecording& dof) {
  std::vector<double> errors = FlatSmoother{smooth.smoothed_by}.smooth(predict(model, with_plain_motion(smooth, dof)));
  const std::vector<double> first_motion = predict(model, smooth);
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const bool is_judged = i >= smooth.unjudged && i + smooth.unjudged < errors.size();
    errors[i] = is_judged ? errors[i] - first_motion[i] : 0.0;
  }
  return errors;
}

double squared_difference(const std::vector<double>& values, const std::vector<double>& others) {
  double squares = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) squares += std::pow(values[i] - others[i], 2);
  return squares;
}

/// The deviation with the least squares of all that are tried, and these.
struct Deviation {
  double value = 0.0;
  double squares = std::numeric_limits<double>::infinity();
};

/// @param squares   that one deviation of the motion leaves of the recorded force.
template <class Squares>
Deviation best_deviation(const Segment& segment, const DofRecording& dof, const PartProgress& progress,
                         Squares&& squares) {
  Deviation best;
  for (const double deviation : tuning::kSmoothingDeviations) {
    progress.alive();
    const double here = squares(with_corners(smoothed_alike(segment, dof, deviation)));
    if (here < best.squares) best = {deviation, here};
  }
  return best;
}

Segment smoothed_by(const SiteModel& model, const Segment& segment, const DofRecording& dof, double best) {
  Segment smooth = smoothed_alike(segment, dof, tuning::kSmoothingNextStep * best);
  smooth.smoothing_errors = smoothing_errors(model, smooth, dof);
  smooth.smoothing_error = std::sqrt(mean_square(smooth.smoothing_errors));
  return smooth;
}

Segment best_smoothed(const SiteModel& model, const Segment& segment, const DofRecording& dof,
                      const PartProgress& progress) {
  const Deviation best = best_deviation(segment, dof, progress, [&](const Segment& tried) {
    return squared_difference(segment.measured, predict(model, tried));
  });
  return smoothed_by(model, segment, dof, best.value);
}

/// What may stand beside the model and a spring and a damper.
struct MayStand {
  bool friction = false;  // dry friction and other hysteresis
  bool mass = false;
};

/// The way of sliders that are held by springs and slide after distances in the range of a friction's, beside each
/// other: what they carry is any hysteresis that does not depend on the rate (Iwan, 1966). One column for each slider.
Eigen::MatrixXd held_back(const std::vector<Motion>& motion) {
  const EffectType* const friction = find_effect(specimen, "coulomb_friction");
  const SearchRange& range = *search_range(
      *friction, *std::ranges::find(friction->parameters, "presliding_displacement_m", &EffectParameter::name));
  const std::array after{range.low, std::sqrt(range.low * range.high), range.high};
  const auto [low, high] = std::ranges::minmax_element(motion, {}, &Motion::displacement_m);
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(motion.size()), std::ssize(after));
  for (Eigen::Index column = 0; column < columns.cols(); ++column) {
    const double slides_m =
        after[static_cast<std::size_t>(column)] * 0.5 * (high->displacement_m - low->displacement_m);
    double held_m = 0.0;
    for (Eigen::Index row = 0; row < columns.rows(); ++row) {
      const auto i = static_cast<std::size_t>(row);
      const double moved_m = i == 0 ? 0.0 : motion[i].displacement_m - motion[i - 1].displacement_m;
      held_m = std::clamp(held_m + moved_m, -slides_m, slides_m);
      columns(row, column) = held_m;
    }
  }
  return columns;
}

/// What least squares leave of a right side, the columns from `free` on with no size below zero [sum of squares].
double left_by(Eigen::MatrixXd columns, const Eigen::VectorXd& right, Eigen::Index free) {
  while (true) {
    const Eigen::VectorXd sizes = columns.colPivHouseholderQr().solve(right);
    Eigen::Index least = columns.cols();
    if (columns.cols() == free || sizes.tail(columns.cols() - free).minCoeff(&least) >= 0.0) {
      return (right - columns * sizes).squaredNorm();
    }
    columns.col(free + least) = columns.rightCols(1).eval();
    columns.conservativeResize(Eigen::NoChange, columns.cols() - 1);
  }
}

/// What the model and what may stand beside it leave of a force along the motion of a smoothed segment [mean square].
/// A friction and a mass are not negative: dry friction would be such a mass in part, and a force that comes late such
/// a friction.
double left_beside(const SiteModel& model, const std::vector<double>& force_n, const Segment& smooth, MayStand beside) {
  const auto first = static_cast<Eigen::Index>(smooth.unjudged);
  const auto judged = static_cast<Eigen::Index>(force_n.size()) - 2 * first;
  if (judged < static_cast<Eigen::Index>(tuning::kSamplesMin)) return std::numeric_limits<double>::infinity();
  const std::vector<double> predicted = predict(model, smooth);
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(force_n.size()), 5);
  columns << Eigen::Map<const Eigen::VectorXd>{predicted.data(), columns.rows()}, motion_columns(smooth.input);
  const Eigen::Index free = columns.cols() - 1;  // all but the mass
  if (!beside.mass) columns.conservativeResize(Eigen::NoChange, free);
  if (beside.friction) {
    const Eigen::MatrixXd sliders = held_back(smooth.input);
    columns.conservativeResize(Eigen::NoChange, columns.cols() + sliders.cols());
    columns.rightCols(sliders.cols()) = sliders;
  }
  const Eigen::VectorXd right =
      Eigen::Map<const Eigen::VectorXd>{force_n.data(), columns.rows()}.segment(first, judged);
  return left_by(columns.middleRows(first, judged), right, free) / static_cast<double>(judged);
}

/// A specimen that is simulated turns at reversals that are as small as the noise, too, and a real one does not: they
/// are ignored unless the force is nearer to the model's with them.
void settle_reversals(const SiteModel& model, Segment& segment) {
  if (segment.to != Channel::measured_force || !(segment.reversal_noise_m > 0.0)) return;
  Segment with_all = segment;
  with_all.reversal_noise_m = 0.0;
  const bool are_nearer = left_beside(model, segment.measured, with_all, MayStand{}) <
                          left_beside(model, segment.measured, segment, MayStand{});
  if (are_nearer) segment.reversal_noise_m = 0.0;
}

/// The motion alone smoothed, the force as it is.
Segment with_smooth_motion(const Segment& segment, double deviation) {
  Segment result = segment;
  result.input = FlatSmoother{deviation}.smooth(segment.input);
  return result;
}

/// Smoothed alike where there is a gap of which a mass that the model lacks explains more than half: the noise of an
/// acceleration that is not smoothed hides most of such a mass.
/// @param friction   beside dry friction.
std::optional<Segment> smoothed_for_mass(const SiteModel& model, const Segment& segment, const DofRecording& dof,
                                         bool friction, const PartProgress& progress) {
  const MayStand with_mass{.friction = friction, .mass = true};
  const Deviation best = best_deviation(segment, dof, progress, [&](const Segment& tried) {
    return left_beside(model, segment.measured, tried, with_mass);
  });
  if (!(best.value > 0.0)) return {};
  Segment smooth = smoothed_by(model, segment, dof, best.value);
  const double output = std::sqrt(mean_square(segment.measured));
  const double floor = std::hypot(smooth.measured_noise, tuning::kModelAllowance * output);
  // Force and motion are smoothed alike, so that what smoothing takes off the one does not look like a mass.
  const double without = left_beside(model, smooth.measured, smooth, {.friction = friction});
  const double with = left_beside(model, smooth.measured, smooth, with_mass);
  // Of a law with hysteresis, smoothing may take off as much as the gap.
  const double unseen = std::max(floor, smooth.smoothing_error);
  const bool explains_a_gap = without > std::pow(tuning::kNearFloor * unseen, 2) && with < tuning::kMainShare * without;
  return explains_a_gap ? std::optional{std::move(smooth)} : std::nullopt;
}

}  // namespace

std::vector<double> change_by_smoothing(const SiteModel& model, const Segment& segment) {
  if (!can_be_smoothed(segment) || segment.noise.empty() || segment.is_smoothed()) return {};
  std::vector<Deviation> tried;
  for (const double deviation : tuning::kSmoothingDeviations) {
    tried.push_back(
        {deviation, left_beside(model, segment.measured, with_smooth_motion(segment, deviation), MayStand{})});
  }
  const double least = std::ranges::min(tried, {}, &Deviation::squares).squares;
  // Wider ones cut the corners of the law off.
  const auto enough = std::ranges::find_if(
      tried, [&](const Deviation& one) { return one.squares <= tuning::kSmoothingLeaves * least; });
  if (!(enough->value > 0.0)) return {};
  std::vector<double> change = predict(model, with_smooth_motion(segment, enough->value));
  const std::vector<double> as_it_is = predict(model, segment);
  for (std::size_t i = 0; i < change.size(); ++i) change[i] -= as_it_is[i];
  return change;
}

double smoothing_error_beside(const SiteModel& model, std::span<const EffectSetting> effects, const Segment& segment) {
  if (!segment.is_smoothed() || !(segment.smoothing_error > 0.0)) return segment.smoothing_error;
  const FlatSmoother smoother{segment.smoothed_by};
  const Segment once = with_corners(segment);
  const Segment twice = with_smooth_motion(once, segment.smoothed_by);
  const auto squares = [&](std::span<const EffectSetting> added) {
    return squared_difference(smoother.smooth(predict(model, once, added)), predict(model, twice, added));
  };
  const double own = squares({});
  return own > 0.0 ? segment.smoothing_error * std::sqrt(squares(effects) / own) : segment.smoothing_error;
}

std::vector<Segment> modelled_segments(const SiteModel& model, const Recording& recording, std::size_t dof,
                                       std::size_t position) {
  return modelled_segments(model, recording, dof, position, model);
}

std::vector<Segment> modelled_segments(const SiteModel& model, const Recording& recording, std::size_t dof,
                                       std::size_t position, const SiteModel& completed, const PartProgress& progress) {
  std::vector<Segment> segments;
  for (Segment& segment : segments_of(recording, dof, position)) {
    if (!is_modelled(model, segment)) continue;
    const bool is_smoothed = can_be_smoothed(segment) && follows_derivatives(completed);
    segments.push_back(is_smoothed ? best_smoothed(completed, segment, recording.dofs[dof], progress)
                                   : std::move(segment));
    settle_reversals(completed, segments.back());
  }
  return segments;
}

std::vector<Segment> segments_to_search(const SiteModel& model, const Recording& recording, std::size_t dof,
                                        std::size_t position, const PartProgress& progress) {
  std::vector<Segment> segments = modelled_segments(model, recording, dof, position, model, progress);
  for (Segment& segment : segments) {
    if (!can_be_smoothed(segment) || follows_derivatives(model)) continue;
    for (const bool friction : {false, true}) {
      auto smooth = smoothed_for_mass(model, segment, recording.dofs[dof], friction, progress);
      if (!smooth) continue;
      segment = *std::move(smooth);
      break;
    }
  }
  return segments;
}

}  // namespace hybridtest
