#pragma once

#include "core/parameters/parameter_checker.hpp"
#include "mechanics/laws/deteriorating_hysteresis.hpp"

namespace hybridtest {

/// Peak-oriented spring whose reloading is pinched: it goes in two straight parts, first towards a break point and from
/// there to the largest displacement reached (Ibarra, Medina and Krawinkler, Earthquake Engng Struct. Dyn. 34, 2005),
/// as reinforced concrete in shear, timber joints and bolted connections do. With the excursion's begin x0, the peak
/// (xp, Fp) and the unloading stiffness ku, the break point is at
///
///     xb = (1 - kd) (xp - Fp / ku),     Fb = kf Fp (xb - x0) / (xp - x0)
///
/// and it is left out where x0 is beyond it. Backbone and deterioration as in PeakOriented, see
/// DeterioratingHysteresis. The same as IMKPinching of OpenSees with equal sides.
class PinchedReloading final : public DeterioratingHysteresis {
 public:
  struct Parameters : DeterioratingHysteresis::Parameters {
    double pinching_force_ratio = 0.0;         // kf
    double pinching_displacement_ratio = 0.0;  // kd

    void serialize(ParameterArchive& archive) {
      DeterioratingHysteresis::Parameters::serialize(archive);
      archive.required("pinching_force_ratio", pinching_force_ratio,
                       {{.low = 0.0, .high = 1.0, .low_open = true},
                        "force at the break point over that of the straight line to the peak; 1: no pinching"});
      archive.required("pinching_displacement_ratio", pinching_displacement_ratio,
                       {kZeroToOne, "how far the break point is before the displacement that the peak leaves behind"});
    }
  };

  /// @throws ConfigError for values outside their ranges, or capping without a post-capping displacement.
  explicit PinchedReloading(const Parameters& parameters)
      : DeterioratingHysteresis{checked(parameters),
                                {parameters.pinching_force_ratio, parameters.pinching_displacement_ratio}} {}
};

}  // namespace hybridtest
