#include "validation/blind_batches/plant/specimen.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "validation/blind_batches/plant/foreign_effects.hpp"
#include "validation/blind_batches/plant/foreign_laws.hpp"

namespace hybridtest::blind {

BaseLaw::BaseLaw(const LawModel& law) : law_{law} {
  if (law.stiffness_n_per_m <= 0.0) return;
  extreme_[1] = law.yield_force_n / law.stiffness_n_per_m;
  extreme_[0] = -extreme_[1];
}

double BaseLaw::force(double x, double yield_share) {
  switch (law_.kind) {
    case LawKind::none: return 0.0;
    case LawKind::elastic: return law_.stiffness_n_per_m * x;
    case LawKind::bilinear: return bilinear(x, yield_share);
    case LawKind::giuffre_menegotto_pinto: return steel(x);
    case LawKind::bouc_wen: return bouc_wen(x);
  }
  return 0.0;
}

/// An elastic-plastic spring (the plastic slip is the state) beside an elastic one.
double BaseLaw::bilinear(double x, double yield_share) {
  const double reach = yield_share * law_.yield_force_n / law_.stiffness_n_per_m;
  memory_ = std::clamp(memory_, x - reach, x + reach);
  return law_.stiffness_n_per_m * ((1.0 - law_.hardening_ratio) * (x - memory_) + law_.hardening_ratio * x);
}

namespace {

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

}  // namespace

double BaseLaw::bouc_wen(double x) {
  const double direction = x < x_ ? -1.0 : 1.0;
  memory_ = direction * bouc_wen_along(law_, direction * memory_, std::abs(x - x_));
  x_ = x;
  return law_.stiffness_n_per_m * (law_.alpha * x + (1.0 - law_.alpha) * memory_);
}

double BaseLaw::steel(double x) {
  const int heading = x > x_ ? 1 : x < x_ ? -1 : heading_;
  if (heading == 0) return f_;
  if (heading != heading_) turn_steel(heading);
  x_ = x;
  const double along = x - from_x_;
  const double reach = corner_x_ - from_x_;
  const double b = law_.hardening_ratio;
  if (along == 0.0) {
    f_ = from_f_;
  } else if (reach == 0.0) {
    f_ = from_f_ + b * law_.stiffness_n_per_m * along;
  } else {
    // log of (1 + q^R)^(1/R) without overflow.
    const double q = std::log(std::abs(along / reach));
    const double rounding = std::exp(std::max(0.0, q) + std::log1p(std::exp(-sharpness_ * std::abs(q))) / sharpness_);
    f_ = from_f_ + law_.stiffness_n_per_m * along * (b + (1.0 - b) / rounding);
  }
  return f_;
}

void BaseLaw::turn_steel(int heading) {
  heading_ = heading;
  extreme_[0] = std::min(extreme_[0], x_);
  extreme_[1] = std::max(extreme_[1], x_);
  const double b = law_.hardening_ratio;
  from_x_ = x_;
  from_f_ = f_;
  // Elastic line from here: f + k (c - x); asymptote: b k c +- (1 - b) Fy.
  corner_x_ = (law_.stiffness_n_per_m * x_ - f_ + heading * (1.0 - b) * law_.yield_force_n) /
              ((1.0 - b) * law_.stiffness_n_per_m);
  const double yield_m = law_.yield_force_n / law_.stiffness_n_per_m;
  const double xi = std::abs(extreme_[heading > 0 ? 1 : 0] - corner_x_) / yield_m;
  sharpness_ = law_.r0 * (1.0 - law_.cr1 * xi / (law_.cr2 + xi));
}

History law_force(const LawModel& law, const History& displacement_m) {
  BaseLaw spring{law};
  History force(displacement_m.size());
  std::ranges::transform(displacement_m, force.begin(), [&](double x) { return spring.force(x); });
  return force;
}

double Bristles::force(double x) {
  const double bristle_stiffness = friction_.force_n / friction_.presliding_m;
  // The step's own path: also right where the displacement jumps.
  const double path = std::exchange(has_moved_, true) ? x - x_ : 0.0;
  x_ = x;
  if (path == 0.0) return bristle_stiffness * deflection_;
  const double sliding = path < 0.0 ? friction_.force_backward_n : friction_.force_n;
  const double fading = path / period_s_ / friction_.stribeck_m_per_s;
  const double slip =
      (sliding + (friction_.breakaway_n - friction_.force_n) * std::exp(-fading * fading)) / bristle_stiffness;
  const double limit = path < 0.0 ? -slip : slip;
  deflection_ = limit + (deflection_ - limit) * std::exp(-std::abs(path) / slip);
  return bristle_stiffness * deflection_;
}

History bristle_friction(const FrictionParameters& friction, const MotionHistory& motion) {
  Bristles bristles{friction, motion.period_s};
  History force(motion.size());
  for (std::size_t i = 0; i < force.size(); ++i) force[i] = bristles.force(motion.displacement_m[i]);
  return force;
}

namespace {

/// Evenly spread over -1 … 1.
double place_of(std::size_t element, std::size_t count) {
  return (2.0 * static_cast<double>(element) + 1.0) / static_cast<double>(count) - 1.0;
}

}  // namespace

IwanStack::IwanStack(const StackParameters& stack) : stack_{stack} {
  const double yield_m = stack.yield_force_n / stack.stiffness_n_per_m;
  for (std::size_t e = 0; e < kElements; ++e) reach_[e] = yield_m * (1.0 + stack.spread * place_of(e, kElements));
}

double IwanStack::force(double x, double stiffness_share, double strength_share) {
  const double reach_share = strength_share / stiffness_share;
  double sum = 0.0;
  for (std::size_t e = 0; e < kElements; ++e) {
    slip_[e] = std::clamp(slip_[e], x - reach_share * reach_[e], x + reach_share * reach_[e]);
    sum += x - slip_[e];
  }
  const double k = stack_.stiffness_n_per_m * stiffness_share;
  return k * ((1.0 - stack_.hardening_ratio) * sum / static_cast<double>(kElements) + stack_.hardening_ratio * x);
}

History iwan_stack(const StackParameters& stack, const History& displacement_m) {
  IwanStack elements{stack};
  History force(displacement_m.size());
  std::ranges::transform(displacement_m, force.begin(), [&](double x) { return elements.force(x); });
  return force;
}

MovingSlot::MovingSlot(double width_m, double spread) {
  for (std::size_t s = 0; s < kSlots; ++s) half_width_m_[s] = 0.5 * width_m * (1.0 + spread * place_of(s, kSlots));
}

double MovingSlot::next(double x) {
  double sum = 0.0;
  for (std::size_t s = 0; s < kSlots; ++s) {
    pin_m_[s] = std::max(std::min(pin_m_[s], x + half_width_m_[s]), x - half_width_m_[s]);
    sum += pin_m_[s];
  }
  return sum / static_cast<double>(kSlots);
}

namespace {

/// A pin in a slot about the origin, with rubber on its edges.
double in_fixed_slot(double x, double clearance_m) {
  const double rubber_m = 0.05 * clearance_m;
  return rounded_ramp(x - clearance_m, rubber_m) - rounded_ramp(-x - clearance_m, rubber_m);
}

/// exp(-rate × path travelled).
std::function<double(double)> fading_with_path(double rate_per_m) {
  return [rate_per_m, path = 0.0, past = 0.0, has_moved = false](double x) mutable {
    if (std::exchange(has_moved, true)) path += std::abs(x - past);
    past = x;
    return std::exp(-rate_per_m * path);
  };
}

/// The spring, with what changes the spring itself.
ForceTerm spring_of(const Site& site, const PlantEffects& effects) {
  LawModel law = site.specimen;
  double clearance_m = 0.0;
  const PlantEffect* yielding = nullptr;
  std::function<double(double)> strength;
  for (const PlantEffect& effect : effects) {
    if (effect.interface != "specimen") continue;
    if (effect.name == "gap") clearance_m = effect.of("clearance_m");
    if (effect.name == "stiffness_error") law.stiffness_n_per_m *= effect.of("stiffness_ratio");
    if (effect.name == "strength_error") law.yield_force_n *= effect.of("strength_ratio");
    if (effect.name == "yielding") yielding = &effect;
    if (effect.name == "strength_degradation") strength = fading_with_path(effect.of("degradation_per_m"));
    if (effect.name == "hysteresis_law") return foreign_law(effect);
  }
  const auto behind_gap = [clearance_m](double x) { return clearance_m > 0.0 ? in_fixed_slot(x, clearance_m) : x; };
  if (yielding != nullptr) {
    return [behind_gap, stack = IwanStack{{law.stiffness_n_per_m, yielding->of("yield_force_n"),
                                           yielding->of("hardening_ratio"), yielding->of("spread")}}](
               const MotionPoint& at) mutable { return stack.force(behind_gap(at.displacement_m)); };
  }
  return [behind_gap, strength, spring = BaseLaw{law}](const MotionPoint& at) mutable {
    const double x = behind_gap(at.displacement_m);
    return spring.force(x, strength ? strength(x) : 1.0);
  };
}

/// Spring and dashpot in series, q' = (x - q) / tau, exact for constant x over a step; two of them, with time
/// constants a quarter below and a third above.
ForceTerm relaxation(const PlantEffect& effect, double period_s) {
  const double fast = 1.0 - std::exp(-period_s / (0.75 * effect.of("time_constant_s")));
  const double slow = 1.0 - std::exp(-period_s * 0.75 / effect.of("time_constant_s"));
  return [fast, slow, half = 0.5 * effect.of("stiffness_n_per_m"), q = 0.0, r = 0.0](const MotionPoint& at) mutable {
    q += fast * (at.displacement_m - q);
    r += slow * (at.displacement_m - r);
    return half * (2.0 * at.displacement_m - q - r);
  };
}

/// c D^alpha x as a ladder of Maxwell elements, three to a decade from 0.01 to 200 Hz (after Oustaloup et al., 2000).
ForceTerm fractional(const PlantEffect& effect, double period_s) {
  constexpr std::size_t kElements = 14;
  std::array<double, kElements> stiffness{};
  std::array<double, kElements> following{};
  double rate = 0.01 * kTwoPi;
  for (std::size_t e = 0; e < kElements; ++e, rate *= std::pow(10.0, 1.0 / 3.0)) {
    stiffness[e] = effect.of("force_n") / effect.of("stroke_m") * std::pow(rate / kTwoPi, effect.of("order")) * 0.5;
    following[e] = 1.0 - std::exp(-period_s * rate);
  }
  return [stiffness, following, q = std::array<double, kElements>{}](const MotionPoint& at) mutable {
    double force = 0.0;
    for (std::size_t e = 0; e < kElements; ++e) {
      q[e] += following[e] * (at.displacement_m - q[e]);
      force += stiffness[e] * (at.displacement_m - q[e]);
    }
    return force;
  };
}

ForceTerm friction(const PlantEffect& effect, double period_s) {
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
  return [bristles = Bristles{friction, period_s}](const MotionPoint& at) mutable {
    return bristles.force(at.displacement_m);
  };
}

/// A factor of the spring's force that follows path, place or time; empty for an effect that is none.
ForceTerm share_of(const PlantEffect& effect) {
  const std::string_view name = effect.name;
  if (name == "stiffness_degradation") {
    return [fading = fading_with_path(effect.of("degradation_per_m"))](const MotionPoint& at) mutable {
      return fading(at.displacement_m);
    };
  }
  if (name == "stiffness_degradation_with_peak" || name == "stiffness_degradation_with_time") {
    return
        [fading = Fading{name.ends_with("peak") ? "peak" : "time", effect.of("scale")}](const MotionPoint& at) mutable {
          fading.after(at, 0.0);
          return fading.left();
        };
  }
  if (name == "pinching") {
    return [ratio = effect.of("pinching_ratio"), width = effect.of("width_m")](const MotionPoint& at) {
      const double place = at.displacement_m / width;
      return 1.0 - ratio / (1.0 + std::pow(place, 4));
    };
  }
  if (name == "fracture") {  // tears within some hundredths of a second
    return [ratio = effect.of("lost_ratio"), instant = effect.of("time_s")](const MotionPoint& at) {
      return 1.0 - ratio * 0.5 * (1.0 + std::tanh((at.time_s - instant) / 0.02));
    };
  }
  return {};
}

/// Forces beside the spring that follow from the motion at the same instant; empty for an effect that is none.
ForceTerm instantaneous(const PlantEffect& effect) {
  const std::string_view name = effect.name;
  if (name == "viscous_damping") {
    return [c = effect.of("damping_n_s_per_m")](const MotionPoint& at) { return c * at.velocity_m_per_s; };
  }
  if (name == "quadratic_damping") {  // an orifice that opens a little: 4 % less at its reference velocity
    return [c = effect.of("damping_n_s2_per_m2"), v0 = 5.0 * effect.of("velocity_m_per_s")](const MotionPoint& at) {
      const double v = at.velocity_m_per_s;
      return c * v * std::abs(v) / (1.0 + (v / v0) * (v / v0));
    };
  }
  if (name == "cubic_stiffness") {  // a cable, whose hardening ends when it is straight
    return [k = effect.of("stiffness_n_per_m3"), length = 4.0 * effect.of("stroke_m")](const MotionPoint& at) {
      const double x = at.displacement_m;
      return k * x * x * x / (1.0 + (x / length) * (x / length));
    };
  }
  if (name == "contact") {
    return [k = effect.of("stiffness_n_per_m"), place = effect.of("distance_m"),
            rubber_m = 0.02 * effect.of("stroke_m")](const MotionPoint& at) {
      return k * (rounded_ramp(at.displacement_m - place, rubber_m) - rounded_ramp(-place, rubber_m));
    };
  }
  if (name == "inertia") {
    return [mass = effect.of("mass_kg")](const MotionPoint& at) { return mass * at.acceleration_m_per_s2; };
  }
  if (name == "geometric_stiffness") {  // a column that leans as a pendulum
    return [load = effect.of("load_n"), length = effect.of("length_m")](const MotionPoint& at) {
      const double x = at.displacement_m;
      return -load * x / std::sqrt(length * length - x * x);
    };
  }
  return {};
}

/// Prandtl's stack of elements whose slips lie ever further apart: a loop that rounds like Bouc and Wen's.
ForceTerm rounded_loop(const PlantEffect& effect) {
  const double force_n = effect.of("force_n");
  const double yield_m = effect.of("yield_displacement_m");
  const StackParameters early{0.6 * force_n / yield_m, 0.35 * force_n, 0.0, 0.9};
  const StackParameters late{0.4 * force_n / yield_m, 0.65 * force_n, 0.0, 0.9};
  return [narrow = IwanStack{early}, wide = IwanStack{late}](const MotionPoint& at) mutable {
    return narrow.force(at.displacement_m) + wide.force(at.displacement_m);
  };
}

}  // namespace

SpecimenStage::SpecimenStage(const Site& site, const PlantEffects& effects, double period_s)
    : known_mass_kg_{site.known_mass_kg},
      known_damping_n_s_per_m_{site.known_damping_n_s_per_m},
      behind_play_{period_s},
      spring_{spring_of(site, effects)} {
  for (const PlantEffect& effect : effects) {
    if (effect.interface == "specimen") add_effect(effect, period_s);
  }
}

void SpecimenStage::add_effect(const PlantEffect& effect, double period_s) {
  const std::string_view name = effect.name;
  if (name == "backlash") play_.emplace_back(effect.of("width_m"), 0.1);
  if (name == "relaxation") terms_.push_back(relaxation(effect, period_s));
  if (name == "fractional_damping") terms_.push_back(fractional(effect, period_s));
  if (name == "coulomb_friction" || name == "stribeck_friction") terms_.push_back(friction(effect, period_s));
  if (name == "bouc_wen_hysteresis") terms_.push_back(rounded_loop(effect));
  if (name == "echo") {
    echoes_.emplace_back([share = effect.of("share"), line = DelayLine{effect.of("delay_s") / period_s}](
                             double force) mutable { return share * line.next(force); });
  }
  if (ForceTerm share = share_of(effect)) shares_.push_back(std::move(share));
  if (ForceTerm term = instantaneous(effect)) terms_.push_back(std::move(term));
  if (ForceTerm term = foreign_force(effect, period_s)) terms_.push_back(std::move(term));
}

double SpecimenStage::force(const MotionPoint& motion) {
  MotionPoint engaged = motion;  // of the specimen behind the play of its pin
  for (MovingSlot& slot : play_) engaged = behind_play_.next(slot.next(engaged.displacement_m));
  engaged.time_s = motion.time_s;
  double force = spring_(engaged);
  for (const ForceTerm& share : shares_) force *= share(motion);
  force += known_damping_n_s_per_m_ * engaged.velocity_m_per_s + known_mass_kg_ * motion.acceleration_m_per_s2;
  for (const ForceTerm& term : terms_) force += term(motion);
  for (const auto& echo : echoes_) force += echo(force);
  return force;
}

History specimen_force(const Site& site, const PlantEffects& effects, const MotionHistory& motion) {
  SpecimenStage specimen{site, effects, motion.period_s};
  History force(motion.size());
  for (std::size_t i = 0; i < force.size(); ++i) force[i] = specimen.force(motion.at(i));
  return force;
}

}  // namespace hybridtest::blind
