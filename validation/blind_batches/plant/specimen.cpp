#include "validation/blind_batches/plant/specimen.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "validation/blind_batches/plant/foreign_effects.hpp"

namespace hybridtest::blind {

namespace {

/// An elastic-plastic spring (the plastic slip is the state) beside an elastic one.
History bilinear(const LawModel& law, const History& x, const History& yield_share) {
  const double plastic_stiffness = (1.0 - law.hardening_ratio) * law.stiffness_n_per_m;
  History force(x.size());
  double slip = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double share = yield_share.empty() ? 1.0 : yield_share[i];
    const double reach = share * law.yield_force_n / law.stiffness_n_per_m;
    slip = std::clamp(slip, x[i] - reach, x[i] + reach);
    force[i] = plastic_stiffness * (x[i] - slip) + law.hardening_ratio * law.stiffness_n_per_m * x[i];
  }
  return force;
}

/// z' = x' (ao - (gamma + beta sign(z x')) |z|) along a stretch in one direction; turned so that
/// the direction is positive: z' = ao - s z for z > 0, ao - (beta - gamma) z for z < 0.
double bouc_wen_along(const LawModel& law, double z, double path) {
  const double closing = law.beta_per_m - law.gamma_per_m;
  if (z < 0.0) {
    const double to_zero = std::abs(closing * z) < 1e-9 ? -z : std::log1p(-closing * z) / closing;
    if (path <= to_zero) {
      return std::abs(closing) < 1e-9 ? z + path : (z - 1.0 / closing) * std::exp(-closing * path) + 1.0 / closing;
    }
    path -= to_zero;
    z = 0.0;
  }
  const double opening = law.beta_per_m + law.gamma_per_m;
  return (z - 1.0 / opening) * std::exp(-opening * path) + 1.0 / opening;
}

History bouc_wen(const LawModel& law, const History& x) {
  History force(x.size());
  double z = 0.0;
  double previous = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double direction = x[i] < previous ? -1.0 : 1.0;
    z = direction * bouc_wen_along(law, direction * z, std::abs(x[i] - previous));
    previous = x[i];
    force[i] = law.stiffness_n_per_m * (law.alpha * x[i] + (1.0 - law.alpha) * z);
  }
  return force;
}

/// State of a Giuffre-Menegotto-Pinto spring between two reversals.
struct Curve {
  double from_x = 0.0;
  double from_f = 0.0;
  double corner_x = 0.0;
  double r = 1.0;
};

class SteelSpring {
 public:
  explicit SteelSpring(const LawModel& law)
      : law_{law}, yield_m_{law.yield_force_n / law.stiffness_n_per_m}, extreme_{-yield_m_, yield_m_} {}

  double force(double x) {
    const int heading = x > x_ ? 1 : x < x_ ? -1 : heading_;
    if (heading != heading_) turn(heading);
    x_ = x;
    f_ = on_curve(x);
    return f_;
  }

 private:
  void turn(int heading) {
    heading_ = heading;
    extreme_[0] = std::min(extreme_[0], x_);
    extreme_[1] = std::max(extreme_[1], x_);
    const double b = law_.hardening_ratio;
    curve_.from_x = x_;
    curve_.from_f = f_;
    // Elastic line from here: f + k (c - x); asymptote: b k c +- (1 - b) Fy.
    curve_.corner_x = (law_.stiffness_n_per_m * x_ - f_ + heading * (1.0 - b) * law_.yield_force_n) /
                      ((1.0 - b) * law_.stiffness_n_per_m);
    const double xi = std::abs(extreme_[heading > 0 ? 1 : 0] - curve_.corner_x) / yield_m_;
    curve_.r = law_.r0 * (1.0 - law_.cr1 * xi / (law_.cr2 + xi));
  }

