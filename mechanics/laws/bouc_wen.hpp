#pragma once

#include <cstdint>
#include <optional>

#include "core/parameters/parameter_archive.hpp"
#include "mechanics/laws/bouc_wen_table.hpp"
#include "mechanics/laws/law.hpp"

namespace hybridtest {

/// Smooth hysteresis of Bouc (1967) and Wen (J. Eng. Mech. Div. ASCE 102, 1976):
///
///     F = alpha k x + (1 - alpha) k z
///     dz = (Ao - (gamma + beta sign(z dx)) |z|^n) dx
///
/// as BoucWen of OpenSees without degradation. Rate-independent: z depends on the path of x
/// alone, and between two exchanges x is taken to move one way. The differential equation is
/// integrated along that way to about 1e-9 of the ultimate z, whatever the length of the
/// step, so that results do not change with the step as those of a one-step rule do. With n = 1 it is solved exactly.
class BoucWen final : public Law {
 public:
  struct Parameters {
    double stiffness_n_per_m = 0.0;  // k
    double alpha = 0.0;
    double n = 1.0;
    double gamma_per_m = 0.0;
    double beta_per_m = 0.0;
    double ao = 1.0;

    void serialize(ParameterArchive& archive) {
      archive.required("stiffness_n_per_m", stiffness_n_per_m, {kPositive, "k"});
      archive.required("alpha", alpha, {kZeroToOne, "share of the elastic spring"});
      archive.optional("n", n, {{.low = 1.0, .high = 100.0}, "the larger, the sharper the yielding"});
      archive.required("gamma_per_m", gamma_per_m,
                       {.what = "gamma", .values = "more than −`beta_per_m`", .unit = "1/mⁿ"});
      archive.required("beta_per_m", beta_per_m, {.range = kNotNegative, .what = "beta", .unit = "1/mⁿ"});
      archive.optional("ao", ao, {kPositive, "Ao, initial slope of z"});
    }
  };

  /// How z is found. By substeps of a 64th of the length over which the slope changes: classical Runge-Kutta is then
  /// exact to about (1/64)^4 / 120 = 5e-10 of the ultimate z. By a table that is made once: to 6e-6 with n up to 10 and
  /// 2e-5 with more, which is enough for a search, and several times faster.
  enum class Integration : std::uint8_t { substeps, table };

  /// @throws ConfigError for values outside these ranges.
  explicit BoucWen(const Parameters& parameters, Integration integration = Integration::substeps);

  [[nodiscard]] double trial(double displacement_m, double velocity_m_per_s) noexcept override;
  void commit() noexcept override { committed_ = trial_; }
  void revert() noexcept override { trial_ = committed_; }
  void reset() noexcept override { committed_ = trial_ = State{}; }
  [[nodiscard]] double initial_stiffness_n_per_m() const noexcept override;

  /// Limit of |z| under growing displacement: (Ao / (beta + gamma))^(1/n) [m].
  [[nodiscard]] double ultimate_m() const noexcept { return ultimate_m_; }

 private:
  struct State {
    double displacement_m = 0.0;
    double hysteretic = 0.0;  // z over ultimate_m()
  };

  /// Slope of w = z / ultimate_m() along the path, w counted positive in the direction of motion.
  [[nodiscard]] double slope(double w) const noexcept;
  [[nodiscard]] double carried_along(double w, double path) const noexcept;
  /// With n = 1: dw/ds = 1 + c w on the way back to zero, 1 - w from there.
  [[nodiscard]] double carried_exactly(double w, double path) const noexcept;
  [[nodiscard]] double carried_by_table(double w, double path) const noexcept;
  [[nodiscard]] double carried_by_substeps(double w, double path) const noexcept;
  /// The next substep, at most what is left of the path.
  [[nodiscard]] double substep(double w, double left) const noexcept;
  [[nodiscard]] double path_to_zero(double w) const noexcept;

  Parameters parameters_;
  double ultimate_m_;
  double unloading_;          // (gamma - beta) / (gamma + beta)
  double unloading_root_;     // fifth root of its size
  double short_anywhere_;     // a substep that is short enough wherever z is within its limit
  bool is_singular_at_zero_;  // high derivatives of |z|^n
  // Towards the limit, and from zero backwards to where the motion turned; nothing without tables.
  std::optional<BoucWenTable> loading_table_;
  std::optional<BoucWenTable> unloading_table_;
  State committed_;
  State trial_;
};

}  // namespace hybridtest
