#pragma once

#include <array>
#include <cstddef>

#include "core/parameters/parameter_archive.hpp"
#include "mechanics/laws/law.hpp"

namespace hybridtest {

/// What PeakOriented, PinchedReloading and Takeda have in common: straight branches that reload towards the largest
/// displacement reached, and a backbone that deteriorates with the dissipated energy (Ibarra, Medina and Krawinkler,
/// Earthquake Engng Struct. Dyn. 34, 2005; Lignos and Krawinkler, J. Struct. Eng. 137, 2011).
///
/// Backbone on either side, with xy = Fy / k, Fc = Fy + b k up and kc = Fc / uc:
///
///     F = k x up to xy, then Fy + b k (x - xy) up to xy + up, then Fc - kc (x - xy - up), not below r Fy
///
/// Branches: a reversal unloads along a straight line of stiffness ku to zero force. There the next excursion begins
/// and reloads towards the largest displacement of its side (virgin: xy), by way of the last reversal of that side
/// where the way through it is the stiffer one (Mahin and Bertero, 1975), and then follows the backbone. Small
/// unloading and reloading before zero force comes back on the same line and leaves no trace.
///
/// Deterioration by the dissipated energy, each mode with a capacity L of its own (0: none) and the exponent c:
///
///     beta = (Ei / (L Fy - sum Ej))^c      Ei of the excursion that ends, sum Ej of all up to and with it
///
/// At the begin of an excursion, on its side: basic strength, Fy and b k shrink by (1 - beta_s); post-capping
/// strength, the descending line moves towards the origin, its force at zero displacement shrinks by (1 - beta_c);
/// reloading stiffness, the displacement that it aims at grows by (1 + beta_a). At a reversal: ku is that of the
/// excursion's begin by (1 - beta_k). Where a beta reaches 1, or the backbone falls to zero force, the strength is
/// lost: the force is zero from then on.
///
/// The displacement is taken to move one way between two exchanges, and every corner on the way is met exactly:
/// results do not change with the step. IMKPeakOriented and IMKPinching of OpenSees take beta from the energy up to
/// the step before zero force, which agrees for small steps, and shrink ku anew at each reversal of an excursion, so
/// that noise shrinks it too; here several reversals in one excursion count once. They also reload by way of a reversal
/// at the largest displacement itself, which hides the loss of reloading stiffness where the backbone still rises.
class DeterioratingHysteresis : public Law {
 public:
  struct Parameters {
    double stiffness_n_per_m = 0.0;            // k
    double yield_force_n = 0.0;                // Fy
    double hardening_ratio = 0.0;              // b
    double capping_displacement_m = 0.0;       // up
    double post_capping_displacement_m = 0.0;  // uc
    double residual_ratio = 0.0;               // r
    double strength_capacity_m = 0.0;          // L of the four modes
    double capping_capacity_m = 0.0;
    double unloading_capacity_m = 0.0;
    double reloading_capacity_m = 0.0;
    double deterioration_exponent = 1.0;  // c

    void serialize(ParameterArchive& archive) {
      archive.required("stiffness_n_per_m", stiffness_n_per_m, {kPositive, "before yielding"});
      archive.required("yield_force_n", yield_force_n, {kPositive});
      archive.required("hardening_ratio", hardening_ratio,
                       {kZeroToBelowOne, "stiffness after yielding over stiffness before"});
      archive.optional("capping_displacement_m", capping_displacement_m,
                       {kNotNegative, "from yielding to the highest strength; 0: never"});
      archive.optional("post_capping_displacement_m", post_capping_displacement_m,
                       {kNotNegative, "from the highest strength on to none; more than 0 with capping"});
      archive.optional("residual_ratio", residual_ratio, {kZeroToBelowOne, "residual strength over yield force"});
      archive.optional("strength_capacity_m", strength_capacity_m,
                       {kNotNegative, "energy over yield force until the strength is lost; 0: no loss"});
      archive.optional("capping_capacity_m", capping_capacity_m, {kNotNegative, "likewise, of the post-capping line"});
      archive.optional("unloading_capacity_m", unloading_capacity_m,
                       {kNotNegative, "likewise, of the unloading stiffness"});
      archive.optional("reloading_capacity_m", reloading_capacity_m,
                       {kNotNegative, "likewise, of the reloading stiffness"});
      archive.optional("deterioration_exponent", deterioration_exponent,
                       {{.low = 0.5, .high = 4.0}, "c; the larger, the later the loss"});
    }
  };

