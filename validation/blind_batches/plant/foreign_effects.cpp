#include "validation/blind_batches/plant/foreign_effects.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "validation/blind_batches/plant/plant.hpp"

namespace hybridtest::blind {
namespace {

/// Largest magnitude so far, fading over seconds.
History recent_amplitude(const History& x, double period_s) {
  const double fading = std::exp(-period_s / 1.0);
  History amplitude(x.size());
  double level = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    level = std::max(std::abs(x[i]), fading * level);
    amplitude[i] = level;
  }
  return amplitude;
}

/// Random walk with steps every 10 ms and straight lines between them, standard deviation 1 after 5 s.
History random_walk(std::size_t size, double period_s, double seed) {
  RandomStream random{static_cast<std::uint64_t>(seed), 0, "walk"};
  const auto hold = static_cast<std::size_t>(0.01 / period_s);
  History points(size / hold + 2, 0.0);
  for (std::size_t i = 1; i < points.size(); ++i) points[i] = points[i - 1] + random.normal() * std::sqrt(0.01 / 5.0);
  History walk(size);
  for (std::size_t i = 0; i < size; ++i) {
    walk[i] = value_at(points, static_cast<double>(i) / static_cast<double>(hold));
  }
  return walk;
}

/// c D^alpha x as a ladder of Maxwell elements, three to a decade (after Oustaloup et al., 2000).
void add_fractional(const PlantEffect& effect, const MotionHistory& motion, History& force) {
  const double alpha = effect.of("order");
  const double per_step = std::pow(10.0, 1.0 / 3.0);
  double rate = 0.01 * kTwoPi;
  for (int element = 0; element < 14; ++element, rate *= per_step) {
    const double stiffness = effect.of("force_n") / effect.of("stroke_m") * std::pow(rate / kTwoPi, alpha) * 0.5;
    const double following = 1.0 - std::exp(-motion.period_s * rate);
    double q = 0.0;
    for (std::size_t i = 0; i < motion.size(); ++i) {
      q += following * (motion.displacement_m[i] - q);
      force[i] += stiffness * (motion.displacement_m[i] - q);
    }
  }
}

/// Zero-mean stick-slip: over random distances a force builds up against the motion, then lets go.
void add_stick_slip(const PlantEffect& effect, const MotionHistory& motion, History& force) {
  RandomStream random{static_cast<std::uint64_t>(effect.of("seed")), 0, "stick_slip"};
  double pulled = 0.0;
  double reach = effect.of("distance_m");
  for (std::size_t i = 1; i < motion.size(); ++i) {
    pulled += motion.displacement_m[i] - motion.displacement_m[i - 1];
    if (std::abs(pulled) > reach) {
      pulled = -pulled * random.uniform(0.6, 1.0);
      reach = effect.of("distance_m") * random.uniform(0.4, 1.8);
      pulled = std::clamp(pulled, -reach, reach);
    }
    force[i] += effect.of("force_n") * pulled / effect.of("distance_m");
  }
}

/// Relays that switch up at one place and down at another (Preisach, Z. Phys. 94, 1935), more of
/// them on one side: closed minor loops with memory, and no symmetry.
void add_preisach(const PlantEffect& effect, const MotionHistory& motion, History& force) {
  constexpr std::size_t kRelays = 60;
  RandomStream random{static_cast<std::uint64_t>(effect.of("seed")), 0, "relays"};
  std::array<double, kRelays> up{};
  std::array<double, kRelays> down{};
  std::array<double, kRelays> state{};
  for (std::size_t r = 0; r < kRelays; ++r) {
    const double middle = effect.of("stroke_m") * random.uniform(0.1, 0.9);
    const double half = effect.of("stroke_m") * random.uniform(0.05, 0.5);
    up[r] = middle + half;
    down[r] = middle - half;
    state[r] = -1.0;
  }
  for (std::size_t i = 0; i < motion.size(); ++i) {
    double sum = 0.0;
    for (std::size_t r = 0; r < kRelays; ++r) {
      if (motion.displacement_m[i] > up[r]) state[r] = 1.0;
      if (motion.displacement_m[i] < down[r]) state[r] = -1.0;
      sum += 1.0 + state[r];
    }
    force[i] += effect.of("force_n") * sum / static_cast<double>(kRelays);
  }
}

/// Lightly damped resonator driven by a history, semi-implicit Euler; its own acceleration-like output.
History resonance(const History& drive, double period_s, double frequency_hz, double damping_ratio) {
  const double w = kTwoPi * frequency_hz;
  History response(drive.size());
  double q = 0.0;
  double p = 0.0;
  for (std::size_t i = 0; i < drive.size(); ++i) {
    p += period_s * (w * w * (drive[i] - q) - 2.0 * damping_ratio * w * p);
    q += period_s * p;
    response[i] = q;
  }
  return response;
}

/// Force by place and direction alone.
double local_force(const PlantEffect& effect, double x, double v) {
  const double amount = effect.of("force_n");
  const double stroke = effect.of("stroke_m");
  if (effect.name == "cogging") return amount * std::sin(kTwoPi * x / effect.of("pitch_m"));
  if (effect.name == "snap_through") {
    const double place = (x - effect.of("place_m")) / effect.of("pitch_m");
    return -amount * 2.3 * place * std::exp(-place * place);
  }
  // Friction that changes sign with the place, zero on average.
  const double way = std::tanh(v / (0.01 * effect.of("velocity_m_per_s")));
  return amount * way * std::sin(kTwoPi * x / (0.7 * stroke));
}

void add_self_excitation(const PlantEffect& effect, const MotionHistory& motion, History& force) {
  for (std::size_t i = 0; i < motion.size(); ++i) {
    const double u = motion.velocity_m_per_s[i] / effect.of("velocity_m_per_s");
    force[i] += effect.of("force_n") * 4.0 * (std::pow(u, 3) - 0.35 * u);
  }
}

}  // namespace

