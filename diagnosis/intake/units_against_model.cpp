#include "diagnosis/intake/units_against_model.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>

#include "core/config_error.hpp"
#include "diagnosis/identification/segment.hpp"

namespace hybridtest {
namespace {

struct ForceUnit {
  double newtons;
  std::string_view name;
  double factor;         // by which the ratio may be off
  double largest_nrmse;  // once converted
};
constexpr double kAnyFit = 1e300;
constexpr std::array<ForceUnit, 6> kForceUnits{{{1e3, "kilonewtons", 3.0, kAnyFit},
                                                {1e6, "meganewtons", 3.0, kAnyFit},
                                                {4448.22, "kips", 1.5, kAnyFit},
                                                {1e-3, "millinewtons", 3.0, kAnyFit},
                                                {9.80665, "kilograms of force", 1.03, 0.1},
                                                {4.44822, "pounds of force", 1.03, 0.1}}};
/// No load cell that is not connected does; friction beside a model without any has a half.
constexpr double kGoesTogether = 0.3;

struct TimeUnit {
  double per_second;
  std::string_view name;
};
constexpr std::array<TimeUnit, 2> kTimeUnits{{{1e3, "milliseconds"}, {1e6, "microseconds"}}};
/// Controllers sample faster than this.
constexpr double kSlowestController_s = 0.1;
/// By how much the model has to come nearer, and how near.
constexpr double kMuchNearer = 3.0;
constexpr double kNear = 0.3;

/// Around its mean.
Eigen::VectorXd swing(const std::vector<double>& values) {
  const Eigen::Map<const Eigen::VectorXd> all{values.data(), std::ssize(values)};
  return all.array() - all.mean();
}

/// Samples are numbered as lines of the file are.
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

/// How far off the ratio is, as a factor of at least 1.
double off_by(double ratio) { return std::exp(std::abs(std::log(ratio))); }

void check_force(const Segment& segment, const SiteModel& model, const Recording& recording, std::size_t dof,
                 std::vector<IntakeFinding>& findings) {
  const Eigen::VectorXd measured = swing(segment.measured);
  const Eigen::VectorXd predicted = swing(predict(model, segment));
  const double product = measured.norm() * predicted.norm();
  if (!(product > 0.0 && measured.dot(predicted) >= kGoesTogether * product)) return;
  const double newtons = predicted.norm() / measured.norm();
  const auto nearest =
      std::ranges::min_element(kForceUnits, {}, [&](const ForceUnit& unit) { return off_by(newtons / unit.newtons); });
  const double left = (nearest->newtons * measured - predicted).norm() / predicted.norm();
  if (off_by(newtons / nearest->newtons) > nearest->factor || left > nearest->largest_nrmse) return;
  findings.push_back(
      finding_at(recording, column_of(recording, segment.to, dof), segment.measured,
                 fmt::format("seems to be in {}: the model predicts {:.4g} times as much; newtons were expected",
                             nearest->name, newtons)));
}

/// Root mean square of the segments' gaps over those of their outputs, at another sample period; beyond all where
/// a part of the model refuses that period.
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
  if (recording.sample_period_s < kSlowestController_s) return;
  const double as_written = gap_at(model, recording, dof, recording.sample_period_s);
  for (const TimeUnit& unit : kTimeUnits) {
    const double period_s = recording.sample_period_s / unit.per_second;
    if (period_s >= kSlowestController_s) continue;
    const double converted = gap_at(model, recording, dof, period_s);
    if (converted > kNear || as_written < kMuchNearer * converted) continue;
    findings.push_back(
        {.row = recording.first_row + 1,
         .column = "time_s",
         .value = fmt::format("{}", recording.sample_period_s),
         .what = fmt::format("seems to be in {}: with samples so far apart the model is off by {:.3g} of "
                             "what was measured, with {} s by {:.3g}; seconds were expected",
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
