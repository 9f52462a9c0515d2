#include "validation/blind_batches/plant/signal_chain.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "validation/blind_batches/plant/foreign_effects.hpp"
#include "validation/blind_batches/plant/plant.hpp"

namespace hybridtest::blind {

namespace {

/// When the packet of each step arrives, in samples after it was sent; infinite when lost.
History travel_samples(const Site& site, const PlantEffects& effects, std::size_t count) {
  History travel(count, 0.0);
  for (const PlantEffect& effect : effects) {
    if (effect.interface != "network") continue;
    if (effect.name == "latency") {
      for (double& t : travel) t += effect.of("delay_s") * site.rate_hz;
    } else if (effect.name == "jitter") {
      RandomStream random{static_cast<std::uint64_t>(effect.of("seed")), count, "jitter"};
      for (double& t : travel) t += -std::log(1.0 - random.uniform(0.0, 1.0)) * effect.of("jitter_s") * site.rate_hz;
    } else if (effect.name == "loss") {
      RandomStream random{static_cast<std::uint64_t>(effect.of("seed")), count, "loss"};
      for (double& t : travel) t += random.chance(effect.of("loss_ratio")) ? HUGE_VAL : 0.0;
    } else if (effect.name == "clock_offset") {
      for (double& t : travel) t += effect.of("offset_s") * site.rate_hz;
    } else if (effect.name == "clock_drift") {
      for (std::size_t i = 0; i < count; ++i) travel[i] += effect.of("drift_ratio") * static_cast<double>(i);
    }
  }
  return travel;
}

/// Polynomial through order + 1 past targets, evaluated `delay` ahead of the newest.
double extrapolated(const History& target, std::size_t now, int order, double ahead_samples) {
  const auto spacing = static_cast<std::size_t>(std::max(1.0, std::round(ahead_samples)));
  const double ahead = ahead_samples / static_cast<double>(spacing);
  const int degree = std::min(order, static_cast<int>(now / spacing));
  double p[5] = {};
  for (int j = 0; j <= degree; ++j) p[j] = target[now - static_cast<std::size_t>(j) * spacing];
  // Points at 0, -1, -2 …, evaluated ahead of them (Neville).
  for (int level = 1; level <= degree; ++level) {
    for (int j = 0; j + level <= degree; ++j) {
      p[j] = ((ahead + j + level) * p[j] - (ahead + j) * p[j + 1]) / level;
    }
  }
  return p[0];
}

}  // namespace

History through_network(const Site& site, const PlantEffects& effects, const History& sent_m) {
  const History travel = travel_samples(site, effects, sent_m.size());
  History received(sent_m.size());
  // The newest packet that has arrived by each sample: packets may overtake each other.
  std::vector<std::vector<std::size_t>> arriving(sent_m.size());
  for (std::size_t i = 0; i < sent_m.size(); ++i) {
    const double arrival = std::ceil(static_cast<double>(i) + travel[i] - 1e-9);
    if (arrival < static_cast<double>(sent_m.size())) {
      arriving[static_cast<std::size_t>(std::max(0.0, arrival))].push_back(i);
    }
  }
  std::size_t newest = 0;
  for (std::size_t i = 0; i < sent_m.size(); ++i) {
    for (const std::size_t packet : arriving[i]) newest = std::max(newest, packet);
    received[i] = sent_m[newest];
  }
  return received;
}

History compensated(const Site& site, const PlantEffects& effects, const History& target_m) {
  double delay_s = site.compensator.delay_s;
  double bias_m = 0.0;
  for (const PlantEffect& effect : effects) {
    if (effect.interface != "compensator") continue;
    if (effect.name == "setting_mismatch") delay_s = effect.of("delay_s");
    if (effect.name == "bias") bias_m = effect.of("bias_m");
  }
  History command = target_m;
  if (delay_s > 0.0) {
    for (std::size_t i = 0; i < command.size(); ++i) {
      command[i] = extrapolated(target_m, i, site.compensator.order, delay_s * site.rate_hz);
    }
  }
  for (double& value : command) value += bias_m;
  return command;
}

namespace {

/// x' = 2 pi f (u - x).
History first_order(const History& u, double period_s, double bandwidth_hz) {
  const double rate = kTwoPi * bandwidth_hz;
  History x(u.size());
  for (std::size_t i = 1; i < u.size(); ++i) {
    const double middle = 0.5 * (u[i - 1] + u[i]);
    const double k1 = rate * (u[i - 1] - x[i - 1]);
    const double k2 = rate * (middle - x[i - 1] - 0.5 * period_s * k1);
    const double k3 = rate * (middle - x[i - 1] - 0.5 * period_s * k2);
    const double k4 = rate * (u[i] - x[i - 1] - period_s * k3);
    x[i] = x[i - 1] + period_s / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  return x;
}

/// x'' = w^2 (u - x) - 2 zeta w x'.
History second_order(const History& u, double period_s, double natural_frequency_hz, double damping_ratio) {
  const double w = kTwoPi * natural_frequency_hz;
  const auto pull = [&](double input, double x, double v) { return w * w * (input - x) - 2.0 * damping_ratio * w * v; };
  History motion(u.size());
  double x = 0.0;
  double v = 0.0;
  for (std::size_t i = 1; i < u.size(); ++i) {
    const double middle = 0.5 * (u[i - 1] + u[i]);
    const double h = period_s;
    const double a1 = pull(u[i - 1], x, v);
    const double v2 = v + 0.5 * h * a1;
    const double a2 = pull(middle, x + 0.5 * h * v, v2);
    const double v3 = v + 0.5 * h * a2;
    const double a3 = pull(middle, x + 0.5 * h * v2, v3);
    const double v4 = v + h * a3;
    const double a4 = pull(u[i], x + h * v3, v4);
    x += h / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4);
    v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
    motion[i] = x;
  }
  return motion;
}

History base_response(const TransferModel& model, const History& command, double period_s) {
  const double fine_delay = model.delay_s / period_s;
  switch (model.kind) {
    case TransferKind::ideal: return spline(command);
    case TransferKind::delay: return delayed(spline(command), fine_delay);
    case TransferKind::first_order: return first_order(straight_lines(command), period_s, model.bandwidth_hz);
    case TransferKind::second_order:
      return second_order(delayed(straight_lines(command), fine_delay), period_s, model.natural_frequency_hz,
                          model.damping_ratio);
  }
  return {};
}

/// Play: the output rests until the input has crossed the clearance.
History played(const History& x, double clearance_m) {
  History result(x.size());
  double y = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    y = std::clamp(y, x[i] - 0.5 * clearance_m, x[i] + 0.5 * clearance_m);
    result[i] = y;
  }
  return result;
}

History rate_limited(const History& x, double period_s, double velocity_m_per_s) {
  History result = x;
  const double step = velocity_m_per_s * period_s;
  for (std::size_t i = 1; i < x.size(); ++i) {
    result[i] = result[i - 1] + std::clamp(x[i] - result[i - 1], -step, step);
  }
  return result;
}

/// Seals hold the piston after each stop until the demand is `breakaway_m` ahead; then it catches
/// up within milliseconds and follows until the next reversal of the demand.
History stuck(const History& x, double period_s, double breakaway_m) {
  const double catching_up = 1.0 - std::exp(-kTwoPi * 150.0 * period_s);
  History result(x.size());
  bool is_stuck = true;
  double direction = 0.0;
  double y = 0.0;
  for (std::size_t i = 1; i < x.size(); ++i) {
    const double step = x[i] - x[i - 1];
    if (!is_stuck && step * direction < 0.0) is_stuck = true;
    if (is_stuck && std::abs(x[i] - y) > breakaway_m) {
      is_stuck = false;
      direction = x[i] - y;
    }
    if (!is_stuck) y += catching_up * (x[i] - y);
    result[i] = y;
  }
  return result;
}

void apply(const PlantEffect& effect, double period_s, History& x) {
  if (effect.name == "delay") {
    // Negative: the model of the user has more delay than the real site.
    x = delayed(x, effect.of("delay_s") / period_s);
  } else if (effect.name == "bandwidth") {
    if (effect.parameters.contains("true_natural_frequency_hz")) return;  // in the base itself
    x = effect.parameters.contains("damping_ratio")
            ? second_order(x, period_s, effect.of("natural_frequency_hz"), effect.of("damping_ratio"))
            : first_order(x, period_s, effect.of("bandwidth_hz"));
  } else if (effect.name == "gain") {
    for (double& value : x) value *= effect.of("gain");
  } else if (effect.name == "backlash") {
    x = played(x, effect.of("width_m"));
  } else if (effect.name == "deadband") {
    for (double& value : x) value -= std::clamp(value, -effect.of("half_width_m"), effect.of("half_width_m"));
  } else if (effect.name == "velocity_limit") {
    x = rate_limited(x, period_s, effect.of("velocity_m_per_s"));
  } else if (effect.name == "stroke_limit") {
    for (double& value : x) value = std::clamp(value, -effect.of("stroke_m"), effect.of("stroke_m"));
  } else if (effect.name == "stiction") {
    x = stuck(x, period_s, effect.of("breakaway_m"));
  } else if (effect.name != "compliance") {
    apply_foreign_to_actuator(effect, period_s, x);
  }
}

/// The frame deforms under the force of the specimen: x = piston - F(x) / k, by repeated
/// substitution, which shrinks the error by the ratio of specimen to frame stiffness each time.
MotionHistory on_frame(const History& piston, double period_s, double frame_stiffness, const LoadOf& load) {
  MotionHistory motion = motion_of(piston, period_s);
  for (int round = 0; round < 12; ++round) {
    History x = piston;
    add(x, load(motion), -1.0 / frame_stiffness);
    motion = motion_of(std::move(x), period_s);
  }
  return motion;
}

}  // namespace