void apply_foreign_to_actuator(const PlantEffect& effect, double period_s, History& displacement_m) {
  const History x = displacement_m;
  const History amplitude = recent_amplitude(x, period_s);
  if (effect.name == "amplitude_dependent_delay") {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double share = amplitude[i] / effect.of("stroke_m");
      const double delay_s = effect.of("delay_s") * (share - 0.45) * 3.0;
      displacement_m[i] = value_at(x, static_cast<double>(i) - delay_s / period_s);
    }
  } else if (effect.name == "limit_cycle") {
    // The loop hunts while the actuator moves: van der Pol's oscillator beside the motion.
    const double w = kTwoPi * effect.of("frequency_hz");
    double q = 0.1;
    double p = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      p += period_s * (0.4 * w * (1.0 - q * q) * p - w * w * q);
      q += period_s * p;
      displacement_m[i] +=
          effect.of("amplitude_m") * 0.5 * q * std::min(1.0, 4.0 * amplitude[i] / effect.of("stroke_m"));
    }
  } else if (effect.name == "frame_resonance") {
    const History response = resonance(x, period_s, effect.of("frequency_hz"), effect.of("damping_ratio"));
    const History lead = difference(response, x);
    add(displacement_m, lead, effect.of("share"));
  } else if (effect.name == "pump_ripple") {
    RandomStream random{static_cast<std::uint64_t>(effect.of("seed")), 0, "ripple"};
    double phase = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      phase += kTwoPi * period_s * effect.of("frequency_hz") + 0.02 * random.normal();
      displacement_m[i] += effect.of("amplitude_m") * std::sin(phase) * amplitude[i] / effect.of("stroke_m");
    }
  }
}

void add_foreign_force(const PlantEffect& effect, const Site& site, const MotionHistory& motion, History& force_n) {
  if (effect.name == "fractional_damping") add_fractional(effect, motion, force_n);
  if (effect.name == "random_stick_slip") add_stick_slip(effect, motion, force_n);
  if (effect.name == "magnetic_memory") add_preisach(effect, motion, force_n);
  if (effect.name == "self_excitation") add_self_excitation(effect, motion, force_n);
  if (effect.name == "cogging" || effect.name == "snap_through" || effect.name == "place_dependent_friction") {
    for (std::size_t i = 0; i < motion.size(); ++i) {
      force_n[i] += local_force(effect, motion.displacement_m[i], motion.velocity_m_per_s[i]);
    }
  }
  if (effect.name == "thermal_stiffness") {
    const History walk = random_walk(motion.size(), motion.period_s, effect.of("seed"));
    for (std::size_t i = 0; i < motion.size(); ++i) {
      force_n[i] += effect.of("force_n") / effect.of("stroke_m") * motion.displacement_m[i] * walk[i];
    }
  }
  if (effect.name == "echo") {
    add(force_n, delayed(force_n, effect.of("delay_s") * site.rate_hz * static_cast<double>(kFineSteps)),
        effect.of("share"));
  }
}

void read_with_foreign(const PlantEffect& effect, const MotionHistory& motion, History& read) {
  if (effect.name == "gain_walk") {
    const History walk = random_walk(read.size(), motion.period_s, effect.of("seed"));
    for (std::size_t i = 0; i < read.size(); ++i) read[i] *= 1.0 + effect.of("share") * walk[i];
  } else if (effect.name == "acceleration_crosstalk") {
    add(read,
        resonance(motion.acceleration_m_per_s2, motion.period_s, effect.of("frequency_hz"), effect.of("damping_ratio")),
        effect.of("mass_kg"));
  }
}

}  // namespace hybridtest::blind
