#include "validation/blind_batches/plant/foreign_effects.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace hybridtest::blind {
namespace {

/// Largest magnitude so far, fading over seconds.
class RecentAmplitude {
 public:
  explicit RecentAmplitude(double period_s) : fading_{std::exp(-period_s / 1.0)} {}
  [[nodiscard]] double next(double x) { return level_ = std::max(std::abs(x), fading_ * level_); }

 private:
  double fading_;
  double level_ = 0.0;
};

/// Random walk with steps every 10 ms and straight lines between them, standard deviation 1 after 5 s.
class RandomWalk {
 public:
  RandomWalk(std::uint64_t seed, double period_s) : random_{seed, 0, "walk"}, step_{period_s / 0.01} {}
  [[nodiscard]] double next() {
    const double value = from_ + share_ * (to_ - from_);
    share_ += step_;
    if (share_ >= 1.0) {
      share_ -= 1.0;
      from_ = to_;
      to_ += random_.normal() * std::sqrt(0.01 / 5.0);
    }
    return value;
  }

 private:
  RandomStream random_;
  double step_;
  double share_ = 0.0;
  double from_ = 0.0;
  double to_ = 0.0;
};

/// Zero-mean stick-slip: over random distances a force builds up against the motion, then lets go.
ForceTerm stick_slip(const PlantEffect& effect) {
  const double distance_m = effect.of("distance_m");
  return [force_n = effect.of("force_n"), distance_m, random = RandomStream{effect.seed(), 0, "stick_slip"},
          pulled = 0.0, reach = distance_m, past = 0.0](const MotionPoint& at) mutable {
    pulled += at.displacement_m - past;
    past = at.displacement_m;
    if (std::abs(pulled) > reach) {
      pulled = -pulled * random.uniform(0.6, 1.0);
      reach = distance_m * random.uniform(0.4, 1.8);
      pulled = std::clamp(pulled, -reach, reach);
    }
    return force_n * pulled / distance_m;
  };
}

/// Relays that switch up at one place and down at another (Preisach, Z. Phys. 94, 1935), more of
/// them on one side: closed minor loops with memory, and no symmetry.
ForceTerm preisach(const PlantEffect& effect) {
  struct Relay {
    double up = 0.0;
    double down = 0.0;
    double state = -1.0;
  };
  RandomStream random{effect.seed(), 0, "relays"};
  std::array<Relay, 60> relays{};
  for (Relay& relay : relays) {
    const double middle = effect.of("stroke_m") * random.uniform(0.1, 0.9);
    const double half = effect.of("stroke_m") * random.uniform(0.05, 0.5);
    relay.up = middle + half;
    relay.down = middle - half;
  }
  return [force_n = effect.of("force_n"), relays](const MotionPoint& at) mutable {
    double sum = 0.0;
    for (Relay& relay : relays) {
      if (at.displacement_m > relay.up) relay.state = 1.0;
      if (at.displacement_m < relay.down) relay.state = -1.0;
      sum += 1.0 + relay.state;
    }
    return force_n * sum / static_cast<double>(relays.size());
  };
}

/// Lightly damped resonator driven by a history, semi-implicit Euler; its own acceleration-like output.
class Resonance {
 public:
  Resonance(const PlantEffect& effect, double period_s)
      : period_s_{period_s}, w_{kTwoPi * effect.of("frequency_hz")}, damping_ratio_{effect.of("damping_ratio")} {}
  [[nodiscard]] double next(double drive) {
    p_ += period_s_ * (w_ * w_ * (drive - q_) - 2.0 * damping_ratio_ * w_ * p_);
    return q_ += period_s_ * p_;
  }

 private:
  double period_s_;
  double w_;
  double damping_ratio_;
  double q_ = 0.0;
  double p_ = 0.0;
};

/// Force by place and direction alone; empty for other effects.
ForceTerm local_force(const PlantEffect& effect) {
  if (effect.name == "cogging") {
    return [force_n = effect.of("force_n"), turn = kTwoPi / effect.of("pitch_m")](const MotionPoint& at) {
      return force_n * std::sin(turn * at.displacement_m);
    };
  }
  if (effect.name == "snap_through") {
    return [force_n = effect.of("force_n"), middle = effect.of("place_m"),
            pitch = effect.of("pitch_m")](const MotionPoint& at) {
      const double place = (at.displacement_m - middle) / pitch;
      return -force_n * 2.3 * place * std::exp(-place * place);
    };
  }
  if (effect.name == "place_dependent_friction") {  // changes sign with the place, zero on average
    return [force_n = effect.of("force_n"), turn = kTwoPi / (0.7 * effect.of("stroke_m")),
            slow = 0.01 * effect.of("velocity_m_per_s")](const MotionPoint& at) {
      return force_n * std::tanh(at.velocity_m_per_s / slow) * std::sin(turn * at.displacement_m);
    };
  }
  return {};
}

}  // namespace

