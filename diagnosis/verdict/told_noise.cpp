#include "diagnosis/verdict/told_noise.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "diagnosis/signals/signals.hpp"
#include "diagnosis/verdict/library_fits.hpp"

namespace hybridtest {
namespace {

bool is_of_actuator(const Segment& segment) {
  return segment.to == Channel::measured_displacement && !segment.is_quasi_static;
}

/// Of the same recording, whose prediction starts from the readings that the actuator's segment ends in.
Segment* specimen_behind(const Segment& actuator, std::span<Segment> segments) {
  const auto found = std::ranges::find_if(segments, [&](const Segment& segment) {
    return segment.from == Channel::measured_displacement && segment.recording == actuator.recording &&
           segment.input.size() == actuator.measured.size() && !(segment.input_step > 0.0);
  });
  return found == segments.end() ? nullptr : &*found;
}

std::vector<double> left_by(const SiteModel& completed, const Segment& segment) {
  std::vector<double> error = predict(completed, segment);
  for (std::size_t i = 0; i < error.size(); ++i) error[i] = segment.measured[i] - error[i];
  return error;
}

/// No more of what is left than the noise is.
void tell(std::vector<double> error, double left, double noise, Segment& specimen) {
  for (double& value : error) value *= std::min(1.0, noise / left);
  specimen.told_noise = motion_of_readings(specimen, error);
}

}  // namespace

bool tell_noise(const IdentificationProblem& problem, const FitOutcome& chosen, const SiteModel& completed,
                std::vector<Segment>& segments) {
  const bool is_asked = std::ranges::any_of(
      problem.segments, [](const FitSegment& fit) { return fit.is_suspect && is_of_actuator(fit.segment); });
  if (!is_asked || gap_energy(problem, chosen).is_clear()) return false;
  bool is_told = false;
  for (const FitSegment& fit : problem.segments) {
    if (!is_of_actuator(fit.segment)) continue;
    Segment* const specimen = specimen_behind(fit.segment, segments);
    if (specimen == nullptr) continue;
    std::vector<double> error = left_by(completed, fit.segment);
    const double left = std::sqrt(fit.average(error).squaredNorm() / static_cast<double>(fit.measured.size()));
    if (!(left > 0.0)) continue;
    tell(std::move(error), left, fit.floor, *specimen);
    is_told = true;
  }
  return is_told;
}

void tell_held_out_noise(const IdentificationProblem& problem, const FitOutcome& chosen, const SiteModel& completed,
                         std::span<Segment> held_out) {
  double energy = 0.0;
  double count = 0.0;
  for (const FitSegment& fit : problem.segments) {
    if (!fit.is_suspect || !is_of_actuator(fit.segment)) continue;
    energy += fit.sample_floor * fit.sample_floor;
    count += 1.0;
  }
  if (count == 0.0 || gap_energy(problem, chosen).is_clear()) return;
  for (const Segment& segment : held_out) {
    if (!is_of_actuator(segment)) continue;
    Segment* const specimen = specimen_behind(segment, held_out);
    if (specimen == nullptr) continue;
    std::vector<double> error = left_by(completed, segment);
    const double left = std::sqrt(mean_square(error));
    if (left > 0.0) tell(std::move(error), left, std::sqrt(energy / count), *specimen);
  }
}

}  // namespace hybridtest