MotionHistory actuator_motion(const Site& site, const PlantEffects& effects, const History& command_m,
                              const LoadOf& load) {
  const double period_s = 1.0 / (site.rate_hz * static_cast<double>(kFineSteps));
  TransferModel base = site.transfer_system;
  for (const PlantEffect& effect : effects) {
    const auto wrong = effect.parameters.find("true_natural_frequency_hz");
    if (wrong != effect.parameters.end()) base.natural_frequency_hz = wrong->second;
  }
  History x = base_response(base, command_m, period_s);
  double frame_stiffness = 0.0;
  for (const PlantEffect& effect : effects) {
    if (effect.interface != "transfer_system") continue;
    if (effect.name == "compliance") frame_stiffness = effect.of("stiffness_n_per_m");
    apply(effect, period_s, x);
  }
  if (frame_stiffness > 0.0) return on_frame(x, period_s, frame_stiffness, load);
  return motion_of(std::move(x), period_s);
}

namespace {

/// Anti-aliasing filter of one pole, driven by straight lines.
History lagging(const History& truth, double period_s, double time_constant_s) {
  const double decay = std::exp(-period_s / time_constant_s);
  History read(truth.size());
  double state = truth.front();
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const double middle = 0.5 * (truth[i] + truth[i == 0 ? 0 : i - 1]);
    state = middle + (state - middle) * decay;
    read[i] = state;
  }
  return read;
}

}  // namespace

