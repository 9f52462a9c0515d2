#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string_view>
#include <vector>

#include "validation/blind_batches/plant/plant.hpp"

/// The specimen as a machine that is moved fine step by fine step and answers with its force. What was there
/// before is its state, so that it can stand in a closed loop.
namespace hybridtest::blind {

/// Restoring force of a law that a user can name in a model.
/// Written from docs/scenario.md and the literature: elastic; bilinear with kinematic hardening;
/// Giuffre-Menegotto-Pinto (Filippou, Popov and Bertero, EERC 83-19, 1983); Bouc-Wen with n = 1,
/// whose differential equation has a closed solution between two reversals.
/// Zero for none.
class BaseLaw {
 public:
  explicit BaseLaw(const LawModel& law);
  /// @param yield_share   what is left of the yield force of a bilinear law.
  [[nodiscard]] double force(double displacement_m, double yield_share = 1.0);

 private:
  [[nodiscard]] double bilinear(double x, double yield_share);
  [[nodiscard]] double bouc_wen(double x);
  [[nodiscard]] double steel(double x);
  void turn_steel(int heading);

  LawModel law_;
  double x_ = 0.0;
  double f_ = 0.0;
  double memory_ = 0.0;  // plastic slip, or the loop's own displacement
  // The curve of a Giuffre-Menegotto-Pinto spring since the last reversal.
  double extreme_[2] = {};
  double from_x_ = 0.0;
  double from_f_ = 0.0;
  double corner_x_ = 0.0;
  double sharpness_ = 1.0;
  int heading_ = 0;
};

/// The same over a whole displacement history.
[[nodiscard]] History law_force(const LawModel& law, const History& displacement_m);

/// Friction and yielding as the plant has them.

struct FrictionParameters {
  double force_n = 0.0;           // sliding, while moving forward
  double force_backward_n = 0.0;  // while moving backward
  double breakaway_n = 0.0;       // at rest; the sliding force itself for Coulomb friction
  double stribeck_m_per_s = 1.0;  // velocity over which the breakaway excess fades
  double presliding_m = 0.0;      // deflection of the bristles at the sliding force
};

/// LuGre bristles (Canudas de Wit, Olsson, Astrom and Lischinsky, IEEE Trans. Automatic Control
/// 40, 1995): F = s0 z, z' = v - |v| z / z_slip(v), integrated exactly over a step of constant v.
class Bristles {
 public:
  Bristles(const FrictionParameters& friction, double period_s) : friction_{friction}, period_s_{period_s} {}
  [[nodiscard]] double force(double displacement_m);

 private:
  FrictionParameters friction_;
  double period_s_;
  double x_ = 0.0;
  double deflection_ = 0.0;
  bool has_moved_ = false;
};

/// Of the rate of the motion.
[[nodiscard]] History bristle_friction(const FrictionParameters& friction, const MotionHistory& motion);

struct StackParameters {
  double stiffness_n_per_m = 0.0;  // initial, of the whole
  double yield_force_n = 0.0;      // where the initial and the hardening line meet
  double hardening_ratio = 0.0;
  double spread = 0.5;  // slips lie at (1 +- spread) of the yield displacement: 0 is sharp
};

/// Iwan's stack (J. Appl. Mech. 33, 1966): 40 elastic-plastic elements in parallel with a spring.
class IwanStack {
 public:
  explicit IwanStack(const StackParameters& stack);
  /// @param stiffness_share, strength_share   what is left of the stiffness and the slip forces of the elements.
  [[nodiscard]] double force(double displacement_m, double stiffness_share = 1.0, double strength_share = 1.0);

 private:
  static constexpr std::size_t kElements = 40;
  StackParameters stack_;
  std::array<double, kElements> reach_{};
  std::array<double, kElements> slip_{};
};

/// The same over a whole displacement history.
[[nodiscard]] History iwan_stack(const StackParameters& stack, const History& displacement_m);

/// A pin in a slot whose edges push it along; nine slots side by side, (1 +- spread) of `width_m` wide.
class MovingSlot {
 public:
  explicit MovingSlot(double width_m, double spread = 0.0);
  [[nodiscard]] double next(double displacement_m);

 private:
  static constexpr std::size_t kSlots = 9;
  std::array<double, kSlots> half_width_m_{};
  std::array<double, kSlots> pin_m_{};
};

/// exp(-d / D), d: path, largest displacement, energy dissipated, or time.
class Fading {
 public:
  Fading(std::string_view with, double scale) : with_{with}, scale_{scale} {}
  [[nodiscard]] double left() const { return std::exp(-spent_ / scale_); }
  /// @param stored_j   what of the work of the force comes back where it unloads.
  void after(const MotionPoint& at, double force, double stored_j = 0.0) {
    const double step = at.displacement_m - x_;
    x_ = at.displacement_m;
    work_ += force * step;
    if (with_ == "path") spent_ += std::abs(step);
    if (with_ == "peak") spent_ = std::max(spent_, std::abs(x_));
    if (with_ == "energy") spent_ = std::max(spent_, work_ - stored_j);
    if (with_ == "time") spent_ = at.time_s;
  }

 private:
  std::string_view with_;
  double scale_;
  double x_ = 0.0;
  double work_ = 0.0;
  double spent_ = 0.0;
};

/// Force of a part of the specimen at each fine step, in order.
using ForceTerm = std::function<double(const MotionPoint&)>;

/// True force of the specimen, positive when it resists a positive displacement: the user's law with the effects
/// of the real specimen. To be called once for each fine step.
class SpecimenStage {
 public:
  SpecimenStage(const Site& site, const PlantEffects& effects, double period_s);
  [[nodiscard]] double force(const MotionPoint& motion);

 private:
  void add_effect(const PlantEffect& effect, double period_s);

  double known_mass_kg_;
  double known_damping_n_s_per_m_;
  std::vector<MovingSlot> play_;
  Differentiator behind_play_;
  ForceTerm spring_;                                   // of the displacement behind the play
  std::vector<ForceTerm> shares_;                      // factors of the spring's force
  std::vector<ForceTerm> terms_;                       // beside the spring
  std::vector<std::function<double(double)>> echoes_;  // of the whole force so far
};

/// The same over a whole motion on the fine grid.
[[nodiscard]] History specimen_force(const Site& site, const PlantEffects& effects, const MotionHistory& motion);

}  // namespace hybridtest::blind
