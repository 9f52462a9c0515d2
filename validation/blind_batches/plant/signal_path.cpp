#include "validation/blind_batches/plant/signal_path.hpp"

#include <algorithm>
#include <cmath>

#include "validation/blind_batches/plant/random_stream.hpp"

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

}  // namespace hybridtest::blind
