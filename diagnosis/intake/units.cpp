#include "diagnosis/intake/units.hpp"

#include <fmt/format.h>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <string>
#include <string_view>

#include "core/config_error.hpp"
#include "diagnosis/identification/segment.hpp"
#include "diagnosis/intake/intake.hpp"
#include "diagnosis/signals/signals.hpp"
#include "diagnosis/tuning.hpp"

namespace hybridtest {

namespace {

struct OtherUnit {
  double per_metre;
  std::string_view name;
};
constexpr std::array<OtherUnit, 3> kOtherUnits{{{1000.0, "millimetres"}, {100.0, "centimetres"}, {39.3701, "inches"}}};

bool is_displacement(Channel channel) {
  return channel != Channel::measured_acceleration && channel != Channel::measured_force;
}

struct Span {
  double width = 0.0;
  std::size_t farthest = 0;  // sample of the largest magnitude
};

Span span_of(const std::vector<double>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const auto farthest = std::abs(*low) > std::abs(*high) ? low : high;
  return {*high - *low, static_cast<std::size_t>(farthest - values.begin())};
}

/// Of two channels, the second one `lag` samples later.
double correlation(std::span<const double> a, std::span<const double> b, std::size_t lag = 0) {
  a = a.first(a.size() - lag);
  b = b.subspan(lag);
  const auto n = static_cast<double>(a.size());
  const double mean_a = std::accumulate(a.begin(), a.end(), 0.0) / n;
  const double mean_b = std::accumulate(b.begin(), b.end(), 0.0) / n;
  double aa = 0.0;
  double bb = 0.0;
  double ab = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    aa += (a[i] - mean_a) * (a[i] - mean_a);
    bb += (b[i] - mean_b) * (b[i] - mean_b);
    ab += (a[i] - mean_a) * (b[i] - mean_b);
  }
  return aa > 0.0 && bb > 0.0 ? ab / std::sqrt(aa * bb) : 0.0;
}

/// In another unit a channel keeps its shape, late by what an actuator needs. One that is stuck or dead moves as little
/// as a channel in metres beside one in millimetres, but in a shape of its own.
bool is_scaled_copy(std::span<const double> a, std::span<const double> b, std::size_t longest_lag) {
  for (std::size_t lag = 0; lag <= std::min(longest_lag, a.size() / 2); ++lag) {
    if (correlation(a, b, lag) >= tuning::kScaledCopyCorrelationMin) return true;
    if (correlation(b, a, lag) >= tuning::kScaledCopyCorrelationMin) return true;
  }
  return false;
}

double fastest(const std::vector<double>& values, double period_s) {
  const auto window =
      std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(tuning::kSpeedWindow_s / period_s)));
  double largest = 0.0;
  for (std::size_t i = window; i < values.size(); ++i)
    largest = std::max(largest, std::abs(values[i] - values[i - window]));
  return largest / (static_cast<double>(window) * period_s);
}

void suspect(const RawRecording& raw, const RawColumn& column, std::size_t sample, const std::string& why,
             FindingList& findings) {
  findings.add(raw.first_row + sample, column.name, fmt::format("{}", column.values[sample]),
               why + "; expected metres");
}

/// Against the other displacements of the same degree of freedom.
bool is_suspected_by_ratio(const RawRecording& raw, const RawColumn& column, double period_s, FindingList& findings) {
  const Span own = span_of(column.values);
  const std::size_t longest_lag =
      raw.time_s.empty() ? 0 : static_cast<std::size_t>(std::lround(tuning::kForceLagMax_s / period_s));
  for (const RawColumn& other : raw.columns) {
    if (other.dof != column.dof || !is_displacement(other.channel) || &other == &column) continue;
    const double other_width = span_of(other.values).width;
    for (const OtherUnit& unit : kOtherUnits) {
      const double ratio = own.width / other_width / unit.per_metre;
      if (ratio < 1.0 - tuning::kUnitRatioTolerance || ratio > 1.0 + tuning::kUnitRatioTolerance) continue;
      if (!is_scaled_copy(column.values, other.values, longest_lag)) continue;
      suspect(raw, column, own.farthest,
              fmt::format("seems to be in {}: its range is {:.4g}, {:.0f} times the range of '{}' ({:.4g})", unit.name,
                          own.width, own.width / other_width, other.name, other_width),
              findings);
      return true;
    }
  }
  return false;
}

/// What the ratio of measured acceleration to the second derivative of displacement shows about a unit.
struct AccelerationRatio {
  double ratio;
  std::string_view what;
  bool is_of_time;  // the wrong unit is that of time, not of acceleration
};
constexpr std::array<AccelerationRatio, 5> kAccelerationRatios{{{1.0 / 9.80665, "seems to be in g", false},
                                                                {1000.0, "seems to be in mm/s2", false},
                                                                {100.0, "seems to be in cm/s2", false},
                                                                {1e6, "seems to be in milliseconds", true},
                                                                {1e12, "seems to be in microseconds", true}}};

