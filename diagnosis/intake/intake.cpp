#include "diagnosis/intake/intake.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include "core/text/shown.hpp"
#include "diagnosis/intake/units.hpp"
#include "diagnosis/signals/signals.hpp"
#include "diagnosis/tuning.hpp"
#include "plant/effects/effect_type.hpp"

namespace hybridtest {

std::string IntakeFinding::text(const std::string& file) const {
  std::string text = file;
  if (row > 0) text += ":" + std::to_string(row);
  text += ": ";
  if (!column.empty()) text += "column '" + shown(column) + "': ";
  if (!value.empty()) text += "'" + shown(value) + "': ";
  text += what;
  if (more == 1) text += " (and in row " + std::to_string(last_row) + ")";
  if (more > 1) text += " (and in " + std::to_string(more) + " more rows, the last " + std::to_string(last_row) + ")";
  return text;
}

void FindingList::add(std::size_t row, const std::string& column, const std::string& value, const std::string& what) {
  const auto same = std::ranges::find_if(findings_, [&](const IntakeFinding& finding) {
    return row > 0 && finding.row > 0 && finding.column == column && finding.what == what;
  });
  if (same != findings_.end()) {
    ++same->more;
    same->last_row = row;
    return;
  }
  if (findings_.size() == tuning::kFindingsMax) {
    ++left_out_;
    return;
  }
  findings_.push_back({.row = row, .column = column, .value = value, .what = what, .more = 0, .last_row = row});
}

std::vector<IntakeFinding> FindingList::sorted() const {
  std::vector<IntakeFinding> findings = findings_;
  std::ranges::stable_sort(findings, {}, &IntakeFinding::row);
  if (left_out_ > 0) {
    findings.emplace_back();
    findings.back().what = "and " + std::to_string(left_out_) + " more findings";
  }
  return findings;
}

namespace {

constexpr std::array<std::string_view, 10> kLeftAside{"sample",
                                                      "model_time_s",
                                                      "compensated_force_n",
                                                      "energy_error_j",
                                                      "tracking_lag_sine",
                                                      "faults",
                                                      "target_velocity_m_per_s",
                                                      "energy_error_ratio",
                                                      "command_age_s",
                                                      "follows_targets"};
constexpr std::string_view kPredicted = "predicted_";

Channel channel_at(std::size_t index) { return static_cast<Channel>(index); }

/// `_2` gives 1; nothing for any other suffix.
std::optional<std::size_t> dof_of_suffix(std::string_view suffix) {
  if (suffix.empty()) return 0;
  if (suffix.size() < 2 || suffix.front() != '_' || suffix[1] == '0') return {};
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(suffix.data() + 1, suffix.data() + suffix.size(), number);
  if (error != std::errc{} || end != suffix.data() + suffix.size() || number > tuning::kDofsMax) return {};
  return number - 1;
}

}  // namespace

std::optional<ChannelColumn> channel_of_header(std::string_view header) {
  for (std::size_t i = 0; i < kChannels; ++i) {
    const std::string_view name = column_name(channel_at(i));
    if (!header.starts_with(name)) continue;
    if (const auto dof = dof_of_suffix(header.substr(name.size()))) return ChannelColumn{channel_at(i), *dof};
  }
  return {};
}

bool is_input_header(std::string_view header) noexcept {
  return header.starts_with(kInputPrefix) && is_input_name(header.substr(kInputPrefix.size()));
}

bool is_left_aside(std::string_view header) {
  if (header.starts_with(kPredicted)) return true;
  return std::ranges::any_of(kLeftAside, [&](std::string_view name) {
    return header.starts_with(name) && dof_of_suffix(header.substr(name.size())).has_value();
  });
}

std::string unknown_column_advice(std::string_view header) {
  std::vector<std::string> known{std::string{kTimeColumn}, std::string{kStepColumn}};
  for (std::size_t i = 0; i < kChannels; ++i) known.emplace_back(column_name(channel_at(i)));
  return "unknown column" + name_advice(header, known, "known here") +
         "; with several degrees of freedom, add _1, _2, ... to the name. An input beside the motion is headed input_ "
         "and its name, such as input_current_a";
}

namespace {

/// Deviation of the interval before a sample that rounding of the time stamps explains.
double interval_tolerance_s(const RawRecording& raw, double usual_s) {
  const double digits_s = raw.time_resolution_s <= tuning::kLastDigitOfPeriodMax * usual_s
                              ? tuning::kLastDigits * raw.time_resolution_s
                              : 0.0;
  // Time stamps far from zero have few digits left behind the point.
  const double rounding_s = tuning::kTimeRounding * std::max(std::abs(raw.time_s.front()), std::abs(raw.time_s.back()));
  return std::max({tuning::kEvenSpacing * usual_s, digits_s, rounding_s});
}

double mean_interval(const std::vector<double>& time_s) {
  return (time_s.back() - time_s.front()) / static_cast<double>(time_s.size() - 1);
}

double median_interval(const std::vector<double>& time_s) {
  std::vector<double> intervals(time_s.size() - 1);
  for (std::size_t i = 1; i < time_s.size(); ++i) intervals[i - 1] = time_s[i] - time_s[i - 1];
  return upper_median(std::move(intervals));
}

/// What is wrong with one interval; empty when nothing is.
std::string judged(double interval_s, double period_s, double tolerance_s) {
  if (interval_s == 0.0) return "time stamp repeated; time must increase from row to row";
  if (interval_s < 0.0) return "time stamp is earlier than the one before; time must increase from row to row";
  if (std::abs(interval_s - period_s) <= tolerance_s) return {};
  const double periods = interval_s / period_s;
  if (periods > tuning::kGapPeriods) {
    return fmt::format(
        "gap before this row: about {:.0f} samples are missing at {:.6g} s per sample; expected a recording without "
        "gaps, so export the part before or after it",
        std::max(1.0, std::round(periods) - 1.0), period_s);
  }
  return fmt::format("uneven sampling: expected {:.6g} s after the row before; resample to a constant period",
                     period_s);
}

/// The time stamp farthest from a grid of constant period.
struct OffGrid {
  std::size_t sample = 0;
  double off_s = 0.0;
  bool is_outside = false;  // by more than half a period
};

OffGrid farthest_off_grid(const RawRecording& raw, double period_s) {
  OffGrid worst;
  for (std::size_t i = 0; i < raw.time_s.size(); ++i) {
    const double off_s = std::abs(raw.time_s[i] - raw.time_s.front() - static_cast<double>(i) * period_s);
    if (off_s > worst.off_s) worst = {i, off_s, off_s > 0.5 * period_s + raw.time_resolution_s};
  }
  return worst;
}

/// Every interval can be within its tolerance while the period slowly changes.
void check_drift(const RawRecording& raw, double period_s, FindingList& findings) {
  const OffGrid worst = farthest_off_grid(raw, period_s);
  if (!worst.is_outside) return;
  findings.add(
      raw.first_row + worst.sample, std::string{kTimeColumn}, fmt::format("{}", raw.time_s[worst.sample]),
      fmt::format("uneven sampling: the sample period changes during the recording; this row is {:.3g} s away from a "
                  "constant period of {:.6g} s. Resample to a constant period",
                  worst.off_s, period_s));
}

}  // namespace

std::size_t RawRecording::samples() const noexcept {
  return columns.empty() ? std::max(time_s.size(), step.size()) : columns.front().values.size();
}

bool has_invented_time(const RawRecording& raw) {
  const bool is_of_specimen = std::ranges::all_of(raw.columns, [](const RawColumn& column) {
    return column.channel == Channel::measured_displacement || column.channel == Channel::measured_force;
  });
  const double usual_s = median_interval(raw.time_s);
  if (!is_of_specimen || !(usual_s > 0.0)) return false;
  const double tolerance_s = interval_tolerance_s(raw, usual_s);
  std::size_t uneven = 0;
  for (std::size_t i = 1; i < raw.time_s.size(); ++i) {
    const double interval_s = raw.time_s[i] - raw.time_s[i - 1];
    if (interval_s < 0.0) return false;
    if (std::abs(interval_s - usual_s) > tolerance_s) ++uneven;
  }
  return 2 * uneven > raw.time_s.size() - 1 && farthest_off_grid(raw, mean_interval(raw.time_s)).is_outside;
}

double check_sampling(const RawRecording& raw, FindingList& findings) {
  const std::vector<double>& time_s = raw.time_s;
  const double usual_s = median_interval(time_s);
  if (!(usual_s > 0.0)) {
    findings.add(
        0, std::string{kTimeColumn}, {},
        "time does not advance: at least half of the time stamps are not later than the one before; time must increase "
        "from row to row");
    return 0.0;
  }
  const double tolerance_s = interval_tolerance_s(raw, usual_s);
  bool is_even = true;
  for (std::size_t i = 1; i < time_s.size(); ++i) {
    const std::string wrong = judged(time_s[i] - time_s[i - 1], usual_s, tolerance_s);
    if (wrong.empty()) continue;
    is_even = false;
    findings.add(raw.first_row + i, std::string{kTimeColumn}, fmt::format("{}", time_s[i]), wrong);
  }
  const double period_s = mean_interval(time_s);
  if (is_even) check_drift(raw, period_s, findings);
  return period_s;
}

namespace {

void check_finite(const RawRecording& raw, const std::string& name, const std::vector<double>& values,
                  FindingList& findings) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) {
      findings.add(raw.first_row + i, name, fmt::format("{}", values[i]),
                   "not a finite number; expected a number, replace or remove this part of the recording");
    }
  }
}

