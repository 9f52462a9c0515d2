#pragma once

#include <array>
#include <cstddef>

#include "core/parameters/parameter_archive.hpp"
#include "mechanics/laws/law.hpp"

namespace hybridtest {

/// Smooth spring of Ramberg and Osgood (NACA TN 902, 1943) with the cyclic rules of Masing (1926; Jennings, J. Eng.
/// Mech. Div. ASCE 90, 1964). First loading, with xy = Fy / k:
///
///     x / xy = F / Fy (1 + a |F / Fy|^(n - 1))
///
/// From a reversal at (xr, Fr) the same curve, twice as large:
///
///     (x - xr) / (2 xy) = f (1 + a |f|^(n - 1)),    f = (F - Fr) / (2 Fy)
///
/// A branch that comes back to the reversal before ends there, and the motion goes on along the branch that this
/// reversal left: loops close, and the curve of first loading is never exceeded. Each force is the root of its equation
/// to rounding, whatever the step.
///
/// OpenSees has a material of this name, RambergOsgoodSteel, which doubles the force alone and not the plastic
/// displacement beside it; its makers have taken it out of the programs.
class RambergOsgood final : public Law {
 public:
  struct Parameters {
    double stiffness_n_per_m = 0.0;  // k
    double yield_force_n = 0.0;      // Fy
    double offset_ratio = 1.0;       // a
    double exponent = 5.0;           // n

    void serialize(ParameterArchive& archive) {
      archive.required("stiffness_n_per_m", stiffness_n_per_m, {kPositive, "of small motions"});
      archive.required("yield_force_n", yield_force_n, {kPositive});
      archive.optional("offset_ratio", offset_ratio,
                       {kNotNegative, "a, plastic over elastic displacement at the yield force"});
      archive.optional("exponent", exponent, {{.low = 1.0, .high = 100.0}, "n; the larger, the sharper the yielding"});
    }
  };

  /// @throws ConfigError for values outside these ranges.
  explicit RambergOsgood(const Parameters& parameters);

  [[nodiscard]] double trial(double displacement_m, double velocity_m_per_s) noexcept override;
  void commit() noexcept override;
  void revert() noexcept override { trial_ = committed_; }
  void reset() noexcept override { committed_ = trial_ = {}; }
  [[nodiscard]] double initial_stiffness_n_per_m() const noexcept override;

 private:
  struct Point {
    double displacement_m = 0.0;
    double force_n = 0.0;
  };

  /// Where the motion is; the reversals themselves are only written by commit().
  struct State {
    Point at;
    double direction = 0.0;      // of the branch; 0 where nothing has moved yet
    std::size_t turn_count = 0;  // reversals whose loops are open; 0: first loading
  };

  /// Reversals that are remembered. Where more loops are open within one another, the smallest is forgotten.
  static constexpr std::size_t kTurnsMax = 64;

  [[nodiscard]] bool has_turned() const noexcept { return trial_.direction * committed_.direction < 0.0; }
  /// Place of the next reversal; where there is none left, in place of the smallest loop.
  [[nodiscard]] std::size_t next_turn() const noexcept {
    return committed_.turn_count < kTurnsMax ? committed_.turn_count : kTurnsMax - 2;
  }
  [[nodiscard]] double first_loading_n(double displacement_m) const noexcept;

  Parameters parameters_;
  double yield_displacement_m_;
  std::array<Point, kTurnsMax> turns_{};
  State committed_;
  State trial_;
};

}  // namespace hybridtest
