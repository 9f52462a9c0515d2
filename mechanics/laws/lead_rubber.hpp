#pragma once

#include "core/parameters/parameter_archive.hpp"
#include "mechanics/laws/law.hpp"

namespace hybridtest {

/// Rubber bearing with a lead core: an elastic spring beside an elastic, perfectly plastic one (Robinson, Earthquake
/// Engng Struct. Dyn. 10, 1982) that loses strength as the lead heats up (Kalpakidis and Constantinou, J. Struct. Eng.
/// 135, 2009, without conduction of heat into steel and rubber, which the first cycles leave no time for):
///
///     F = kr x + Q z,    |z| <= 1,    Q = Q0 exp(-E2 T),    C dT = Q |dxp|
///
/// With the plastic path s of the lead that is solved by Q = Q0 / (1 + s / L), L = C / (E2 Q0): after the path L half
/// of the strength is left. The return to the strength is exact for any increment.
class LeadRubber final : public Law {
 public:
  struct Parameters {
    double rubber_stiffness_n_per_m = 0.0;  // kr
    double lead_strength_n = 0.0;           // Q0
    double yield_displacement_m = 0.0;      // of the lead
    double heating_path_m = 0.0;            // L

    void serialize(ParameterArchive& archive) {
      archive.required("rubber_stiffness_n_per_m", rubber_stiffness_n_per_m,
                       {kNotNegative, "after yielding of the lead"});
      archive.required("lead_strength_n", lead_strength_n,
                       {kPositive, "Q0, force at zero displacement in a wide loop"});
      archive.required("yield_displacement_m", yield_displacement_m, {kPositive, "of the lead"});
      archive.optional("heating_path_m", heating_path_m,
                       {kNotNegative, "plastic path after which half of the strength is left; 0: no heating"});
    }
  };

  /// @throws ConfigError for values outside these ranges.
  explicit LeadRubber(const Parameters& parameters);

  [[nodiscard]] double trial(double displacement_m, double velocity_m_per_s) noexcept override;
  void commit() noexcept override { committed_ = trial_; }
  void revert() noexcept override { trial_ = committed_; }
  void reset() noexcept override { committed_ = trial_ = {}; }
  [[nodiscard]] double initial_stiffness_n_per_m() const noexcept override;

 private:
  struct State {
    double displacement_m = 0.0;
    double elastic_m = 0.0;  // of the lead
    double path_m = 0.0;     // plastic, of the lead
  };

  [[nodiscard]] double path_after(double elastic_m) const noexcept;

  Parameters parameters_;
  State committed_;
  State trial_;
};

}  // namespace hybridtest