std::size_t dof_count(const RawRecording& raw) {
  std::size_t count = 0;
  for (const RawColumn& column : raw.columns) count = std::max(count, column.dof + 1);
  return count;
}

void check_columns(const RawRecording& raw, FindingList& findings) {
  if (raw.columns.empty()) findings.add(0, {}, {}, "no data column: expected at least one column besides time_s");
  for (std::size_t dof = 0; dof < dof_count(raw); ++dof) {
    if (std::ranges::count(raw.columns, dof, &RawColumn::dof) > 0) continue;
    findings.add(
        0, {}, {},
        fmt::format("columns of degree of freedom {} are missing; expected numbers from 1 without a gap", dof + 1));
  }
}

/// Numbers of points increase: the order of the rows is all that is known of a quasi-static test.
void check_steps(const RawRecording& raw, FindingList& findings) {
  for (std::size_t i = 1; i < raw.step.size(); ++i) {
    if (raw.step[i] > raw.step[i - 1]) continue;
    findings.add(raw.first_row + i, std::string{kStepColumn}, fmt::format("{}", raw.step[i]),
                 "step is not larger than the one before; steps must increase from row to row");
  }
}

/// Inertia is judged by acceleration over time: what has one was not quasi-static.
void check_no_acceleration(const RawRecording& raw, FindingList& findings) {
  for (const RawColumn& column : raw.columns) {
    if (column.channel != Channel::measured_acceleration) continue;
    findings.add(0, column.name, {},
                 "a recording without time is quasi-static, and an acceleration has no meaning there; expected a "
                 "column time_s with the time in seconds, or no acceleration");
  }
}