  [[nodiscard]] double trial(double displacement_m, double velocity_m_per_s) noexcept final;
  void commit() noexcept final { committed_ = trial_; }
  void revert() noexcept final { trial_ = committed_; }
  void reset() noexcept final { committed_ = trial_ = virgin(); }
  [[nodiscard]] double initial_stiffness_n_per_m() const noexcept final { return parameters_.stiffness_n_per_m; }

 protected:
  /// What the laws differ in.
  struct Form {
    /// Where the reloading bends (PinchedReloading): at (1 - `break_displacement_ratio`) of what the largest
    /// displacement leaves after unloading, and at `break_force_ratio` of the straight line's force; 1 does not bend.
    double break_force_ratio = 1.0;
    double break_displacement_ratio = 0.0;
    /// Where the backbone bends before yielding (Takeda) and its stiffness from there to yielding; a force of 0 does
    /// not bend.
    double cracking_force_n = 0.0;
    double cracked_n_per_m = 0.0;
    double unloading_exponent = 0.0;  // Takeda
  };

  /// @throws ConfigError for values outside the ranges, or capping without a post-capping displacement.
  DeterioratingHysteresis(const Parameters& parameters, const Form& form);
  DeterioratingHysteresis(const DeterioratingHysteresis&) = default;
  DeterioratingHysteresis& operator=(const DeterioratingHysteresis&) = default;

 private:
  struct Point {
    double displacement_m = 0.0;
    double force_n = 0.0;
  };

  /// Start, break, last reversal, peak, yielding, highest strength, residual strength.
  static constexpr std::size_t kCornersMax = 7;

  /// Signs as if the side were the positive one.
  struct Side {
    double yield_force_n = 0.0;
    double hardening_n_per_m = 0.0;
    double capping_force_n = 0.0;  // the post-capping line at zero displacement
    Point peak;                    // of the largest displacement
    Point turn;                    // last reversal
    bool turn_is_inner = false;    // before the peak
  };

  struct State {
    double displacement_m = 0.0;
    double force_n = 0.0;
    double energy_j = 0.0;           // work of the force so far
    double energy_at_begin_j = 0.0;  // of the excursion
    double unloading_n_per_m = 0.0;
    double unloading_share = 1.0;           // what deterioration leaves of the stiffness
    double unloading_share_at_begin = 1.0;  // of the excursion
    double side = 1.0;                      // sign of the force
    bool is_virgin = true;
    bool is_unloading = false;
    bool is_lost = false;
    std::array<Side, 2> sides;                 // positive, negative
    std::array<Point, kCornersMax> corners{};  // of the excursion, on its side
    std::size_t corner_count = 0;
    double last_slope_n_per_m = 0.0;  // beyond the last corner
  };

  [[nodiscard]] State virgin() const noexcept;
  [[nodiscard]] static Side& side_of(State& state) noexcept { return state.sides[state.side > 0.0 ? 0 : 1]; }
  void advance(State& state, double displacement_m) const noexcept;
  static void move(State& state, const Point& to) noexcept;
  void follow_corners(State& state, double towards_m) const noexcept;
  void begin_unloading(State& state) const noexcept;
  void begin_excursion(State& state) const noexcept;
  void deteriorate(State& state) const noexcept;
  void aim_at_peak(State& state) const noexcept;
  void add_backbone(State& state) const noexcept;
  [[nodiscard]] double beta(State& state, double capacity_m, double energy_j, double excursion_j) const noexcept;
  [[nodiscard]] double backbone_n(const Side& side, double displacement_m) const noexcept;
  [[nodiscard]] double hardening_n(const Side& side, double displacement_m) const noexcept;
  [[nodiscard]] double yield_m(const Side& side) const noexcept;
  [[nodiscard]] double form_stiffness_n_per_m(const Side& side) const noexcept;
  [[nodiscard]] double residual_n() const noexcept { return parameters_.residual_ratio * parameters_.yield_force_n; }
  [[nodiscard]] bool has_cap() const noexcept { return parameters_.capping_displacement_m > 0.0; }

  Parameters parameters_;
  Form form_;
  Point crack_;                        // where the virgin law leaves its first line: cracking or yielding
  double post_capping_n_per_m_ = 0.0;  // not positive
  State committed_;
  State trial_;
};

}  // namespace hybridtest