std::function<double(double)> foreign_motion(const PlantEffect& effect, double period_s) {
  if (effect.name == "amplitude_dependent_delay") {
    // Held up by as much as the recent amplitude asks for, out of a ring that holds twice the largest delay.
    const double delay_steps = effect.of("delay_s") / period_s;
    const History ring(static_cast<std::size_t>(4.0 * delay_steps) + 2);
    return [delay_steps, stroke_m = effect.of("stroke_m"), amplitude = RecentAmplitude{period_s}, past = ring,
            count = std::size_t{0}](double x) mutable {
      const std::size_t size = past.size();
      past[count++ % size] = x;
      const double share = std::min(1.5, amplitude.next(x) / stroke_m);
      const double steps = std::min(2.0 * delay_steps * share, static_cast<double>(std::min(count, size) - 1));
      const auto whole = static_cast<std::size_t>(steps);
      const double later = past[(count - 1 + size - whole) % size];
      const double earlier = past[(count - 1 + size - std::min(whole + 1, std::min(count, size) - 1)) % size];
      return later + (steps - static_cast<double>(whole)) * (earlier - later);
    };
  }
  if (effect.name == "limit_cycle") {
    // The loop hunts while the actuator moves: van der Pol's oscillator beside the motion.
    return
        [w = kTwoPi * effect.of("frequency_hz"), period_s, amplitude_m = effect.of("amplitude_m"),
         stroke_m = effect.of("stroke_m"), amplitude = RecentAmplitude{period_s}, q = 0.1, p = 0.0](double x) mutable {
          p += period_s * (0.4 * w * (1.0 - q * q) * p - w * w * q);
          q += period_s * p;
          return x + amplitude_m * 0.5 * q * std::min(1.0, 4.0 * amplitude.next(x) / stroke_m);
        };
  }
  if (effect.name == "frame_resonance") {
    return [share = effect.of("share"), frame = Resonance{effect, period_s}](double x) mutable {
      return x + share * (frame.next(x) - x);
    };
  }
  if (effect.name == "pump_ripple") {
    return [turn = kTwoPi * period_s * effect.of("frequency_hz"),
            share = effect.of("amplitude_m") / effect.of("stroke_m"), random = RandomStream{effect.seed(), 0, "ripple"},
            amplitude = RecentAmplitude{period_s}, phase = 0.0](double x) mutable {
      phase += turn + 0.02 * random.normal();
      return x + share * std::sin(phase) * amplitude.next(x);
    };
  }
  return {};
}

ForceTerm foreign_force(const PlantEffect& effect, double period_s) {
  if (effect.name == "random_stick_slip") return stick_slip(effect);
  if (effect.name == "magnetic_memory") return preisach(effect);
  if (effect.name == "self_excitation") {
    return [force_n = effect.of("force_n"), v = effect.of("velocity_m_per_s")](const MotionPoint& at) {
      const double u = at.velocity_m_per_s / v;
      return force_n * 4.0 * (std::pow(std::clamp(u, -1.5, 1.5), 3) - 0.35 * u);
    };
  }
  if (effect.name == "thermal_stiffness") {
    return [stiffness = effect.of("force_n") / effect.of("stroke_m"), walk = RandomWalk{effect.seed(), period_s}](
               const MotionPoint& at) mutable { return stiffness * at.displacement_m * walk.next(); };
  }
  return local_force(effect);
}

std::function<double(const MotionPoint&, double)> foreign_reading(const PlantEffect& effect, double period_s) {
  if (effect.name == "gain_walk") {
    return [share = effect.of("share"), walk = RandomWalk{effect.seed(), period_s}](
               const MotionPoint& /*at*/, double value) mutable { return value * (1.0 + share * walk.next()); };
  }
  if (effect.name == "acceleration_crosstalk") {
    return
        [mass = effect.of("mass_kg"), cell = Resonance{effect, period_s}](const MotionPoint& at, double value) mutable {
          return value + mass * cell.next(at.acceleration_m_per_s2);
        };
  }
  return {};
}

}  // namespace hybridtest::blind