/// The time of a point if the motion passed one cycle over its whole range per second and the points followed each
/// other evenly. Reversals within a fiftieth of the range are noise and no path.
double nominal_period_s(const RawRecording& raw) {
  double cycles = 0.0;
  for (const RawColumn& column : raw.columns) {
    if (column.channel > Channel::measured_displacement) continue;
    const double range_m = span_of(column.values);
    if (!(range_m > 0.0)) continue;
    double path_m = 0.0;
    double last_m = column.values.front();
    const auto go_to = [&](double place_m) {
      path_m += std::abs(place_m - last_m);
      last_m = place_m;
    };
    for (const Reversal& reversal : reversals_of(column.values, reversal_threshold_m(column.values))) {
      go_to(reversal.displacement_m);
    }
    go_to(column.values.back());
    cycles = std::max(cycles, path_m / (2.0 * range_m));
  }
  return (cycles > 0.0 ? cycles : 1.0) / static_cast<double>(raw.samples() - 1);
}

std::optional<RowStamps> stamps_of(const RawRecording& raw) {
  const std::vector<double>& stamps = raw.time_s.empty() ? raw.step : raw.time_s;
  if (stamps.size() < 2) return {};
  double largest = 0.0;
  for (std::size_t i = 1; i < stamps.size(); ++i) largest = std::max(largest, stamps[i] - stamps[i - 1]);
  return RowStamps{std::string{raw.time_s.empty() ? kStepColumn : kTimeColumn}, stamps.front(), stamps.back(), largest};
}

Recording taken(RawRecording raw, double period_s) {
  Recording recording;
  recording.file = raw.file;
  recording.is_quasi_static = raw.time_s.empty();
  recording.sample_period_s = period_s;
  recording.samples = raw.samples();
  recording.first_row = raw.first_row;
  recording.dofs.resize(dof_count(raw));
  for (RawColumn& column : raw.columns) recording.dofs[column.dof].of(column.channel) = std::move(column.values);
  for (RawInput& input : raw.inputs) {
    recording.inputs.push_back({input.column.substr(kInputPrefix.size()), std::move(input.values)});
  }
  std::ranges::sort(recording.inputs, {}, &RecordedChannel::name);
  return recording;
}

}  // namespace

Intake check_recording(RawRecording raw, TimeBase time) {
  FindingList findings;
  const std::optional<RowStamps> stamps = stamps_of(raw);
  check_columns(raw, findings);
  check_finite(raw, std::string{kTimeColumn}, raw.time_s, findings);
  for (const RawColumn& column : raw.columns) check_finite(raw, column.name, column.values, findings);
  for (const RawInput& input : raw.inputs) check_finite(raw, input.column, input.values, findings);
  check_finite(raw, std::string{kStepColumn}, raw.step, findings);
  if (raw.samples() < tuning::kSamplesMin) {
    findings.add(0, {}, {}, fmt::format("{} rows of data; expected at least {}", raw.samples(), tuning::kSamplesMin));
  }
  double period_s = 0.0;
  // The next checks use differences and extreme values: they need finite numbers.
  if (findings.empty()) {
    if (time == TimeBase::quasi_static || (!raw.time_s.empty() && has_invented_time(raw))) raw.time_s.clear();
    if (raw.time_s.empty()) {
      check_steps(raw, findings);
      check_no_acceleration(raw, findings);
      period_s = nominal_period_s(raw);
    } else {
      period_s = check_sampling(raw, findings);
    }
  }
  if (period_s > 0.0) check_units(raw, period_s, findings);
  if (!findings.empty()) return {{}, findings.sorted()};
  Intake intake{taken(std::move(raw), period_s), {}};
  intake.recording->stamps = stamps;
  return intake;
}

}  // namespace hybridtest
