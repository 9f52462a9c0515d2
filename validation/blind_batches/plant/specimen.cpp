#include "validation/blind_batches/plant/specimen.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "validation/blind_batches/plant/base_law.hpp"
#include "validation/blind_batches/plant/foreign_effects.hpp"
#include "validation/blind_batches/plant/hysteresis.hpp"

namespace hybridtest::blind {
namespace {

/// Way travelled, in m.
History travel(const History& x) {
  History way(x.size(), 0.0);
  for (std::size_t i = 1; i < x.size(); ++i) way[i] = way[i - 1] + std::abs(x[i] - x[i - 1]);
  return way;
}

/// A pin in a slot of half-width `clearance_m` about the origin.
History in_fixed_slot(const History& x, double clearance_m) {
  History engaged(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) engaged[i] = x[i] - std::clamp(x[i], -clearance_m, clearance_m);
  return engaged;
}

/// A pin that is pushed along by the edges of a slot of that width.
History in_moving_slot(const History& x, double width_m) {
  History pushed(x.size());
  double pin = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    pin = std::max(std::min(pin, x[i] + 0.5 * width_m), x[i] - 0.5 * width_m);
    pushed[i] = pin;
  }
  return pushed;
}

/// The spring's own force, with what changes the spring.
History spring_force(const Site& site, const PlantEffects& effects, const MotionHistory& motion) {
  LawModel law = site.specimen;
  History deformation = motion.displacement_m;
  History yield_share;
  const PlantEffect* yielding = nullptr;
  for (const PlantEffect& effect : effects) {
    if (effect.interface != "specimen") continue;
    if (effect.name == "gap") deformation = in_fixed_slot(deformation, effect.of("clearance_m"));
    if (effect.name == "stiffness_error") law.stiffness_n_per_m *= effect.of("stiffness_ratio");
    if (effect.name == "yielding") yielding = &effect;
    if (effect.name == "strength_degradation") {
      yield_share = travel(deformation);
      for (double& share : yield_share) share = std::exp(-effect.of("degradation_per_m") * share);
    }
  }
  if (yielding == nullptr) return law_force(law, deformation, yield_share);
  return iwan_stack(
      {law.stiffness_n_per_m, yielding->of("yield_force_n"), yielding->of("hardening_ratio"), yielding->of("spread")},
      deformation);
}

/// What weakens the spring's force as the test goes on, or where.
void weaken(const PlantEffect& effect, const MotionHistory& motion, History& force) {
  const History& x = motion.displacement_m;
  if (effect.name == "stiffness_degradation") {
    const History way = travel(x);
    for (std::size_t i = 0; i < x.size(); ++i) force[i] *= std::exp(-effect.of("degradation_per_m") * way[i]);
  } else if (effect.name == "pinching") {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double place = x[i] / effect.of("width_m");
      const double square = place * place;
      force[i] *= 1.0 - effect.of("pinching_ratio") / (1.0 + square * square);
    }
  } else if (effect.name == "fracture") {
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (static_cast<double>(i) * motion.period_s >= effect.of("time_s")) force[i] *= 1.0 - effect.of("lost_ratio");
    }
  }
}

/// Spring and dashpot in series, q' = (x - q) / tau, exact for constant x over a step.
void add_relaxation(const PlantEffect& effect, const MotionHistory& motion, History& force) {
  const double following = 1.0 - std::exp(-motion.period_s / effect.of("time_constant_s"));
  double q = 0.0;
  for (std::size_t i = 0; i < motion.size(); ++i) {
    q += following * (motion.displacement_m[i] - q);
    force[i] += effect.of("stiffness_n_per_m") * (motion.displacement_m[i] - q);
  }
}

void add_friction(const PlantEffect& effect, const MotionHistory& motion, History& force) {
  FrictionParameters friction;
  friction.force_n = effect.of("friction_force_n");
  friction.force_backward_n = friction.force_n;
  friction.breakaway_n = friction.force_n;
  friction.presliding_m = effect.of("presliding_m");
  if (effect.parameters.contains("friction_force_backward_n")) {
    friction.force_backward_n = effect.of("friction_force_backward_n");
  }
  if (effect.name == "stribeck_friction") {
    friction.breakaway_n = effect.of("static_force_n");
    friction.stribeck_m_per_s = effect.of("stribeck_velocity_m_per_s");
  }
  add(force, bristle_friction(friction, motion));
}

/// Forces beside the spring that follow from the motion at the same instant.
void add_instantaneous(const PlantEffect& effect, const MotionHistory& motion, History& force) {
  const std::string_view name = effect.name;
  for (std::size_t i = 0; i < motion.size(); ++i) {
    const double x = motion.displacement_m[i];
    const double v = motion.velocity_m_per_s[i];
    if (name == "viscous_damping") force[i] += effect.of("damping_n_s_per_m") * v;
    if (name == "quadratic_damping") force[i] += effect.of("damping_n_s2_per_m2") * v * std::abs(v);
    if (name == "cubic_stiffness") force[i] += effect.of("stiffness_n_per_m3") * x * x * x;
    if (name == "contact") force[i] += effect.of("stiffness_n_per_m") * std::max(0.0, x - effect.of("distance_m"));
    if (name == "inertia") force[i] += effect.of("mass_kg") * motion.acceleration_m_per_s2[i];
    if (name == "geometric_stiffness") {
      const double length_m = effect.of("length_m");  // of a column that leans as a pendulum
      force[i] -= effect.of("load_n") * x / std::sqrt(length_m * length_m - x * x);
    }
  }
}

}  // namespace

History specimen_force(const Site& site, const PlantEffects& effects, const MotionHistory& motion) {
  MotionHistory engaged = motion;  // of the specimen behind the play of its pin
  for (const PlantEffect& effect : effects) {
    if (effect.interface != "specimen" || effect.name != "backlash") continue;
    engaged = motion_of(in_moving_slot(motion.displacement_m, effect.of("width_m")), motion.period_s);
  }
  History force = spring_force(site, effects, engaged);
  for (const PlantEffect& effect : effects) {
    if (effect.interface == "specimen") weaken(effect, motion, force);
  }
  add(force, engaged.velocity_m_per_s, site.known_damping_n_s_per_m);
  add(force, motion.acceleration_m_per_s2, site.known_mass_kg);
  for (const PlantEffect& effect : effects) {
    if (effect.interface != "specimen") continue;
    if (effect.name == "relaxation") add_relaxation(effect, motion, force);
    if (effect.name == "coulomb_friction" || effect.name == "stribeck_friction") add_friction(effect, motion, force);
    if (effect.name == "bouc_wen_hysteresis") {
      // A closed form of the same curves: Dahl's bristles, and springs beside them are the law's.
      FrictionParameters loop;
      loop.force_n = loop.force_backward_n = loop.breakaway_n = effect.of("force_n");
      loop.presliding_m = effect.of("yield_displacement_m");
      add(force, bristle_friction(loop, motion));
    }
    add_instantaneous(effect, motion, force);
    add_foreign_force(effect, site, motion, force);
  }
  return force;
}

}  // namespace hybridtest::blind
