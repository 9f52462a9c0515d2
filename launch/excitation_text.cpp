#include "launch/excitation_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "coordinator/excitation/response_spectrum.hpp"

namespace hybridtest {
namespace {

constexpr Eigen::Index kModesShown = 5;
constexpr std::size_t kForcesShown = 10;

std::string end_text(const MotionEnd& end) {
  return fmt::format("{:.4g} m/s and {:.4g} m", end.velocity_m_per_s, end.displacement_m);
}

std::string spectrum_text(const GroundMotion& motion, const VibrationModes& modes) {
  std::string text;
  for (Eigen::Index mode = 0; mode < std::min(modes.count(), kModesShown); ++mode) {
    const double period_s = modes.period_s(mode);
    if (!std::isfinite(period_s)) continue;
    if (text.empty()) text = "  spectrum (5 %)  period     pseudo-acceleration  velocity     displacement\n";
    const SpectrumOrdinate at = spectrum_ordinate(motion, period_s, kSpectrumDamping);
    text += fmt::format("    mode {:<10}{:6.4f} s  {:8.4f} g           {:7.4f} m/s  {:8.2f} mm\n", mode + 1, period_s,
                        at.pseudo_acceleration_m_per_s2 / kStandardGravity_m_per_s2, at.velocity_m_per_s,
                        1e3 * at.displacement_m);
  }
  return text;
}

std::string record_text(const Scenario& scenario, std::size_t index, const VibrationModes& modes) {
  const ExcitationScenario& excitation = scenario.excitation;
  const GroundRecord& record = excitation.records[index];
  std::string text =
      fmt::format("\nground motion {}{}: {}\n", excitation.records.size() > 1 ? fmt::format("{}, ", index + 1) : "",
                  record.text, ground_motion_text(record.facts));
  if (!record.support.empty()) text += fmt::format("  moves the support '{}' alone\n", record.support);
  if (record.factor_found)
    text += fmt::format("  scaled by {:.6g}, the factor found for scale_to\n", *record.factor_found);
  if (record.is_corrected) {
    text += fmt::format("  ground at the end, from rest: {}; before the correction {}\n", end_text(record.end),
                        end_text(record.end_as_read));
  }
  return text + spectrum_text(excitation.applied_motion(record, scenario.time.step_s), modes);
}

std::string forces_text(const std::vector<AppliedForce>& forces) {
  std::string text;
  for (const AppliedForce& force : forces) {
    if (&force == forces.data() + kForcesShown) {
      return text + fmt::format("and {} forces more\n", forces.size() - kForcesShown);
    }
    text += fmt::format("{}force {}: peak {:.4g} N\n", text.empty() ? "\n" : "", force.text, force.peak_n);
  }
  return text;
}

std::string free_vibration_text(const Scenario& scenario, const FreeVibration& start) {
  const double step_s = scenario.time.step_s;
  std::string text = fmt::format("\nfree vibration from up to {:.4g} mm and {:.4g} m/s: ",
                                 1e3 * start.initial.displacement_m.cwiseAbs().maxCoeff(),
                                 start.initial.velocity_m_per_s.cwiseAbs().maxCoeff());
  if (start.steps.ramp == 0) return text + "the test begins there\n";
  return text + fmt::format("pulled there in {:.6g} s, held {:.6g} s, released at {:.6g} s\n",
                            static_cast<double>(start.steps.ramp) * step_s,
                            static_cast<double>(start.steps.hold) * step_s,
                            scenario.model_time_s(scenario.excitation.release_step()));
}

}  // namespace

std::string excitation_text(const Scenario& scenario, const VibrationModes& modes) {
  const ExcitationScenario& excitation = scenario.excitation;
  std::string text;
  for (std::size_t i = 0; i < excitation.records.size(); ++i) text += record_text(scenario, i, modes);
  text += forces_text(excitation.forces);
  if (excitation.free_vibration) text += free_vibration_text(scenario, *excitation.free_vibration);
  return text;
}

}  // namespace hybridtest
