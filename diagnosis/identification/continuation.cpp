#include "diagnosis/identification/continuation.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "diagnosis/identification/smoothing_choice.hpp"
#include "diagnosis/tuning.hpp"

namespace hybridtest {

namespace {

/// The last displacement of the chain that was recorded; empty without any.
const std::vector<double>& motion_of(const DofRecording& dof) {
  for (const Channel channel : {Channel::measured_displacement, Channel::command_displacement,
                                Channel::target_displacement, Channel::sent_displacement}) {
    if (dof.has(channel)) return dof.of(channel);
  }
  return dof.of(Channel::measured_displacement);
}

double largest_step(const std::vector<double>& values) {
  double largest = 0.0;
  for (std::size_t i = 1; i < values.size(); ++i) largest = std::max(largest, std::abs(values[i] - values[i - 1]));
  return largest;
}

bool goes_on(const std::vector<double>& earlier_m, const std::vector<double>& later_m) {
  return !earlier_m.empty() && !later_m.empty() &&
         std::abs(later_m.front() - earlier_m.back()) <= tuning::kGapPeriods * largest_step(earlier_m);
}

void give_history(std::vector<Segment> earlier, std::vector<Segment>& segments) {
  for (Segment& before : earlier) {
    for (Segment& segment : segments) {
      if (segment.from != before.from || segment.to != before.to) continue;
      segment.history = std::make_shared<const Segment>(std::move(before));
      break;
    }
  }
}

}  // namespace

bool continues(const Recording& earlier, const Recording& later, std::size_t dof) {
  if (!earlier.stamps || !later.stamps || earlier.stamps->column != later.stamps->column) return false;
  if (earlier.is_quasi_static != later.is_quasi_static) return false;
  const double gap = later.stamps->first - earlier.stamps->last;
  if (!(gap > 0.0) || gap > tuning::kGapPeriods * earlier.stamps->largest_interval) return false;
  const bool is_same_rate =
      std::abs(later.sample_period_s - earlier.sample_period_s) <= tuning::kEvenSpacing * earlier.sample_period_s;
  return (earlier.is_quasi_static || is_same_rate) && earlier.dofs.size() > dof && later.dofs.size() > dof &&
         goes_on(motion_of(earlier.dofs[dof]), motion_of(later.dofs[dof]));
}

std::optional<std::size_t> continued_by(std::span<const Recording> recordings, std::size_t position, std::size_t dof) {
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    if (i != position && continues(recordings[i], recordings[position], dof)) return i;
  }
  return {};
}

void carry_history(const SiteModel& model, const Recording& earlier, std::size_t dof, std::vector<Segment>& segments) {
  give_history(modelled_segments(model, earlier, dof, 0), segments);
}

void carry_history(const SiteModel& model, std::span<const Recording> recordings, std::size_t dof,
                   std::vector<Segment>& segments) {
  if (segments.empty()) return;
  const auto before = continued_by(recordings, segments.front().recording, dof);
  if (!before) return;
  std::vector<Segment> earlier = modelled_segments(model, recordings[*before], dof, *before);
  carry_history(model, recordings, dof, earlier);
  give_history(std::move(earlier), segments);
}

}  // namespace hybridtest
