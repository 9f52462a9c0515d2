#pragma once

#include "validation/blind_batches/plant/plant.hpp"

namespace hybridtest::blind {

/// Restoring force of a law that a user can name in a model, over a whole displacement history.
/// Written from docs/scenario.md and the literature: elastic; bilinear with kinematic hardening;
/// Giuffre-Menegotto-Pinto (Filippou, Popov and Bertero, EERC 83-19, 1983); Bouc-Wen with n = 1,
/// whose differential equation has a closed solution between two reversals.
/// Zero for none.
/// @param yield_share   empty, or what is left of the yield force of a bilinear law at every step.
[[nodiscard]] History law_force(const LawModel& law, const History& displacement_m, const History& yield_share = {});

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
[[nodiscard]] History bristle_friction(const FrictionParameters& friction, const MotionHistory& motion);

struct StackParameters {
  double stiffness_n_per_m = 0.0;  // initial, of the whole
  double yield_force_n = 0.0;      // where the initial and the hardening line meet
  double hardening_ratio = 0.0;
  double spread = 0.5;  // slips lie at (1 +- spread) of the yield displacement: 0 is sharp
};

/// Iwan's stack (J. Appl. Mech. 33, 1966): 40 elastic-plastic elements in parallel with a spring.
[[nodiscard]] History iwan_stack(const StackParameters& stack, const History& displacement_m);

/// True force of the specimen under a motion, fine grid, positive when it resists a positive
/// displacement: the user's law with the effects of the real specimen.
[[nodiscard]] History specimen_force(const Site& site, const PlantEffects& effects, const MotionHistory& motion);

}  // namespace hybridtest::blind
