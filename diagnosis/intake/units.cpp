#include "diagnosis/intake/units.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string_view>

#include "diagnosis/intake/column_header.hpp"
#include "diagnosis/signals/local_polynomial.hpp"

namespace hybridtest {
namespace {

struct OtherUnit {
  double per_metre;
  std::string_view name;
};
constexpr std::array<OtherUnit, 3> kOtherUnits{{{1000.0, "millimetres"}, {100.0, "centimetres"}, {39.3701, "inches"}}};
/// How far the ratio of two spans may be from a unit's: channels differ by gain, lag and noise.
constexpr double kRatioTolerance = 0.25;
/// A channel that rests, or does not take part in the motion, has no ratio to it.
constexpr double kLeastCorrelation = 0.5;
constexpr double kSpeedWindow_s = 0.02;

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

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
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

double fastest(const std::vector<double>& values, double period_s) {
  const auto window = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(kSpeedWindow_s / period_s)));
  double largest = 0.0;
  for (std::size_t i = window; i < values.size(); ++i)
    largest = std::max(largest, std::abs(values[i] - values[i - window]));
  return largest / (static_cast<double>(window) * period_s);
}

void suspect(const RawRecording& raw, const RawColumn& column, std::size_t sample, const std::string& why,
             FindingList& findings) {
  findings.add(raw.first_row + sample, column.name, fmt::format("{}", column.values[sample]),
               why + "; metres were expected");
}

/// Against the other displacements of the same degree of freedom.
bool is_suspected_by_ratio(const RawRecording& raw, const RawColumn& column, FindingList& findings) {
  const Span own = span_of(column.values);
  for (const RawColumn& other : raw.columns) {
    if (other.dof != column.dof || !is_displacement(other.channel) || &other == &column) continue;
    if (correlation(column.values, other.values) < kLeastCorrelation) continue;
    const double other_width = span_of(other.values).width;
    for (const OtherUnit& unit : kOtherUnits) {
      const double ratio = own.width / other_width / unit.per_metre;
      if (ratio < 1.0 - kRatioTolerance || ratio > 1.0 + kRatioTolerance) continue;
      suspect(raw, column, own.farthest,
              fmt::format("seems to be in {}: it spans {:.4g}, {:.0f} times what '{}' spans ({:.4g})", unit.name,
                          own.width, own.width / other_width, other.name, other_width),
              findings);
      return true;
    }
  }
  return false;
}

/// What the ratio of a measured acceleration to the displacement's second derivative says of a column.
struct AccelerationRatio {
  double ratio;
  std::string_view what;
  bool is_of_time;  // and not of the acceleration
};
constexpr std::array<AccelerationRatio, 5> kAccelerationRatios{{{1.0 / 9.80665, "seems to be in g", false},
                                                                {1000.0, "seems to be in mm/s2", false},
                                                                {100.0, "seems to be in cm/s2", false},
                                                                {1e6, "seems to be in milliseconds", true},
                                                                {1e12, "seems to be in microseconds", true}}};
/// Of an acceleration with the one that the displacement went through. Noise of the latter takes from both by as much
/// as the tolerance of the ratio.
constexpr double kSameAcceleration = 0.8;

/// Second derivative of the displacement, as quiet as the motion allows.
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

/// Against the measured displacement of the same degree of freedom.
void check_acceleration(const RawRecording& raw, const RawColumn& column, double period_s, FindingList& findings) {
  const auto displacement = std::ranges::find_if(raw.columns, [&](const RawColumn& other) {
    return other.channel == Channel::measured_displacement && other.dof == column.dof;
  });
  if (displacement == raw.columns.end()) return;
  const std::vector<double> expected = acceleration_of(displacement->values, period_s);
  if (!(correlation(column.values, expected) >= kSameAcceleration)) return;
  const double ratio = deviation(column.values) / deviation(expected);
  for (const AccelerationRatio& known : kAccelerationRatios) {
    if (!(std::abs(ratio / known.ratio - 1.0) <= kRatioTolerance)) continue;
    const std::size_t sample = known.is_of_time ? 1 : span_of(column.values).farthest;
    const double value = known.is_of_time ? raw.time_s[sample] : column.values[sample];
    findings.add(raw.first_row + sample, known.is_of_time ? std::string{kTimeColumn} : column.name,
                 fmt::format("{}", value),
                 fmt::format("{}: '{}' is {:.4g} times the second derivative of '{}'; {} expected", known.what,
                             column.name, ratio, displacement->name, known.is_of_time ? "seconds were" : "m/s2 were"));
    return;
  }
}

}  // namespace

void check_units(const RawRecording& raw, double period_s, FindingList& findings) {
  for (const RawColumn& column : raw.columns) {
    if (column.channel == Channel::measured_acceleration) check_acceleration(raw, column, period_s, findings);
    if (!is_displacement(column.channel) || is_suspected_by_ratio(raw, column, findings)) continue;
    const std::size_t farthest = span_of(column.values).farthest;
    const double speed = fastest(column.values, period_s);
    if (std::abs(column.values[farthest]) > kLargestPlausibleDisplacement_m) {
      suspect(raw, column, farthest, "seems to be in millimetres: no site moves by more than 10 m", findings);
    } else if (speed > kLargestPlausibleSpeed_m_per_s) {
      suspect(raw, column, farthest,
              fmt::format("seems to be in millimetres: in metres it would move at {:.3g} m/s, and no site is faster "
                          "than 10 m/s",
                          speed),
              findings);
    }
  }
}

}  // namespace hybridtest
