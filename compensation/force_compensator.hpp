#pragma once

namespace hybridtest {

/// What a compensator on forces sees at one sample, one degree of freedom.
struct ForceSample {
  double desired_displacement_m = 0.0;   // [m] the target that the force ought to belong to
  double measured_displacement_m = 0.0;  // [m] newest measurement
  double measured_force_n = 0.0;         // [N] of the same instant as the measured displacement
};

/// Makes of measured forces, which belong to displacements of the past, the force that belongs to
/// the desired displacement. One instance per degree of freedom, called once per sample.
///
/// Values that are not finite: where the method uses it, a non-finite measurement or target makes
/// the force non-finite for as long as it is in the method's history and no longer. No force is
/// made up for one that was not measured.
class ForceCompensator {
 public:
  virtual ~ForceCompensator() = default;

  /// The force [N] for this sample, sign as measured. Allocates nothing.
  [[nodiscard]] virtual double corrected_force(const ForceSample& sample) noexcept = 0;
  /// Back to what it was when new: no history, nothing learnt.
  virtual void reset() noexcept = 0;
};

}  // namespace hybridtest
