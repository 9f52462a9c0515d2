#include "diagnosis/verdict/told_noise.hpp"

#include <algorithm>
#include <cmath>

#include "diagnosis/verdict/library_fits.hpp"

namespace hybridtest {

bool tell_noise(const IdentificationProblem& problem, const FitOutcome& chosen, const SiteModel& completed,
                std::vector<Segment>& segments) {
  const auto is_of_actuator = [](const FitSegment& fit) {
    return fit.segment.to == Channel::measured_displacement && !fit.segment.is_quasi_static;
  };
  const bool is_asked = std::ranges::any_of(
      problem.segments, [&](const FitSegment& fit) { return fit.is_suspect && is_of_actuator(fit); });
  if (!is_asked || gap_energy(problem, chosen).is_clear()) return false;
  bool is_told = false;
  for (const FitSegment& fit : problem.segments) {
    if (!is_of_actuator(fit)) continue;
    const auto of_specimen = std::ranges::find_if(segments, [&](const Segment& segment) {
      return segment.from == Channel::measured_displacement && segment.recording == fit.segment.recording &&
             segment.input.size() == fit.segment.measured.size() && !(segment.input_step > 0.0);
    });
    if (of_specimen == segments.end()) continue;
    std::vector<double> error = predict(completed, fit.segment);
    for (std::size_t i = 0; i < error.size(); ++i) error[i] = fit.segment.measured[i] - error[i];
    const double left = std::sqrt(fit.average(error).squaredNorm() / static_cast<double>(fit.measured.size()));
    if (!(left > 0.0)) continue;
    for (double& value : error) value *= std::min(1.0, fit.floor / left);
    of_specimen->told_noise = motion_of_readings(*of_specimen, error);
    is_told = true;
  }
  return is_told;
}

}  // namespace hybridtest
