#pragma once

#include <algorithm>

#include "core/parameters/parameter_archive.hpp"
#include "mechanics/laws/law.hpp"

namespace hybridtest {

/// Force per stiffness of a spring beyond a gap on either side of zero: x - clamp(x, -g, g) [m].
[[nodiscard]] inline double beyond_gap_m(double displacement_m, double gap_m) noexcept {
  return displacement_m - std::clamp(displacement_m, -gap_m, gap_m);
}

/// Spring that acts beyond a gap on either side, at a fixed position (Chopra, Dynamics of Structures, 2012,
/// section 22.1).
class GapSpring final : public Law {
 public:
  struct Parameters {
    double stiffness_n_per_m = 0.0;
    double gap_m = 0.0;

    void serialize(ParameterArchive& archive) {
      archive.required("stiffness_n_per_m", stiffness_n_per_m, {kPositive, "beyond the gap"});
      archive.required("gap_m", gap_m, {kNotNegative, "on either side"});
    }
  };

  /// @throws ConfigError for values outside these ranges.
  explicit GapSpring(const Parameters& parameters);

  [[nodiscard]] double trial(double displacement_m, double /*velocity_m_per_s*/) noexcept override {
    return parameters_.stiffness_n_per_m * beyond_gap_m(displacement_m, parameters_.gap_m);
  }
  void commit() noexcept override {}
  void revert() noexcept override {}
  void reset() noexcept override {}
  [[nodiscard]] double initial_stiffness_n_per_m() const noexcept override {
    return parameters_.gap_m > 0.0 ? 0.0 : parameters_.stiffness_n_per_m;
  }

 private:
  Parameters parameters_;
};

}  // namespace hybridtest