  [[nodiscard]] double on_curve(double x) const {
    const double along = x - curve_.from_x;
    if (along == 0.0) return curve_.from_f;
    const double reach = curve_.corner_x - curve_.from_x;
    if (reach == 0.0) return curve_.from_f + law_.hardening_ratio * law_.stiffness_n_per_m * along;
    // log of (1 + q^R)^(1/R) without overflow.
    const double q = std::log(std::abs(along / reach));
    const double rounding = std::exp(std::max(0.0, q) + std::log1p(std::exp(-curve_.r * std::abs(q))) / curve_.r);
    return curve_.from_f +
           law_.stiffness_n_per_m * along * (law_.hardening_ratio + (1.0 - law_.hardening_ratio) / rounding);
  }

  LawModel law_;
  double yield_m_;
  double extreme_[2];
  Curve curve_;
  int heading_ = 0;
  double x_ = 0.0;
  double f_ = 0.0;
};

History steel(const LawModel& law, const History& x) {
  SteelSpring spring{law};
  History force(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) force[i] = spring.force(x[i]);
  return force;
}

}  // namespace

History law_force(const LawModel& law, const History& displacement_m, const History& yield_share) {
  switch (law.kind) {
    case LawKind::none: break;
    case LawKind::elastic: {
      History force(displacement_m.size(), 0.0);
      add(force, displacement_m, law.stiffness_n_per_m);
      return force;
    }
    case LawKind::bilinear: return bilinear(law, displacement_m, yield_share);
    case LawKind::giuffre_menegotto_pinto: return steel(law, displacement_m);
    case LawKind::bouc_wen: return bouc_wen(law, displacement_m);
  }
  return History(displacement_m.size(), 0.0);
}

namespace {

constexpr std::size_t kElements = 40;

}  // namespace

History bristle_friction(const FrictionParameters& friction, const MotionHistory& motion) {
  const double bristle_stiffness = friction.force_n / friction.presliding_m;
  History force(motion.size());
  double deflection = 0.0;
  for (std::size_t i = 1; i < motion.size(); ++i) {
    // The step's own path: also right where the displacement jumps.
    const double path = motion.displacement_m[i] - motion.displacement_m[i - 1];
    const double velocity = path / motion.period_s;
    const double sliding = path < 0.0 ? friction.force_backward_n : friction.force_n;
    const double fading = velocity / friction.stribeck_m_per_s;
    const double slip =
        (sliding + (friction.breakaway_n - friction.force_n) * std::exp(-fading * fading)) / bristle_stiffness;
    const double limit = path < 0.0 ? -slip : slip;
    deflection = limit + (deflection - limit) * std::exp(-std::abs(path) / slip);
    force[i] = bristle_stiffness * deflection;
  }
  return force;
}

History iwan_stack(const StackParameters& stack, const History& displacement_m) {
  const double yield_m = stack.yield_force_n / stack.stiffness_n_per_m;
  const double element_stiffness =
      (1.0 - stack.hardening_ratio) * stack.stiffness_n_per_m / static_cast<double>(kElements);
  std::array<double, kElements> reach{};
  for (std::size_t e = 0; e < kElements; ++e) {
    const double place = (2.0 * static_cast<double>(e) + 1.0) / static_cast<double>(kElements) - 1.0;
    reach[e] = yield_m * (1.0 + stack.spread * place);
  }
  std::array<double, kElements> slip{};
  History force(displacement_m.size());
  for (std::size_t i = 0; i < displacement_m.size(); ++i) {
    const double x = displacement_m[i];
    double sum = 0.0;
    for (std::size_t e = 0; e < kElements; ++e) {
      slip[e] = std::clamp(slip[e], x - reach[e], x + reach[e]);
      sum += x - slip[e];
    }
    force[i] = element_stiffness * sum + stack.hardening_ratio * stack.stiffness_n_per_m * x;
  }
  return force;
}

namespace {

/// Path length, in m.
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

/// Factor that reduces the force of the spring with time or with place.
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
