#include "diagnosis/verdict/refutations.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <string_view>

#include "diagnosis/identification/law_candidates.hpp"
#include "diagnosis/identification/search.hpp"
#include "diagnosis/identification/search_table.hpp"
#include "diagnosis/page/wording.hpp"
#include "diagnosis/signals/signals.hpp"
#include "diagnosis/tuning.hpp"
#include "plant/effects/parameter_limits.hpp"

namespace hybridtest {

namespace {

using enum EffectInterface;

/// One fitted effect and the data that may speak against it.
struct Suspect {
  const IdentificationProblem& problem;
  const FitOutcome& outcome;
  const EffectSetting& effect;
  const std::vector<ParameterEstimate>& estimates;

  [[nodiscard]] const ParameterEstimate& parameter(std::string_view name) const {
    const auto found = std::ranges::find(effect.type->parameters, name, &EffectParameter::name);
    return estimates[static_cast<std::size_t>(found - effect.type->parameters.begin())];
  }
  [[nodiscard]] const Eigen::MatrixXd& covariance() const {
    return outcome.covariances[static_cast<std::size_t>(&effect - outcome.effects.data())];
  }
  [[nodiscard]] std::string name() const {
    return report::plain(effect.type->name) + " of the " + report::plain(name_of(effect.type->interface));
  }
  /// Whether this segment ends in the channel that the effect changes.
  [[nodiscard]] bool ends_at(const FitSegment& fit) const {
    const bool is_force = effect.type->interface == specimen || effect.type->interface == force_sensor;
    return fit.segment.to == (is_force ? Channel::measured_force : Channel::measured_displacement) &&
           fit.segment.touched_by(*effect.type);
  }
};

double noise_peak(const FitSegment& fit) {
  return peak_of_noise(std::max(fit.segment.measured_noise, fit.sample_floor), fit.segment.measured.size());
}

double own_noise_peak(const FitSegment& fit) {
  return peak_of_noise(fit.segment.measured_noise, fit.segment.measured.size());
}

double largest(std::span<const double> values) {
  double most = 0.0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

/// Changes over `lag` samples, per sample.
std::vector<double> changes_over(std::span<const double> values, std::size_t lag) {
  std::vector<double> changes;
  for (std::size_t i = lag; i < values.size(); ++i) {
    changes.push_back((values[i] - values[i - lag]) / static_cast<double>(lag));
  }
  return changes;
}

/// Readings that a limit bounds, in its unit, and the noise that they may pass it by. How much of the largest is noise
/// for certain, the channel alone says: of the floor a part may be a gap that another effect makes.
struct Bounded {
  std::vector<double> readings;
  double noise = 0.0;
  double own_noise = 0.0;
};

/// Speeds over windows of 1, 2, 4 … samples up to the length that speeds are checked over elsewhere: the wider, the
/// less noise.
std::vector<Bounded> speeds(const FitSegment& fit) {
  std::vector<Bounded> result;
  const double period_s = fit.segment.period_s;
  for (std::size_t lag = 1; static_cast<double>(lag) * period_s <= tuning::kRestLength_s; lag *= 2) {
    Bounded speed{.readings = changes_over(fit.segment.measured, lag)};
    for (double& value : speed.readings) value /= period_s;
    const double noise_of_speed = std::sqrt(2.0) / (static_cast<double>(lag) * period_s);
    speed.noise = noise_of_speed * noise_peak(fit);
    speed.own_noise = noise_of_speed * own_noise_peak(fit);
    result.push_back(std::move(speed));
  }
  return result;
}

std::vector<Bounded> readings(const FitSegment& fit) {
  if (!fit.segment.is_smoothed()) return {{fit.segment.measured, noise_peak(fit), own_noise_peak(fit)}};
  const AsRecorded& recorded = fit.segment.recorded;
  const std::size_t size = recorded.values.size();
  return {{recorded.values, peak_of_noise(std::max(recorded.noise, fit.sample_floor), size),
           peak_of_noise(recorded.noise, size)}};
}

/// A limit that bounds what is read: `unit` of the limit.
std::string limit_refuted(const Suspect& suspect, std::string_view name, std::string_view unit,
                          std::vector<Bounded> (*bounded)(const FitSegment&)) {
  const ParameterEstimate& limit = suspect.parameter(name);
  // Beside a gap that it does not explain, a limit is not sure; but what is read at a limit is the limit.
  const double unsure = std::min(tuning::kTwoSided95 * limit.standard_error, tuning::kBeyondLimit * limit.value);
  double reached = 0.0;
  for (const FitSegment& fit : suspect.problem.segments) {
    if (!suspect.ends_at(fit)) continue;
    for (const Bounded& bound : bounded(fit)) {
      const double highest = limit.value / (1.0 - tuning::kBeyondLimit) + unsure + bound.noise;
      const auto beyond =
          std::ranges::count_if(bound.readings, [&](double value) { return std::abs(value) > highest; });
      if (static_cast<std::size_t>(beyond) >= tuning::kClippedRun) {
        return fmt::format("{}: {:.2g} % of the readings pass its limit of {}", suspect.name(),
                           100.0 * static_cast<double>(beyond) / static_cast<double>(bound.readings.size()),
                           report::quantity(limit.value, unit));
      }
      reached = std::max(reached, largest(bound.readings) - bound.own_noise);
    }
  }
  if (reached >= (1.0 - tuning::kBeyondLimit) * limit.value - unsure) return {};
  return fmt::format("{}: no reading comes near its limit of {}", suspect.name(), report::quantity(limit.value, unit));
}

/// What a stretch at rest reads beyond the model.
struct RestGap {
  double begin_s = 0.0;
  double place_m = 0.0;
  double gap = 0.0;
};

/// Where a prediction is set to what was measured there is no gap to read.
std::vector<RestGap> gaps_at_rest(const FitSegment& fit, std::span<const double> input_m) {
  std::vector<RestGap> gaps;
  const std::size_t first = fit.segment.unjudged;
  const std::size_t last = input_m.size() - std::min(input_m.size(), fit.segment.unjudged);
  for (const RestStretch& rest : rest_stretches(input_m, fit.segment.period_s)) {
    const auto begin = static_cast<Eigen::Index>((std::max(rest.begin, first) + fit.averaged - 1) / fit.averaged);
    const auto end = static_cast<Eigen::Index>(std::min(rest.begin + rest.count, last) / fit.averaged);
    if (end <= begin || end > fit.measured.size()) continue;
    gaps.push_back({.begin_s = static_cast<double>(rest.begin) * fit.segment.period_s,
                    .place_m = input_m[rest.begin],
                    .gap = (fit.measured - fit.baseline).segment(begin, end - begin).mean()});
  }
  return gaps;
}

bool is_nearer_to_none(double read, double claimed) { return std::abs(read) < std::abs(read - claimed); }

/// Before any motion, at the place where the model is at rest, a bias is all that a sensor reads.
std::string bias_refuted(const Suspect& suspect, std::string_view name, std::string_view unit) {
  const double bias = suspect.parameter(name).value;
  for (const FitSegment& fit : suspect.problem.segments) {
    if (!suspect.ends_at(fit)) continue;
    const std::vector<double> input_m = displacements_of(fit.segment.input);
    const std::vector<RestGap> gaps = gaps_at_rest(fit, input_m);
    const double judged_from_s = static_cast<double>(fit.segment.unjudged) * fit.segment.period_s;
    if (gaps.empty() || gaps.front().begin_s > judged_from_s) continue;
    if (std::abs(gaps.front().place_m) > reversal_threshold_m(input_m)) continue;
    if (!is_nearer_to_none(gaps.front().gap, bias)) continue;
    return fmt::format("{} by {}: at rest before the test the reading differs from the model by {}", suspect.name(),
                       report::quantity(bias, unit), report::quantity(gaps.front().gap, unit));
  }
  return {};
}

/// Between two rests at one place, readings move by the drift.
std::string drift_refuted(const Suspect& suspect, std::string_view name, std::string_view unit) {
  const double drift_per_s = suspect.parameter(name).value;
  for (const FitSegment& fit : suspect.problem.segments) {
    if (!suspect.ends_at(fit)) continue;
    const std::vector<double> input_m = displacements_of(fit.segment.input);
    const std::vector<RestGap> gaps = gaps_at_rest(fit, input_m);
    const double here_m = reversal_threshold_m(input_m);
    const auto last = std::find_if(gaps.rbegin(), gaps.rend(), [&](const RestGap& gap) {
      return std::abs(gap.place_m - gaps.front().place_m) <= here_m;
    });
    if (last == gaps.rend()) continue;
    const double claimed = drift_per_s * (last->begin_s - gaps.front().begin_s);
    const double read = last->gap - gaps.front().gap;
    // Only rests that are far apart say something of a whole recording.
    const double whole = drift_per_s * fit.segment.period_s * static_cast<double>(input_m.size());
    if (std::abs(claimed) < tuning::kMainShare * std::abs(whole) || !is_nearer_to_none(read, claimed)) continue;
    return fmt::format("{}: between rests at the same place the reading should move by {} and moves by {}",
                       suspect.name(), report::quantity(claimed, unit), report::quantity(read, unit));
  }
  return {};
}

/// T of y = g (x - T x'): how late y is behind x, whatever their gain and zero, and the size of what else may be in y.
double lateness_s(const Eigen::VectorXd& x, const Eigen::VectorXd& rate, const Eigen::VectorXd& y,
                  const Eigen::MatrixXd& others = {}) {
  Eigen::MatrixXd columns{x.size(), 3 + others.cols()};
  columns.leftCols(3) << x, rate, Eigen::VectorXd::Ones(x.size());
  if (others.cols() > 0) columns.rightCols(others.cols()) = others;
  const Eigen::VectorXd solution = columns.colPivHouseholderQr().solve(y);
  return -solution[1] / solution[0];
}

/// How late a channel is behind the one that it follows.
double reading_lateness_s(const FitSegment& fit) {
  const auto size = static_cast<Eigen::Index>(fit.segment.input.size());
  Eigen::VectorXd x{size};
  Eigen::VectorXd rate{size};
  for (Eigen::Index i = 0; i < size; ++i) {
    const Motion& motion = fit.segment.input[static_cast<std::size_t>(i)];
    x[i] = motion.displacement_m;
    rate[i] = motion.velocity_m_per_s;
  }
  return lateness_s(x, rate, Eigen::Map<const Eigen::VectorXd>{fit.segment.measured.data(), size});
}

/// What a wrong strength of the model's law changes; no columns where the law has none.
Eigen::MatrixXd strength_slope(const IdentificationProblem& problem, const FitSegment& fit) {
  const EffectSetting stronger{find_effect(specimen, ModelNumber::strength), {tuning::kResolution}};
  if (!problem.law_has_strength || !fit.segment.touched_by(*stronger.type)) return {};
  return predict(problem, fit, std::span{&stronger, 1}) - fit.baseline;
}

/// How late the measured force is behind the one that the model has for the reading. The loop of a law that is too
/// strong would look late, too, so its strength is free.
double force_lateness_s(const IdentificationProblem& problem, const FitSegment& fit) {
  const Eigen::MatrixXd& directions = fit.numbers.directions;
  Eigen::VectorXd read = fit.measured;
  if (directions.cols() > 0) read += directions * fit.numbers.off;  // as it was before the numbers were free
  const Eigen::Index size = read.size() - 2;
  const double step_s = fit.segment.period_s * static_cast<double>(fit.averaged);
  Eigen::MatrixXd slope = strength_slope(problem, fit);
  if (slope.rows() > 0) slope = slope.middleRows(1, size).eval();
  return lateness_s(fit.baseline.segment(1, size), (fit.baseline.tail(size) - fit.baseline.head(size)) / (2.0 * step_s),
                    read.segment(1, size), slope);
}

/// What a transducer that lags reads is late behind the command, as no actuator is early; and the force is early before
/// it by as much, as no damping is negative.
std::string transducer_lag_refuted(const Suspect& suspect) {
  const double lag_s = suspect.parameter("time_constant_s").value;
  const std::string claim = suspect.name() + " by " + report::quantity(lag_s, "s");
  for (const FitSegment& fit : suspect.problem.segments) {
    if (fit.segment.from == Channel::command_displacement && suspect.ends_at(fit)) {
      const double late_s = reading_lateness_s(fit);
      if (is_nearer_to_none(late_s, lag_s)) {
        return fmt::format("{}: the reading comes {} after the command", claim, report::quantity(late_s, "s"));
      }
    }
    if (fit.segment.to == Channel::measured_force && fit.segment.touched_by(*suspect.effect.type) &&
        fit.baseline.squaredNorm() > 0.0) {
      const double early_s = -force_lateness_s(suspect.problem, fit);
      if (is_nearer_to_none(early_s, lag_s)) {
        return fmt::format("{}: the force comes {} before what the model has for the reading", claim,
                           report::quantity(early_s, "s"));
      }
    }
  }
  return {};
}

bool slides_as_in_model(const Suspect& suspect) {
  const EffectType& type = *suspect.effect.type;
  const EffectSetting* const own = place_of(suspect.problem.model, type);
  const std::optional<std::size_t> position = presliding_of(type);
  if (own == nullptr || !position) return false;
  const ParameterEstimate& estimate = suspect.estimates[*position];
  return estimate.value - half_width_95(estimate) <= own->values[*position];
}

/// Between reversals friction sticks over twice its presliding displacement, then it slides.
std::string friction_refuted(const Suspect& suspect) {
  if (slides_as_in_model(suspect)) return {};
  const double sticks_m = 2.0 * suspect.parameter("presliding_displacement_m").value;
  double path_m = 0.0;
  double stuck_m = 0.0;
  for (const FitSegment& fit : suspect.problem.segments) {
    if (!suspect.ends_at(fit)) continue;
    const std::vector<double> input_m = displacements_of(fit.segment.input);
    double last_m = input_m.front();
    for (const Reversal& reversal : reversals_of(input_m, reversal_threshold_m(input_m))) {
      const double way_m = std::abs(reversal.displacement_m - last_m);
      path_m += way_m;
      stuck_m += std::min(way_m, sticks_m);
      last_m = reversal.displacement_m;
    }
  }
  if (stuck_m <= tuning::kMainShare * path_m) return {};
  return fmt::format("{}: it would stick over {:.0f} % of the path, as a spring that yields", suspect.name(),
                     100.0 * stuck_m / path_m);
}

/// A friction that grows at velocities as small or as large as are looked for, or by as little, may as well be dry
/// friction alone or a damping.
std::string strengthening_refuted(const Suspect& suspect) {
  if (place_of(suspect.problem.model, *suspect.effect.type) != nullptr) return friction_refuted(suspect);
  const ParameterEstimate& slow = suspect.parameter("slow_friction_ratio");
  const bool hardly_grows = slow.at_bound && slow.value > 0.5;  // the other end is zero
  if (hardly_grows || suspect.parameter("friction_rate_s_per_m").at_bound) {
    return suspect.name() + ": it may as well be dry friction or a damping";
  }
  return friction_refuted(suspect);
}

/// A power that may as well be the first or the second is a linear or a quadratic damping; as small a one as is looked
/// for, dry friction; and beside dry friction a part of that, which no formula of it has quite.
std::string power_refuted(const Suspect& suspect) {
  if (place_of(suspect.problem.model, *suspect.effect.type) != nullptr) return {};  // a damper that the model has
  const bool is_beside_friction = std::ranges::any_of(
      suspect.outcome.effects, [](const EffectSetting& effect) { return presliding_of(*effect.type).has_value(); });
  const ParameterEstimate& exponent = suspect.parameter("exponent");
  if (is_beside_friction || (exponent.at_bound && exponent.value < 1.0)) {
    return suspect.name() + ": it may as well be dry friction";
  }
  for (const auto& [power, name] : {std::pair{1.0, "linear"}, {2.0, "quadratic"}}) {
    if (std::abs(exponent.value - power) <= half_interval_95(exponent)) {
      return fmt::format("{}: it may as well be {}", suspect.name(), name);
    }
  }
  return {};
}

/// The shortest relaxation that is looked for is hardly more than a dashpot.
std::string relaxation_refuted(const Suspect& suspect) {
  const ParameterEstimate& time = suspect.parameter("time_constant_s");
  const SearchRange* const range = search_range(*suspect.effect.type, suspect.effect.type->parameters.back());
  const bool is_shortest = time.at_bound && time.value < 0.5 * range->high * suspect.problem.scales.of(range->scale);
  return is_shortest ? suspect.name() + ": it may as well be a viscous damping" : std::string{};
}

/// A part that may as well have been broken before the test is a model that is too stiff: what it carried until it
/// broke has to be seen in what is left otherwise.
std::string instant_refuted(const Suspect& suspect) {
  const ParameterEstimate& instant = suspect.parameter("instant_s");
  const double instant_s = instant.value;
  const double from_an_end_s = std::min(instant_s, suspect.problem.scales.duration_s - instant_s);
  if (half_interval_95(instant) >= from_an_end_s) {
    return fmt::format("{}: the recordings do not tell when", suspect.name());
  }
  const double lost_ratio = suspect.parameter("lost_ratio").value;
  double deviance = 0.0;
  for (std::size_t i = 0; i < suspect.problem.segments.size(); ++i) {
    const FitSegment& fit = suspect.problem.segments[i];
    if (!suspect.ends_at(fit)) continue;
    const double period_s = fit.segment.period_s * static_cast<double>(fit.averaged);
    const auto before = std::min(fit.measured.size(), static_cast<Eigen::Index>(instant_s / period_s));
    const double carried = lost_ratio * lost_ratio * fit.measured.head(before).squaredNorm();
    const double left = suspect.outcome.segments[i].mean_square * static_cast<double>(fit.measured.size());
    deviance += fit.independent * carried / left;
  }
  if (deviance > tuning::kTwoSided95 * tuning::kTwoSided95) return {};
  return fmt::format("{}: the recordings do not show the part that broke at {}", suspect.name(),
                     report::quantity(instant_s, "s"));
}

/// An axial load larger than is looked for, over its column's height, would push any specimen over that gives this
/// force: it can only be a part of two numbers that cancel each other, the load and a stiffness.
std::string load_refuted(const Suspect& suspect) {
  const SignalScales& scales = suspect.problem.scales;
  const double stiffness_n_per_m = scales.of(ParameterScale::stiffness_n_per_m);
  const double load_n = std::abs(suspect.parameter("axial_force_n").value);
  const double most_n = search_range(*suspect.effect.type, suspect.effect.type->parameters.front())->high /
                        tuning::kHeightOverStroke * stiffness_n_per_m * suspect.parameter("height_m").value;
  if (load_n <= most_n) return {};
  return fmt::format("{}: no specimen of {} would stand under that load", suspect.name(),
                     report::quantity(stiffness_n_per_m, "N/m"));
}

/// What speaks against an effect beyond its interval.
struct Check {
  EffectInterface interface;
  std::string_view effect;
  std::string (*refuted)(const Suspect&);
};

constexpr std::array kChecks{
    Check{force_sensor, "saturation", [](const Suspect& s) { return limit_refuted(s, "limit_n", "N", readings); }},
    Check{transfer_system, "stroke_limit",
          [](const Suspect& s) { return limit_refuted(s, "stroke_limit_m", "m", readings); }},
    Check{transfer_system, "velocity_limit",
          [](const Suspect& s) { return limit_refuted(s, "velocity_limit_m_per_s", "m/s", speeds); }},
    Check{force_sensor, "bias", [](const Suspect& s) { return bias_refuted(s, "bias_n", "N"); }},
    Check{displacement_sensor, "bias", [](const Suspect& s) { return bias_refuted(s, "bias_m", "m"); }},
    Check{force_sensor, "drift", [](const Suspect& s) { return drift_refuted(s, "drift_n_per_s", "N"); }},
    Check{displacement_sensor, "drift", [](const Suspect& s) { return drift_refuted(s, "drift_m_per_s", "m"); }},
    Check{displacement_sensor, "lag", transducer_lag_refuted},
    Check{specimen, "fracture", instant_refuted},
    Check{specimen, "geometric_stiffness", load_refuted},
    Check{specimen, "nonlinear_viscous_damping", power_refuted},
    Check{specimen, "relaxation", relaxation_refuted},
    Check{specimen, "coulomb_friction", friction_refuted},
    Check{specimen, "stribeck_friction", friction_refuted},
    Check{specimen, "velocity_strengthening_friction", strengthening_refuted},
    Check{specimen, "friction_with_input", friction_refuted},
};

/// What is not known of a parameter while the others of its effect are as they were found, over what is not known of it
/// while they are free.
double doubt_with_shape_held(const Eigen::MatrixXd& covariance, std::size_t parameter) {
  std::vector<Eigen::Index> free;
  Eigen::Index own = 0;
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
    if (!(covariance(i, i) > 0.0)) continue;
    if (i == static_cast<Eigen::Index>(parameter)) own = static_cast<Eigen::Index>(free.size());
    free.push_back(i);
  }
  if (free.size() < 2) return 1.0;
  Eigen::MatrixXd correlation = covariance(free, free);
  const Eigen::VectorXd deviations = correlation.diagonal().cwiseSqrt();
  correlation = deviations.cwiseInverse().asDiagonal() * correlation * deviations.cwiseInverse().asDiagonal();
  correlation.diagonal().array() += tuning::kCovarianceRidge;
  const Eigen::VectorXd unit = Eigen::VectorXd::Unit(correlation.rows(), own);
  return 1.0 / std::sqrt(std::max(1.0, unit.dot(correlation.ldlt().solve(unit))));
}

/// The parameter whose interval holds the value at which the effect is absent: what the effect is proportional to, or
/// its only parameter. Null when none does.
/// @param half_of   half the interval of the parameter at a position.
template <class HalfOf>
const EffectParameter* absent_in_interval(const Suspect& suspect, HalfOf half_of) {
  const EffectType& type = *suspect.effect.type;
  // A parameter that may be left out and is, as the second pole of a lag, is none.
  std::size_t free = 0;
  for (std::size_t i = 0; i < suspect.estimates.size(); ++i) {
    const bool is_left_out = suspect.estimates[i].value == left_out(suspect.problem, type, i);
    if (!is_left_out && !is_fixed(suspect.problem, type, type.parameters[i])) ++free;
  }
  for (std::size_t i = 0; i < suspect.estimates.size(); ++i) {
    const EffectParameter& parameter = type.parameters[i];
    const bool can_be_absent = std::isfinite(parameter.neutral) && std::abs(parameter.neutral) < kUnbounded;
    if (!can_be_absent || (free > 1 && !parameter.is_linear) || is_fixed(suspect.problem, type, parameter)) continue;
    if (std::abs(suspect.estimates[i].value - parameter.neutral) <= half_of(i)) return &parameter;
  }
  return nullptr;
}

/// Whether the life of something that degrades may be endless, by the interval that is reported. Its inverse is then
/// zero: to first order that is in its interval where the life's own is as wide as the life.
bool may_be_endless(const Suspect& suspect) {
  if (!degrades(*suspect.effect.type)) return false;
  for (std::size_t i = 0; i < suspect.estimates.size(); ++i) {
    const ParameterEstimate& life = suspect.estimates[i];
    if (suspect.effect.type->parameters[i].neutral == kUnbounded && life.value <= half_interval_95(life)) return true;
  }
  return false;
}

/// An effect that may as well be absent is none. Asked of what it is proportional to, or of its only parameter. Where
/// it is absent its shape means nothing: a shape that makes up for the size says nothing of absence, and is held.
/// What a model lacks besides other effects has to be seen in the interval that is reported, every
/// number of the model in doubt. An effect that the model has is none where it may be as it is there.
std::string absence_not_excluded(const Suspect& suspect) {
  const EffectType& type = *suspect.effect.type;
  const bool is_addition = type.traits.number == ModelNumber::none && type.replacement == nullptr;
  const bool is_beside_others = suspect.outcome.effects.size() > 1;
  decltype(half_width_95)& half_width = is_addition && is_beside_others ? half_interval_95 : half_width_95;
  if (const EffectSetting* const own = place_of(suspect.problem.model, type)) {
    for (std::size_t i = 0; i < suspect.estimates.size(); ++i) {
      if (std::abs(suspect.estimates[i].value - own->values[i]) > half_width_95(suspect.estimates[i])) return {};
    }
    return fmt::format("{}: the intervals hold what it is in the model", suspect.name());
  }
  const EffectParameter* const absent = absent_in_interval(suspect, [&](std::size_t i) {
    return doubt_with_shape_held(suspect.covariance(), i) * half_width(suspect.estimates[i]);
  });
  if (absent == nullptr) return {};
  return fmt::format("{}: the interval of {} holds the value at which it is absent", suspect.name(), absent->name);
}

bool is_cancelled(const Suspect& suspect) {
  if (suspect.outcome.effects.size() < 2) return false;
  double alone = 0.0;
  double together = 0.0;
  for (const FitSegment& fit : suspect.problem.segments) {
    if (!fit.is_suspect || !fit.segment.touched_by(*suspect.effect.type)) continue;
    const auto change_by = [&](std::span<const EffectSetting> effects) {
      return fit.weight * fit.weight * (predict(suspect.problem, fit, effects) - fit.baseline).squaredNorm();
    };
    alone += change_by({&suspect.effect, 1});
    together += change_by(suspect.outcome.effects);
  }
  return together < tuning::kHardlyLeft * alone;
}

}  // namespace

std::optional<std::size_t> presliding_of(const EffectType& type) {
  const auto presliding = std::ranges::find(type.parameters, "presliding_displacement_m", &EffectParameter::name);
  if (type.replacement != nullptr || presliding == type.parameters.end()) return {};
  return static_cast<std::size_t>(presliding - type.parameters.begin());
}

bool slides_as_in_model(const IdentificationProblem& problem, const FitOutcome& fit, std::size_t position) {
  return slides_as_in_model(Suspect{problem, fit, fit.effects[position], fit.parameters[position]});
}

bool is_cancelled(const IdentificationProblem& problem, const FitOutcome& fit, std::size_t position) {
  return is_cancelled(Suspect{problem, fit, fit.effects[position], fit.parameters[position]});
}

bool may_be_absent(const IdentificationProblem& problem, const FitOutcome& fit, std::size_t position) {
  const Suspect suspect{problem, fit, fit.effects[position], fit.parameters[position]};
  if (place_of(problem.model, *suspect.effect.type) != nullptr) return false;
  // The first stiffness of a law may be anything where cracks close it at once: the law is there all the same.
  const bool is_a_law = replaces_law(suspect.effect);
  const auto half_of = [&](std::size_t i) {
    const double held = is_a_law ? doubt_with_shape_held(suspect.covariance(), i) : 1.0;
    return held * half_interval_95(suspect.estimates[i]);
  };
  return absent_in_interval(suspect, half_of) != nullptr || may_be_endless(suspect);
}

bool is_law_without_loop(const IdentificationProblem& problem, const FitOutcome& fit, std::size_t position) {
  const EffectType& law = *fit.effects[position].type;
  if (law.replacement == nullptr || law.replacement->law != "self_centring") return false;
  const bool another_has_one = std::ranges::any_of(fit.effects, [&](const EffectSetting& other) {
    const EffectTraits& traits = other.type->traits;
    return other.type != &law && other.type->interface == specimen && traits.family == EffectFamily::amplitude &&
           traits.number == ModelNumber::none;
  });
  if (another_has_one) return false;
  if (std::ranges::find(law.parameters, "flag_ratio", &EffectParameter::name) == law.parameters.end()) return true;
  const ParameterEstimate& flag =
      Suspect{problem, fit, fit.effects[position], fit.parameters[position]}.parameter("flag_ratio");
  // A bound is an end of 0 to 1.
  return flag.at_bound ? flag.value < 0.5 : flag.value <= half_interval_95(flag);
}

bool is_cut_off(const IdentificationProblem& problem, const FitOutcome& fit, std::size_t position) {
  const EffectType& effect = *fit.effects[position].type;
  if (effect.replacement != nullptr) return false;
  for (std::size_t i = 0; i < effect.parameters.size(); ++i) {
    const EffectParameter& parameter = effect.parameters[i];
    const ParameterEstimate& estimate = fit.parameters[position][i];
    const std::optional<SearchRange> range = range_of(effect, parameter);
    if (!estimate.at_bound || estimate.at_least || !range) continue;
    if (estimate.value == left_out(problem, effect, i)) continue;
    // The user chose both ends.
    if (effect.formula != nullptr && estimate.value != parameter.neutral) return true;
    const double scale = problem.scales.of(range->scale);
    const bool is_upper = estimate.value > 0.5 * scale * (range->low + range->high);
    const bool is_low_chosen = range->low < 0.0 && scale * range->low > parameter.low &&
                               !range->restriction.is_amount && range->restriction.limit == SearchLimit::none;
    // Smaller than it is looked for, and not yet absent.
    const bool is_too_small = range->low > 0.0 && parameter.neutral < scale * range->low;
    const bool is_high_chosen = scale * range->high < parameter.high && !range->restriction.is_unseen_at_high;
    const bool is_chosen = is_upper ? is_high_chosen : is_low_chosen || is_too_small;
    if (is_chosen) return true;
  }
  return false;
}

namespace {

/// A law of another form that stays elastic all the time is a spring, and says nothing of its form.
std::string law_refuted(const Suspect& suspect) {
  const std::unique_ptr<Law> law = suspect.effect.type->replacement->make(suspect.effect.values);
  if (law == nullptr) return {};
  double bent = 0.0;
  double all = 0.0;
  for (const FitSegment& fit : suspect.problem.segments) {
    if (!suspect.ends_at(fit)) continue;
    law->reset();
    for (const Motion& motion : fit.segment.input) {
      const double force_n = law->trial(motion.displacement_m, motion.velocity_m_per_s);
      law->commit();
      bent += std::pow(force_n - law->initial_stiffness_n_per_m() * motion.displacement_m, 2);
      all += force_n * force_n;
    }
  }
  if (bent > tuning::kModelAllowance * tuning::kModelAllowance * all) return {};
  return suspect.name() + ": it would be a spring in these recordings";
}

/// What the recordings say against an effect by themselves.
std::string contradiction(const Suspect& suspect) {
  const EffectType& type = *suspect.effect.type;
  if (type.replacement != nullptr) {
    if (std::string why = law_refuted(suspect); !why.empty()) return why;
  }
  for (const Check& check : kChecks) {
    if (check.interface != type.interface || check.effect != type.name) continue;
    if (std::string why = check.refuted(suspect); !why.empty()) return why;
  }
  return {};
}

}  // namespace

bool is_needless(const IdentificationProblem& problem, const FitOutcome& fit, std::size_t position) {
  const Suspect suspect{problem, fit, fit.effects[position], fit.parameters[position]};
  return !absence_not_excluded(suspect).empty() || may_be_endless(suspect) || !contradiction(suspect).empty();
}

std::string refutation(const IdentificationProblem& problem, const Candidate& candidate) {
  for (std::size_t i = 0; i < candidate.fit.effects.size(); ++i) {
    // Effects found before may be needless beside this one: that is asked when all are known, see is_needless().
    if (candidate.fit.effects[i].type != candidate.type) continue;
    const Suspect suspect{problem, candidate.fit, candidate.fit.effects[i], candidate.fit.parameters[i]};
    std::string why = absence_not_excluded(suspect);
    if (why.empty()) why = contradiction(suspect);
    // A single effect may be larger than the library expects; one beside others may then be anything.
    if (why.empty() && candidate.fit.effects.size() > 1 && is_cut_off(problem, candidate.fit, i)) {
      why = suspect.name() + ": a parameter is at the limit of its search range";
    }
    if (why.empty() && is_cancelled(suspect)) {
      why = suspect.name() + ": alone it would change more than ten times what it does beside the others";
    }
    if (!why.empty()) return why;
  }
  return {};
}

void drop_refuted(const IdentificationProblem& problem, std::vector<Candidate>& candidates) {
  std::erase_if(candidates, [&](const Candidate& candidate) { return !refutation(problem, candidate).empty(); });
}

}  // namespace hybridtest