History reading(const char* interface, const PlantEffects& effects, const MotionHistory& motion, const History& truth) {
  History read = truth;
  for (const PlantEffect& effect : effects) {
    if (effect.interface != interface) continue;
    const std::string& name = effect.name;
    // Units differ between the two sensors, the keys with them.
    const auto value = [&](const char* of_force, const char* of_displacement) {
      return effect.interface == "force_sensor" ? effect.of(of_force) : effect.of(of_displacement);
    };
    if (name == "gain") {
      for (double& v : read) v *= effect.of("gain");
    } else if (name == "bias") {
      for (double& v : read) v += value("bias_n", "bias_m");
    } else if (name == "drift") {
      const double rate = value("drift_n_per_s", "drift_m_per_s");
      for (std::size_t i = 0; i < read.size(); ++i) read[i] += rate * static_cast<double>(i) * motion.period_s;
    } else if (name == "lag") {
      read = lagging(read, motion.period_s, effect.of("time_constant_s"));
    } else if (name == "time_skew") {
      read = delayed(read, effect.of("skew_s") / motion.period_s);
    } else if (name == "saturation") {
      for (double& v : read) v = std::clamp(v, -effect.of("limit_n"), effect.of("limit_n"));
    } else if (name == "quantization") {
      const double step = value("step_n", "step_m");
      for (double& v : read) v = step * std::round(v / step);
    } else {
      read_with_foreign(effect, motion, read);
    }
  }
  return read;
}

}  // namespace hybridtest::blind
