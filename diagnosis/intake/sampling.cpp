#include "diagnosis/intake/sampling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "diagnosis/intake/column_header.hpp"

namespace hybridtest {
namespace {

double median_interval(const std::vector<double>& time_s) {
  std::vector<double> intervals(time_s.size() - 1);
  for (std::size_t i = 1; i < time_s.size(); ++i) intervals[i - 1] = time_s[i] - time_s[i - 1];
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::nth_element(intervals.begin(), middle, intervals.end());
  return *middle;
}

/// What is wrong with one interval; empty when nothing is.
std::string judged(double interval_s, double period_s, double tolerance_s) {
  if (interval_s == 0.0) return "time stamp repeated; it must increase from row to row";
  if (interval_s < 0.0) return "time stamp goes back; it must increase from row to row";
  if (std::abs(interval_s - period_s) <= tolerance_s) return {};
  const double periods = interval_s / period_s;
  if (periods > 1.5) {
    return fmt::format("gap before this row: about {:.0f} samples are missing at {:.6g} s per sample",
                       std::max(1.0, std::round(periods) - 1.0), period_s);
  }
  return fmt::format("uneven sampling: not the usual {:.6g} s after the row before", period_s);
}

/// Every interval may be even and the period still change on the way.
void check_drift(const RawRecording& raw, double period_s, FindingList& findings) {
  std::size_t worst = 0;
  double worst_s = 0.0;
  for (std::size_t i = 0; i < raw.time_s.size(); ++i) {
    const double off_s = std::abs(raw.time_s[i] - raw.time_s.front() - static_cast<double>(i) * period_s);
    if (off_s > worst_s) {
      worst_s = off_s;
      worst = i;
    }
  }
  if (worst_s <= 0.5 * period_s + raw.time_resolution_s) return;
  findings.add(raw.first_row + worst, std::string{kTimeColumn}, fmt::format("{}", raw.time_s[worst]),
               fmt::format("uneven sampling: the period changes on the way; here {:.3g} s away from an even grid of "
                           "{:.6g} s",
                           worst_s, period_s));
}

}  // namespace

double check_sampling(const RawRecording& raw, FindingList& findings) {
  const std::vector<double>& time_s = raw.time_s;
  const double usual_s = median_interval(time_s);
  if (!(usual_s > 0.0)) {
    findings.add(0, std::string{kTimeColumn}, {}, "time does not advance: half of the time stamps repeat or go back");
    return 0.0;
  }
  const double digits_s = raw.time_resolution_s <= 0.1 * usual_s ? 1.01 * raw.time_resolution_s : 0.0;
  // Time stamps far from zero have few digits left behind the point.
  const double rounding_s = 4e-16 * std::max(std::abs(time_s.front()), std::abs(time_s.back()));
  const double tolerance_s = std::max({kEvenSpacing * usual_s, digits_s, rounding_s});
  bool is_even = true;
  for (std::size_t i = 1; i < time_s.size(); ++i) {
    const std::string wrong = judged(time_s[i] - time_s[i - 1], usual_s, tolerance_s);
    if (wrong.empty()) continue;
    is_even = false;
    findings.add(raw.first_row + i, std::string{kTimeColumn}, fmt::format("{}", time_s[i]), wrong);
  }
  const double period_s = (time_s.back() - time_s.front()) / static_cast<double>(time_s.size() - 1);
  if (is_even) check_drift(raw, period_s, findings);
  return period_s;
}

}  // namespace hybridtest
