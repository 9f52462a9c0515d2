#pragma once

#include "compensation/force_compensator.hpp"
#include "compensation/sample_history.hpp"
#include "core/parameters/parameter_archive.hpp"

namespace hybridtest {

/// Optimal pick (Wu, Wang and Bursi, Earthquake Engng Struct. Dyn. 42, 2013), the half on forces of the
/// upper-bound delay (upper_bound_delay.hpp).
///
/// Of the measurements of the last moments, the one whose displacement is nearest to the desired one
/// gives the force. Between two samples displacement and force are taken along straight lines. A
/// specimen passes a displacement on its way out and again on its way back; those passages count that
/// go the way the desired displacement goes. Sensor noise makes several of one, of which the mean is
/// taken. Where there is none, the nearest sample gives the force.
///
/// Exact, but for the straight lines, for a specimen that was at the desired displacement once within
/// the window. Interpretation: the paper's abstract says that the desired displacement is picked out by
/// an optimal process; criterion, interpolation and direction are ours.
class OptimalPick final : public ForceCompensator {
 public:
  struct Parameters {
    double window_s = 0.010;

    void serialize(ParameterArchive& archive) {
      archive.optional("window_s", window_s,
                       {{.low = 0.0, .high = 1.0, .low_open = true},
                        "that is looked back over, at least the upper bound less the smallest delay",
                        "a longer window holds every displacement of the specimen",
                        "1 control period to 1"});
    }
  };

  /// @throws ConfigError for values outside their ranges.
  OptimalPick(const Parameters& parameters, double control_period_s);

  [[nodiscard]] double corrected_force(const ForceSample& sample) noexcept override;
  void reset() noexcept override;

 private:
  [[nodiscard]] double picked(double desired_m) const noexcept;

  SampleHistory displacements_m_;
  SampleHistory forces_n_;
  double desired_m_ = 0.0;
  bool is_rising_ = true;
};

}  // namespace hybridtest
