#include "diagnosis/localisation/sensor_checks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "diagnosis/signals/signals.hpp"
#include "diagnosis/tuning.hpp"

namespace hybridtest {

namespace {

double mean(std::span<const double> values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

std::size_t clipped(std::span<const double> values, double extreme) {
  std::size_t count = 0;
  std::size_t run = 0;
  for (std::size_t i = 0; i <= values.size(); ++i) {
    if (i < values.size() && values[i] == extreme) {
      ++run;
      continue;
    }
    if (run >= tuning::kClippedRun) count += run;
    run = 0;
  }
  return count;
}

/// Correlation of the changes of both with the force `lag` samples behind.
double change_correlation(std::span<const double> x, std::span<const double> f, std::ptrdiff_t lag) {
  double xf = 0.0;
  double xx = 0.0;
  double ff = 0.0;
  const auto size = static_cast<std::ptrdiff_t>(x.size());
  for (std::ptrdiff_t i = std::max<std::ptrdiff_t>(1, 1 - lag); i < std::min(size, size - lag); ++i) {
    const auto at = static_cast<std::size_t>(i);
    const auto late = static_cast<std::size_t>(i + lag);
    const double dx = x[at] - x[at - 1];
    const double df = f[late] - f[late - 1];
    xf += dx * df;
    xx += dx * dx;
    ff += df * df;
  }
  return xx > 0.0 && ff > 0.0 ? xf / std::sqrt(xx * ff) : 0.0;
}

}  // namespace

ChannelCheck check_channel(std::span<const double> values) {
  ChannelCheck check;
  if (values.size() < 2) return check;
  std::size_t repeated = 0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double step = std::abs(values[i] - values[i - 1]);
    if (step == 0.0) {
      ++repeated;
    } else if (check.quantum == 0.0 || step < check.quantum) {
      check.quantum = step;
    }
  }
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const auto size = static_cast<double>(values.size());
  check.repeated_share = static_cast<double>(repeated) / size;
  if (*low < *high) check.clipped_share = static_cast<double>(clipped(values, *low) + clipped(values, *high)) / size;
  return check;
}

std::optional<RestReading> read_at_rest(std::span<const double> values, std::span<const double> motion_m,
                                        double period_s) {
  const std::vector<RestStretch> stretches = rest_stretches(motion_m, period_s);
  if (stretches.empty()) return {};
  const auto part = [&](const RestStretch& stretch) { return values.subspan(stretch.begin, stretch.count); };
  RestReading reading{.first = mean(part(stretches.front())), .last = mean(part(stretches.back()))};
  const double apart_s = static_cast<double>(stretches.back().begin - stretches.front().begin) * period_s;
  if (apart_s > 0.0) reading.drift_per_s = (reading.last - reading.first) / apart_s;
  double squares = 0.0;
  for (const RestStretch& stretch : stretches) squares += variance(part(stretch));
  reading.rms = std::sqrt(squares / static_cast<double>(stretches.size()));
  return reading;
}

std::optional<double> force_lag_s(std::span<const double> displacement_m, std::span<const double> force_n,
                                  double period_s) {
  const auto most = static_cast<std::ptrdiff_t>(std::lround(tuning::kForceLagMax_s / period_s));
  if (most < 1 || displacement_m.size() < tuning::kForceLagRecordings * static_cast<std::size_t>(most)) return {};
  std::vector<double> found;
  for (std::ptrdiff_t lag = -most; lag <= most; ++lag) {
    found.push_back(std::abs(change_correlation(displacement_m, force_n, lag)));
  }
  const auto best = std::ranges::max_element(found);
  if (*best < tuning::kForceLagCorrelationMin || best == found.begin() || best + 1 == found.end()) return {};
  const double curvature = *(best - 1) - 2.0 * *best + *(best + 1);
  const double shift = curvature < 0.0 ? 0.5 * (*(best - 1) - *(best + 1)) / curvature : 0.0;
  return (static_cast<double>((best - found.begin()) - most) + shift) * period_s;
}

void add_sensor_facts(const Recording& recording, std::size_t dof, report::DiagnosisReport& report) {
  struct Sensor {
    Channel channel;
    std::string_view unit;
  };
  constexpr std::array kSensors{Sensor{Channel::measured_displacement, "m"},
                                Sensor{Channel::measured_acceleration, "m/s2"}, Sensor{Channel::measured_force, "N"}};
  const DofRecording& channels = recording.dofs[dof];
  const std::vector<double>& motion_m = channels.has(Channel::command_displacement)
                                            ? channels.of(Channel::command_displacement)
                                            : channels.of(Channel::measured_displacement);
  for (const Sensor& sensor : kSensors) {
    if (!channels.has(sensor.channel)) continue;
    const std::vector<double>& values = channels.of(sensor.channel);
    const ChannelCheck check = check_channel(values);
    report::SensorFacts facts{.recording = recording.file,
                              .column = std::string{column_name(sensor.channel)},
                              .unit = std::string{sensor.unit},
                              .quantum = check.quantum,
                              .repeated_share = check.repeated_share,
                              .clipped_share = check.clipped_share};
    const bool has_time = !recording.is_quasi_static;
    if (const auto rest = read_at_rest(values, motion_m, recording.sample_period_s); has_time && rest) {
      facts.at_rest = report::RestFacts{rest->first, rest->last, rest->drift_per_s, rest->rms};
    }
    if (has_time && sensor.channel == Channel::measured_force && channels.has(Channel::measured_displacement)) {
      facts.lag_s = force_lag_s(channels.of(Channel::measured_displacement), values, recording.sample_period_s);
    }
    report.sensors.push_back(std::move(facts));
  }
}

}  // namespace hybridtest
