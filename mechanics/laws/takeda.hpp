#pragma once

#include "mechanics/laws/deteriorating_hysteresis.hpp"

namespace hybridtest {

/// Reinforced concrete member in bending that cracks, yields and unloads the softer, the farther it has been (Takeda,
/// Sozen and Nielsen, J. Struct. Div. ASCE 96, 1970). Backbone of three lines through the cracking point (xc, Fc) and
/// the yield point (xy, Fy), or of two without cracking, where (xc, Fc) in the equations is the yield point. Unloading
/// of a side whose largest displacement is xm with force Fm:
///
///     k = (Fm + Fc) / (xm + xc)                     up to yielding: towards the cracking point of the other side
///     k = (Fy + Fc) / (xy + xc) (xy / xm)^alpha     beyond it
///
/// Simplified in the reloading: it aims at the largest displacement of its side (before cracking: at the cracking
/// point), by way of the last reversal where that is the stiffer way, as PeakOriented does; the original has rules for
/// several nested loops. Without cracking it is the bilinear (Clough) form with Takeda's unloading, the same as
/// Hysteretic of OpenSees with a pinching of 1 and beta = alpha.
class Takeda final : public DeterioratingHysteresis {
 public:
  struct Parameters {
    double stiffness_n_per_m = 0.0;
    double yield_force_n = 0.0;
    double hardening_ratio = 0.0;
    double cracking_force_n = 0.0;    // Fc
    double cracked_ratio = 1.0;       // (Fy - Fc) / (xy - xc) over the initial stiffness
    double unloading_exponent = 0.4;  // alpha

    void serialize(ParameterArchive& archive) {
      archive.required("stiffness_n_per_m", stiffness_n_per_m, {kPositive, "before cracking or, without it, yielding"});
      archive.required("yield_force_n", yield_force_n, {kPositive});
      archive.required("hardening_ratio", hardening_ratio,
                       {kZeroToBelowOne, "stiffness after yielding over the initial stiffness"});
      archive.optional("cracking_force_n", cracking_force_n,
                       {.range = kNotNegative, .what = "Fc; 0: no cracking", .values = "0 to below `yield_force_n`"});
      archive.optional("cracked_ratio", cracked_ratio,
                       {{.low = 0.0, .high = 1.0, .low_open = true},
                        "stiffness from cracking to yielding over the initial stiffness"});
      archive.optional("unloading_exponent", unloading_exponent,
                       {kZeroToOne, "alpha; 0: unloads with the stiffness of small motions"});
    }
  };

  /// @throws ConfigError for values outside these ranges.
  explicit Takeda(const Parameters& parameters);
};

}  // namespace hybridtest
