#pragma once

#include <string>
#include <vector>

#include "diagnosis/identification/problem.hpp"
#include "diagnosis/result/diagnosis_report.hpp"
#include "plant/effects/effect_type.hpp"

namespace hybridtest {

/// Size of the signals of one segment and of their noise, as standard deviations.
struct Excitation {
  std::string interface;
  Channel input{};
  Channel output{};
  double motion_m = 0.0;        // of the input
  double motion_noise_m = 0.0;  // 0 for a command, which has none
  double output_size = 0.0;     // of the output, in its unit
  double output_floor = 0.0;    // residual of a correct model, from noise in both channels

  [[nodiscard]] bool moves() const noexcept;        // the input is more than noise
  [[nodiscard]] bool shows() const noexcept;        // the output is more than noise
  [[nodiscard]] bool can_tell() const noexcept;     // both
  [[nodiscard]] bool is_measured() const noexcept;  // the output is, and not computed by the controller
  /// Why the segment is not sufficient: `it moves by 0.2 um, within the noise of measured_displacement_m (1 um)`.
  [[nodiscard]] std::string why_not() const;
};

[[nodiscard]] std::vector<Excitation> excitations_of(const IdentificationProblem& problem);

/// Whether no measured channel could have shown a gap: then the absence of a gap has no meaning.
[[nodiscard]] bool cannot_tell(const std::vector<Excitation>& excitations);

/// What to record instead, from the measured segment nearest to its limits; empty if a segment is sufficient.
[[nodiscard]] std::string experiment_that_excites(const std::vector<Excitation>& excitations);

/// Marks interfaces as not judged that agree with the model only because their signals are too small.
void leave_out_unexcited(const std::vector<Excitation>& excitations, std::vector<report::InterfaceGap>& where);

/// The test that can distinguish these effects; empty for fewer than two.
[[nodiscard]] std::string experiment_that_splits(const std::vector<const EffectType*>& effects);

/// What to change where the load cell is at its limit; empty where these causes are others.
[[nodiscard]] std::string experiment_within_range(const std::vector<const EffectType*>& causes);

/// The test to run where no effect of the library explains a gap.
/// @param is_seen_to_repeat   without that, whether the gap is the site's or a disturbance comes first.
[[nodiscard]] std::string experiment_for_unknown(EffectInterface interface, bool is_seen_to_repeat);

}  // namespace hybridtest
