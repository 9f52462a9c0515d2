#include "validation/blind_batches/plant/signal_chain.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "validation/blind_batches/plant/foreign_effects.hpp"

namespace hybridtest::blind {

namespace {

/// Lost in bursts of two packets on average (Gilbert, Bell Syst. Tech. J. 39, 1960).
std::function<double()> bursts_of_loss(const PlantEffect& effect) {
  const double ratio = effect.of("loss_ratio");
  constexpr double kLeaves = 0.5;
  return [random = RandomStream{effect.seed(), 0, "loss"}, enters = kLeaves * ratio / (1.0 - ratio),
          is_losing = false]() mutable {
    is_losing = random.chance(is_losing ? 1.0 - kLeaves : enters);
    return is_losing ? HUGE_VAL : 0.0;
  };
}

/// A clock whose rate wanders by a tenth as its quartz warms and cools.
std::function<double()> drifting(const PlantEffect& effect, double rate_hz) {
  return [drift = effect.of("drift_ratio"), turn = kTwoPi / (7.0 * rate_hz), late = 0.0, i = 0.0]() mutable {
    const double now = late;
    late += drift * (1.0 + 0.1 * std::sin(turn * i++));
    return now;
  };
}

}  // namespace

NetworkStage::NetworkStage(const Site& site, const PlantEffects& effects) {
  const double rate_hz = site.rate_hz;
  for (const PlantEffect& effect : effects) {
    if (effect.interface != "network") continue;
    if (effect.name == "latency") delays_.emplace_back([t = effect.of("delay_s") * rate_hz] { return t; });
    if (effect.name == "clock_offset") delays_.emplace_back([t = effect.of("offset_s") * rate_hz] { return t; });
    if (effect.name == "clock_drift") delays_.push_back(drifting(effect, rate_hz));
    if (effect.name == "loss") delays_.push_back(bursts_of_loss(effect));
    if (effect.name == "jitter") {
      delays_.emplace_back(
          [mean = effect.of("jitter_s") * rate_hz, random = RandomStream{effect.seed(), 0, "jitter"}]() mutable {
            return -std::log(1.0 - random.uniform(0.0, 1.0)) * mean;
          });
    }
  }
}

double NetworkStage::receive(double sent_m) {
  const std::size_t now = sent_m_.size();
  sent_m_.push_back(sent_m);
  double delay = 0.0;
  for (const auto& of_packet : delays_) delay += of_packet();
  if (std::isfinite(delay)) {
    const auto arrival = static_cast<std::size_t>(std::ceil(static_cast<double>(now) + delay - 1e-9));
    if (arriving_.size() <= arrival) arriving_.resize(arrival + 1);
    arriving_[arrival].push_back(now);
  }
  if (now < arriving_.size()) {
    for (const std::size_t packet : arriving_[now]) newest_ = std::max(newest_, packet);
  }
  return sent_m_[newest_];
}

namespace {

/// Polynomial through order + 1 past targets, evaluated `ahead_samples` ahead of the newest.
double extrapolated(const History& target, int order, double ahead_samples) {
  const std::size_t now = target.size() - 1;
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

CompensatorStage::CompensatorStage(const Site& site, const PlantEffects& effects) : order_{site.compensator.order} {
  double delay_s = site.compensator.delay_s;
  for (const PlantEffect& effect : effects) {
    if (effect.interface != "compensator") continue;
    if (effect.name == "setting_mismatch") delay_s = effect.of("delay_s");
    if (effect.name == "bias") bias_m_ += effect.of("bias_m");
  }
  ahead_samples_ = delay_s * site.rate_hz;
}

double CompensatorStage::command(double target_m) {
  target_m_.push_back(target_m);
  return bias_m_ + (ahead_samples_ > 0.0 ? extrapolated(target_m_, order_, ahead_samples_) : target_m);
}

ServoLoop ServoLoop::first_order(double bandwidth_hz, double period_s) {
  ServoLoop loop;
  loop.period_s_ = period_s;
  loop.w_ = kTwoPi * bandwidth_hz;
  loop.follow_pole(loop.w_);
  return loop;
}

ServoLoop ServoLoop::second_order(double natural_frequency_hz, double damping_ratio, double period_s) {
  ServoLoop loop = first_order(natural_frequency_hz, period_s);
  loop.damping_ratio_ = damping_ratio;
  loop.has_two_poles_ = true;
  const double excess = std::sqrt(std::max(0.0, damping_ratio * damping_ratio - 1.0));
  loop.follow_pole(loop.w_ * (std::max(1.0, damping_ratio) + excess));
  return loop;
}

void ServoLoop::follow_pole(double fastest_rad_per_s) {
  // The method diverges where a pole turns by more than 2.8 rad in a step.
  constexpr double kTurn = 2.0;
  steps_ = std::max(1.0, std::ceil(fastest_rad_per_s * period_s_ / kTurn));
}

double ServoLoop::next(double input) {
  const double before = std::exchange(input_, input);
  for (double step = 0.0; step < steps_; ++step) {
    advance(before + (input - before) * (step / steps_), before + (input - before) * ((step + 1.0) / steps_),
            period_s_ / steps_);
  }
  return x_;
}

void ServoLoop::advance(double before, double input, double h) {
  const double middle = 0.5 * (before + input);
  if (!has_two_poles_) {
    const double k1 = w_ * (before - x_);
    const double k2 = w_ * (middle - x_ - 0.5 * h * k1);
    const double k3 = w_ * (middle - x_ - 0.5 * h * k2);
    const double k4 = w_ * (input - x_ - h * k3);
    x_ += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    return;
  }
  const auto pull = [&](double u, double x, double v) { return w_ * w_ * (u - x) - 2.0 * damping_ratio_ * w_ * v; };
  const double a1 = pull(before, x_, v_);
  const double v2 = v_ + 0.5 * h * a1;
  const double a2 = pull(middle, x_ + 0.5 * h * v_, v2);
  const double v3 = v_ + 0.5 * h * a2;
  const double a3 = pull(middle, x_ + 0.5 * h * v2, v3);
  const double v4 = v_ + h * a3;
  const double a4 = pull(input, x_ + h * v3, v4);
  x_ += h / 6.0 * (v_ + 2.0 * v2 + 2.0 * v3 + v4);
  v_ += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
}

namespace {

using Part = std::function<double(double)>;

/// Of the pole of a valve, over that of the loop.
constexpr double kValveSpeed = 8.0;

Part servo_part(ServoLoop loop) {
  return [loop](double u) mutable { return loop.next(u); };
}

/// The user's own model, with the numbers that the real one has.
void add_base(const Site& site, const PlantEffects& effects, double period_s, std::vector<Part>& parts) {
  TransferModel base = site.transfer_system;
  if (base.kind == TransferKind::ideal || base.kind == TransferKind::first_order) base.delay_s = 0.0;
  for (const PlantEffect& effect : effects) {
    if (effect.interface != "transfer_system") continue;
    const auto real = [&](const char* name, double& number) {
      if (const auto found = effect.parameters.find(name); found != effect.parameters.end()) number = found->second;
    };
    real("true_natural_frequency_hz", base.natural_frequency_hz);
    real("true_bandwidth_hz", base.bandwidth_hz);
    // Negative: the model of the user has more delay than the real site.
    if (effect.name == "delay") base.delay_s = std::max(0.0, base.delay_s + effect.of("delay_s"));
  }
  if (base.delay_s > 0.0) {
    parts.emplace_back([line = DelayLine{base.delay_s / period_s}](double u) mutable { return line.next(u); });
  }
  if (base.kind == TransferKind::first_order) {
    parts.push_back(servo_part(ServoLoop::first_order(base.bandwidth_hz, period_s)));
  } else if (base.kind == TransferKind::second_order) {
    parts.push_back(servo_part(ServoLoop::second_order(base.natural_frequency_hz, base.damping_ratio, period_s)));
  }
}

/// The valve is open as far as it goes: the actuator catches up at 1 kHz, but never faster than the flow lets it,
/// to which it comes near smoothly.
Part flow_limit(double velocity_m_per_s, double period_s) {
  return [velocity_m_per_s, period_s, y = 0.0, started = false](double x) mutable {
    if (!std::exchange(started, true)) y = x;
    const double asked = kTwoPi * 1000.0 * (x - y) / velocity_m_per_s;
    return y += period_s * velocity_m_per_s * std::tanh(asked);
  };
}

/// Seals hold the piston after each stop until the demand is `breakaway_m` ahead. Then it gains on the demand at a
/// velocity, so it moves faster than the demand does until it has caught up, and follows until the next reversal.
Part stuck(const PlantEffect& effect, double period_s) {
  const double breakaway_m = effect.of("breakaway_m");
  const double gained_m = breakaway_m * kTwoPi * effect.of("catching_up_hz") * period_s;
  return [breakaway_m, gained_m, is_stuck = true, direction = 0.0, past = 0.0, behind = 0.0](double x) mutable {
    const double step = x - std::exchange(past, x);
    if (!is_stuck && step * direction < 0.0) is_stuck = true;
    if (is_stuck) behind += step;
    if (is_stuck && std::abs(behind) > breakaway_m) {
      is_stuck = false;
      direction = behind;
    }
    if (!is_stuck) behind -= std::clamp(behind, -gained_m, gained_m);
    return x - behind;
  };
}

/// A clamp whose last twentieth is a cushion.
double cushioned(double x, double limit) {
  const double soft = 0.05 * limit;
  const double over = std::abs(x) - (limit - soft);
  return over <= 0.0 ? x : std::copysign(limit - soft + soft * std::tanh(over / soft), x);
}

/// Two poles, a valve's behind the effect's own.
Part bandwidth(const PlantEffect& effect, double period_s) {
  if (!effect.parameters.contains("damping_ratio")) {
    return servo_part(ServoLoop::second_order(effect.of("bandwidth_hz") * std::sqrt(kValveSpeed),
                                              0.5 * (1.0 + kValveSpeed) / std::sqrt(kValveSpeed), period_s));
  }
  return servo_part(ServoLoop::second_order(effect.of("natural_frequency_hz"), effect.of("damping_ratio"), period_s));
}

/// A frame whose joints close under load, and which gives within milliseconds: later than a damper behind it pushes,
/// as the force that loads it is that of the step before.
Part frame(const PlantEffect& effect, double viscous_n_s_per_m, double period_s) {
  const double k = effect.of("stiffness_n_per_m");
  const double following = 1.0 - std::exp(-period_s / (1e-3 + 4.0 * viscous_n_s_per_m / k));
  return [k, following, closing_n = effect.of("closing_n"), given = 0.0](double force) mutable {
    const double share = force / closing_n;
    return given += following * (force / k * (1.0 + 0.2 / (1.0 + share * share)) - given);
  };
}

Part part_of(const PlantEffect& effect, double period_s) {
  const std::string_view name = effect.name;
  if (name == "bandwidth") return bandwidth(effect, period_s);
  if (name == "gain") return [gain = effect.of("gain")](double x) { return gain * x; };
  if (name == "backlash") {
    return [slot = MovingSlot{effect.of("width_m"), 0.1}](double x) mutable { return slot.next(x); };
  }
  if (name == "deadband") {  // of a valve whose edges are a little worn
    return [half = effect.of("half_width_m")](double x) { return x - half * std::tanh(x / half); };
  }
  if (name == "velocity_limit") return flow_limit(effect.of("velocity_m_per_s"), period_s);
  if (name == "stroke_limit") return [stroke = effect.of("stroke_m")](double x) { return cushioned(x, stroke); };
  if (name == "stiction") return stuck(effect, period_s);
  return foreign_motion(effect, period_s);
}

}  // namespace

ActuatorStage::ActuatorStage(const Site& site, const PlantEffects& effects, double period_s) {
  add_base(site, effects, period_s, parts_);
  double viscous_n_s_per_m = site.known_damping_n_s_per_m;
  for (const PlantEffect& effect : effects) {
    if (effect.name == "viscous_damping") viscous_n_s_per_m += std::abs(effect.of("damping_n_s_per_m"));
  }
  for (const PlantEffect& effect : effects) {
    if (effect.interface != "transfer_system") continue;
    if (Part part = part_of(effect, period_s)) parts_.push_back(std::move(part));
    if (effect.name == "compliance") give_ = frame(effect, viscous_n_s_per_m, period_s);
  }
}

double ActuatorStage::move(double command_m, double load_n) {
  for (const Part& part : parts_) command_m = part(command_m);
  return give_ ? command_m - give_(load_n) : command_m;
}

namespace {

using ReadingPart = std::function<double(const MotionPoint&, double)>;

/// One pole, exact for an input that is straight between two points: it lags by the time constant, however short.
class Pole {
 public:
  Pole(double time_constant_s, double period_s)
      : decay_{std::exp(-period_s / time_constant_s)}, lag_in_steps_{time_constant_s / period_s} {}

  double next(double v) {
    if (!std::exchange(started_, true)) input_ = output_ = v;
    const double lag = lag_in_steps_ * (v - input_);
    output_ = v - lag + (output_ - input_ + lag) * decay_;
    input_ = v;
    return output_;
  }

 private:
  double decay_;
  double lag_in_steps_;
  double input_ = 0.0;
  double output_ = 0.0;
  bool started_ = false;
};

/// Two equal poles that together lag by the time constant.
ReadingPart lagging(double time_constant_s, double period_s) {
  const Pole pole{0.5 * time_constant_s, period_s};
  return
      [first = pole, second = pole](const MotionPoint& /*at*/, double v) mutable { return second.next(first.next(v)); };
}

/// A converter whose steps are up to a tenth wider or narrower than they should be.
ReadingPart converted(double step) {
  return [step](const MotionPoint& /*at*/, double v) {
    const double code = v / step;
    return step * std::round(code + 0.1 * std::sin(kTwoPi * code / 7.3));
  };
}

ReadingPart reading_part(const PlantEffect& effect, double period_s) {
  const std::string_view name = effect.name;
  // Units differ between the two sensors, the keys with them.
  const auto value = [&](const char* of_force, const char* of_displacement) {
    return effect.interface == "force_sensor" ? effect.of(of_force) : effect.of(of_displacement);
  };
  if (name == "gain") return [gain = effect.of("gain")](const MotionPoint& /*at*/, double v) { return gain * v; };
  if (name == "bias")
    return [bias = value("bias_n", "bias_m")](const MotionPoint& /*at*/, double v) { return v + bias; };
  if (name == "drift") {  // of a bridge that warms: ever more slowly
    return [rate = value("drift_n_per_s", "drift_m_per_s"), warming_s = effect.of("warming_s")](const MotionPoint& at,
                                                                                                double v) {
      return v + rate * warming_s * (1.0 - std::exp(-at.time_s / warming_s));
    };
  }
  if (name == "lag") return lagging(effect.of("time_constant_s"), period_s);
  if (name == "time_skew") {
    return [line = DelayLine{effect.of("skew_s") / period_s}](const MotionPoint& /*at*/, double v) mutable {
      return line.next(v);
    };
  }
  if (name == "saturation") {
    return [limit = effect.of("limit_n")](const MotionPoint& /*at*/, double v) { return cushioned(v, limit); };
  }
  if (name == "quantization") return converted(value("step_n", "step_m"));
  return foreign_reading(effect, period_s);
}

}  // namespace

SensorStage::SensorStage(const char* interface, const PlantEffects& effects, double period_s) {
  for (const PlantEffect& effect : effects) {
    if (effect.interface != interface) continue;
    if (ReadingPart part = reading_part(effect, period_s)) parts_.push_back(std::move(part));
  }
}

double SensorStage::read(const MotionPoint& motion, double truth) {
  for (const ReadingPart& part : parts_) truth = part(motion, truth);
  return truth;
}

History through_network(const Site& site, const PlantEffects& effects, const History& sent_m) {
  NetworkStage network{site, effects};
  History received(sent_m.size());
  std::ranges::transform(sent_m, received.begin(), [&](double sent) { return network.receive(sent); });
  return received;
}

History compensated(const Site& site, const PlantEffects& effects, const History& target_m) {
  CompensatorStage compensator{site, effects};
  History command(target_m.size());
  std::ranges::transform(target_m, command.begin(), [&](double target) { return compensator.command(target); });
  return command;
}

MotionHistory actuator_motion(const Site& site, const PlantEffects& effects, const History& command_m) {
  const double period_s = 1.0 / (site.rate_hz * static_cast<double>(kFineSteps));
  const bool has_servo =
      site.transfer_system.kind != TransferKind::ideal && site.transfer_system.kind != TransferKind::delay;
  History x = has_servo ? straight_lines(command_m) : spline(command_m);
  ActuatorStage actuator{site, effects, period_s};
  SpecimenStage specimen{site, effects, period_s};
  Differentiator motion{period_s};
  double load_n = 0.0;
  const bool is_on_frame = std::ranges::any_of(effects, [](const PlantEffect& e) { return e.name == "compliance"; });
  for (double& value : x) {
    value = actuator.move(value, load_n);
    if (is_on_frame) load_n = specimen.force(motion.next(value));
  }
  return motion_of(std::move(x), period_s);
}

History reading(const char* interface, const PlantEffects& effects, const MotionHistory& motion, const History& truth) {
  SensorStage sensor{interface, effects, motion.period_s};
  History read(truth.size());
  for (std::size_t i = 0; i < read.size(); ++i) read[i] = sensor.read(motion.at(i), truth[i]);
  return read;
}

}  // namespace hybridtest::blind