/// Second derivative of the displacement, smoothed as far as the motion allows.
std::vector<double> acceleration_of(const std::vector<double>& displacement_m, double period_s) {
  const LocalPolynomial polynomial{widest_faithful_half_width(displacement_m), period_s};
  std::vector<double> acceleration(displacement_m.size());
  std::ranges::transform(polynomial.motion(displacement_m), acceleration.begin(), &Motion::acceleration_m_per_s2);
  return acceleration;
}

double deviation(const std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  double squares = 0.0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return std::sqrt(squares / n);
}

/// The measured displacement of the same degree of freedom; nullptr: none was recorded.
const RawColumn* measured_beside(const RawRecording& raw, const RawColumn& column) {
  const auto displacement = std::ranges::find_if(raw.columns, [&](const RawColumn& other) {
    return other.channel == Channel::measured_displacement && other.dof == column.dof;
  });
  return displacement == raw.columns.end() ? nullptr : &*displacement;
}

/// A compensator that has become unstable commands a speed that no actuator reaches.
bool is_beside_a_slow_one(const RawRecording& raw, const RawColumn& column, double period_s) {
  const RawColumn* const measured = measured_beside(raw, column);
  return measured != nullptr && fastest(measured->values, period_s) <= tuning::kSpeedMax_m_per_s;
}

void check_acceleration(const RawRecording& raw, const RawColumn& column, double period_s, FindingList& findings) {
  const RawColumn* const displacement = measured_beside(raw, column);
  if (displacement == nullptr) return;
  const std::vector<double> expected = acceleration_of(displacement->values, period_s);
  if (!(correlation(column.values, expected) >= tuning::kScaledCopyCorrelationMin)) return;
  const double ratio = deviation(column.values) / deviation(expected);
  for (const AccelerationRatio& known : kAccelerationRatios) {
    if (!(std::abs(ratio / known.ratio - 1.0) <= tuning::kUnitRatioTolerance)) continue;
    const std::size_t sample = known.is_of_time ? 1 : span_of(column.values).farthest;
    const double value = known.is_of_time ? raw.time_s[sample] : column.values[sample];
    findings.add(raw.first_row + sample, known.is_of_time ? std::string{kTimeColumn} : column.name,
                 fmt::format("{}", value),
                 fmt::format("{}: '{}' is {:.4g} times the second derivative of '{}'; expected {}", known.what,
                             column.name, ratio, displacement->name, known.is_of_time ? "seconds" : "m/s2"));
    return;
  }
}

}  // namespace

void check_units(const RawRecording& raw, double period_s, FindingList& findings) {
  for (const RawColumn& column : raw.columns) {
    if (column.channel == Channel::measured_acceleration) check_acceleration(raw, column, period_s, findings);
    if (!is_displacement(column.channel) || is_suspected_by_ratio(raw, column, period_s, findings)) continue;
    const std::size_t farthest = span_of(column.values).farthest;
    const double speed = raw.time_s.empty() ? 0.0 : fastest(column.values, period_s);
    if (std::abs(column.values[farthest]) > tuning::kDisplacementMax_m) {
      suspect(raw, column, farthest, "seems to be in millimetres: the largest displacement accepted is 10 m", findings);
    } else if (speed > tuning::kSpeedMax_m_per_s && !is_beside_a_slow_one(raw, column, period_s)) {
      suspect(raw, column, farthest,
              fmt::format("seems to be in millimetres: read in metres its speed is {:.3g} m/s, and the largest speed "
                          "accepted is 10 m/s",
                          speed),
              findings);
    }
  }
}

namespace {

struct ForceUnit {
  double newtons;
  std::string_view name;
  double factor;         // tolerance of the ratio
  double largest_nrmse;  // after conversion
};
constexpr double kAnyFit = std::numeric_limits<double>::infinity();
constexpr std::array<ForceUnit, 6> kForceUnits{
    {{1e3, "kilonewtons", tuning::kForceFactor, kAnyFit},
     {1e6, "meganewtons", tuning::kForceFactor, kAnyFit},
     {4448.22, "kips", tuning::kKipsFactor, kAnyFit},
     {1e-3, "millinewtons", tuning::kForceFactor, kAnyFit},
     {9.80665, "kilograms of force", tuning::kForceOfMassFactor, tuning::kForceOfMassLeaves},
     {4.44822, "pounds of force", tuning::kForceOfMassFactor, tuning::kForceOfMassLeaves}}};

struct TimeUnit {
  double per_second;
  std::string_view name;
};
constexpr std::array<TimeUnit, 2> kTimeUnits{{{1e3, "milliseconds"}, {1e6, "microseconds"}}};

/// Deviation from the mean.
Eigen::VectorXd swing(const std::vector<double>& values) {
  const Eigen::Map<const Eigen::VectorXd> all{values.data(), std::ssize(values)};
  return all.array() - all.mean();
}

/// Samples are numbered like the lines of the file.
IntakeFinding finding_at(const Recording& recording, const std::string& column, const std::vector<double>& values,
                         std::string what) {
  const auto farthest = std::ranges::max_element(values, {}, [](double value) { return std::abs(value); });
  const auto sample = static_cast<std::size_t>(farthest - values.begin());
  return {.row = recording.first_row + sample,
          .column = column,
          .value = fmt::format("{}", *farthest),
          .what = std::move(what)};
}

std::string column_of(const Recording& recording, Channel channel, std::size_t dof) {
  const std::string name{column_name(channel)};
  return recording.dofs.size() > 1 ? name + "_" + std::to_string(dof + 1) : name;
}

/// Deviation of the ratio from 1, as a factor of at least 1.
double off_by(double ratio) { return std::exp(std::abs(std::log(ratio))); }

void check_force(const Segment& segment, const SiteModel& model, const Recording& recording, std::size_t dof,
                 std::vector<IntakeFinding>& findings) {
  const Eigen::VectorXd measured = swing(segment.measured);
  const Eigen::VectorXd predicted = swing(predict(model, segment));
  const double product = measured.norm() * predicted.norm();
  if (!(product > 0.0 && measured.dot(predicted) >= tuning::kForceCorrelationMin * product)) return;
  const double newtons = predicted.norm() / measured.norm();
  const auto nearest =
      std::ranges::min_element(kForceUnits, {}, [&](const ForceUnit& unit) { return off_by(newtons / unit.newtons); });
  const double left = (nearest->newtons * measured - predicted).norm() / predicted.norm();
  if (off_by(newtons / nearest->newtons) > nearest->factor || left > nearest->largest_nrmse) return;
  findings.push_back(
      finding_at(recording, column_of(recording, segment.to, dof), segment.measured,
                 fmt::format("seems to be in {}: the model predicts {:.4g} times this force; expected newtons",
                             nearest->name, newtons)));
}

/// Root mean square of the gap over that of the output, for another sample period; infinite if a part of the model
/// does not accept that period.
double gap_at(const SiteModel& model, const Recording& recording, std::size_t dof, double period_s) try {
  Recording tried = recording;
  tried.sample_period_s = period_s;
  double squares = 0.0;
  double count = 0.0;
  for (const Segment& segment : segments_of(tried, dof, 0)) {
    if (!is_modelled(model, segment)) continue;
    const Eigen::VectorXd measured = swing(segment.measured);
    if (measured.norm() <= 0.0) continue;
    const Eigen::VectorXd gap = measured - swing(predict(model, segment));
    squares += gap.squaredNorm() / measured.squaredNorm();
    count += 1.0;
  }
  return count > 0.0 ? std::sqrt(squares / count) : 0.0;
} catch (const ConfigError&) {
  return std::numeric_limits<double>::infinity();
}

void check_time(const SiteModel& model, const Recording& recording, std::size_t dof,
                std::vector<IntakeFinding>& findings) {
  if (recording.is_quasi_static || recording.sample_period_s < tuning::kControlPeriodMax_s) return;
  const double as_written = gap_at(model, recording, dof, recording.sample_period_s);
  for (const TimeUnit& unit : kTimeUnits) {
    const double period_s = recording.sample_period_s / unit.per_second;
    if (period_s >= tuning::kControlPeriodMax_s) continue;
    const double converted = gap_at(model, recording, dof, period_s);
    if (converted > tuning::kTimeUnitNear || as_written < tuning::kTimeUnitNearer * converted) continue;
    findings.push_back(
        {.row = recording.first_row + 1,
         .column = "time_s",
         .value = fmt::format("{}", recording.sample_period_s),
         .what = fmt::format("seems to be in {}: with this sample period the NRMSE of the model is {:.3g}, with a "
                             "period of {} s it is {:.3g}; expected seconds",
                             unit.name, as_written, period_s, converted)});
    return;
  }
}

}  // namespace

std::vector<IntakeFinding> check_units_against(const SiteModel& model, const Recording& recording, std::size_t dof) {
  std::vector<IntakeFinding> findings;
  check_time(model, recording, dof, findings);
  if (!findings.empty()) return findings;  // a force that follows velocity says nothing at a wrong rate
  for (const Segment& segment : segments_of(recording, dof, 0)) {
    if (segment.to != Channel::measured_force || !is_modelled(model, segment)) continue;
    check_force(segment, model, recording, dof, findings);
  }
  return findings;
}

}  // namespace hybridtest
