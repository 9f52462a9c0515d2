#include "validation/blind_batches/plant/collinearity.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <iterator>
#include <string_view>
#include <utility>

#include "validation/blind_batches/plant/signal_chain.hpp"
#include "validation/blind_batches/plant/specimen.hpp"

namespace hybridtest::blind {
namespace {

/// Two signatures count as equal if they differ by less than this share of the rms of the floor.
constexpr double kSeparableShare = 0.3;
/// A cause that leaves half of the gap's mean square has found something.
constexpr double kHalfLeft = 0.70710678;
/// A signature of which the wrong numbers leave less than this share is one of theirs.
constexpr double kToleratedShare = 0.1;
constexpr double kProbeAmount = 0.05;
constexpr std::size_t kCoarse = 4;

bool is_any_of(std::string_view name, std::initializer_list<std::string_view> names) {
  return std::ranges::find(names, name) != names.end();
}

/// Quantities that have either sign.
bool may_be_negative(const PlantEffect& effect) {
  return is_any_of(effect.name, {"bias", "drift", "viscous_damping", "stiffness_error", "gain", "cubic_stiffness",
                                 "time_skew", "delay"});
}

double product(const History& a, const History& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

History every(const History& fine, std::size_t stride) {
  History samples;
  samples.reserve(fine.size() / stride + 1);
  for (std::size_t i = 0; i < fine.size(); i += stride) samples.push_back(fine[i]);
  return samples;
}

struct Fit {
  double factor = 0.0;
  double left_rms = 0.0;
};

Fit fit(const History& gap, const History& signature) {
  const double square = product(signature, signature);
  if (square == 0.0) return {0.0, rms(gap)};
  const double factor = product(gap, signature) / square;
  History left = gap;
  add(left, signature, -factor);
  return {factor, rms(left)};
}

}  // namespace

void strengthen(PlantEffect& effect, double factor, const Scales& scales) {
  const bool is_compliance = effect.name == "compliance";
  for (auto& [name, value] : effect.parameters) {
    if (is_any_of(name, {"gain", "stiffness_ratio", "strength_ratio"})) {
      value = std::clamp(1.0 + factor * (value - 1.0), 0.4, 1.6);
    } else if (is_any_of(name, {"bandwidth_hz", "natural_frequency_hz"}) ||
               (is_compliance && name == "stiffness_n_per_m") || name == "scale") {
      value /= factor;
    } else if (is_any_of(name, {"pinching_ratio", "lost_ratio", "share"})) {
      value = std::clamp(factor * value, -0.8, 0.8);
    } else if (is_any_of(name, {"width_m", "half_width_m", "breakaway_m", "clearance_m", "step_m", "bias_m",
                                "amplitude_m"})) {
      value = std::clamp(factor * value, -0.8 * scales.displacement_m, 0.8 * scales.displacement_m);
    } else if (is_any_of(name, {"friction_force_n", "friction_force_backward_n", "static_force_n", "force_n", "bias_n",
                                "step_n"})) {
      value = std::clamp(factor * value, -scales.force_n, scales.force_n);
    } else if (is_any_of(name, {"delay_s", "offset_s", "skew_s"}) && effect.name != "setting_mismatch" &&
               effect.name != "echo") {
      value = std::clamp(factor * value, -0.05, 0.05);
    } else if (is_any_of(name, {"load_n", "mass_kg", "damping_n_s_per_m", "damping_n_s2_per_m2", "drift_m_per_s",
                                "drift_n_per_s", "stiffness_n_per_m3", "degradation_per_m", "drift_ratio"}) ||
               (name == "stiffness_n_per_m" && is_any_of(effect.name, {"contact", "relaxation"})) ||
               (name == "time_constant_s" && effect.name == "lag")) {
      value *= factor;
    }
  }
}

Signatures::Signatures(const Site& site, const RecordedColumns& columns, PlantEffects besides,
                       const TrueSignals& signals)
    : site_{site}, columns_{columns}, besides_{std::move(besides)}, signals_{signals} {
  const bool has_servo =
      site.transfer_system.kind != TransferKind::ideal && site.transfer_system.kind != TransferKind::delay;
  fine_command_m_ = every(has_servo ? straight_lines(signals.command_m) : spline(signals.command_m), kCoarse);
  motion_.period_s = signals.motion.period_s * static_cast<double>(kCoarse);
  motion_.displacement_m = every(signals.motion.displacement_m, kCoarse);
  motion_.velocity_m_per_s = every(signals.motion.velocity_m_per_s, kCoarse);
  motion_.acceleration_m_per_s2 = every(signals.motion.acceleration_m_per_s2, kCoarse);
  for (const Residual residual :
       {Residual::network, Residual::compensator, Residual::transfer_system, Residual::specimen}) {
    without_[residual] = output(residual, besides_);
    std::vector<History>& directions = directions_[residual];
    for (const PlantEffect& beside : besides_) {
      if (residual_of(beside.interface, columns_) != residual) continue;
      PlantEffects others;
      std::ranges::copy_if(besides_, std::back_inserter(others), [&](const auto& e) { return &e != &beside; });
      History direction = beyond_besides(residual, difference(without_.at(residual), output(residual, others)));
      const double size = std::sqrt(product(direction, direction));
      if (size == 0.0) continue;
      for (double& value : direction) value /= size;
      directions.push_back(std::move(direction));
    }
  }
}

History Signatures::output(Residual residual, const PlantEffects& effects) const {
  const std::size_t stride = kFineSteps / kCoarse;
  switch (residual) {
    case Residual::network: return through_network(site_, effects, signals_.sent_m);
    case Residual::compensator: return compensated(site_, effects, signals_.target_m);
    case Residual::transfer_system: {
      ActuatorStage actuator{site_, effects, motion_.period_s};
      SpecimenStage specimen{site_, effects, motion_.period_s};
      SensorStage sensor{"displacement_sensor", effects, motion_.period_s};
      Differentiator motion{motion_.period_s};
      const bool is_on_frame = std::ranges::any_of(effects, [](const auto& e) { return e.name == "compliance"; });
      double load_n = 0.0;
      History read;
      for (const double command : fine_command_m_) {
        const MotionPoint at = motion.next(actuator.move(command, load_n));
        if (is_on_frame) load_n = specimen.force(at);
        read.push_back(sensor.read(at, at.displacement_m));
      }
      return every(read, stride);
    }
    case Residual::specimen: break;
  }
  // The model is driven by what the displacement sensor reads.
  const bool reads_wrongly =
      std::ranges::any_of(effects, [](const auto& e) { return e.interface == "displacement_sensor"; });
  History force = specimen_force(site_, effects, motion_);
  if (reads_wrongly) {
    const MotionHistory read =
        motion_of(reading("displacement_sensor", effects, motion_, motion_.displacement_m), motion_.period_s);
    add(force, difference(specimen_force(site_, effects, motion_), specimen_force(site_, effects, read)));
  }
  return every(reading("force_sensor", effects, motion_, force), stride);
}

History Signatures::of(const PlantEffect& effect) const {
  const Residual residual = residual_of(effect.interface, columns_);
  PlantEffects effects = besides_;
  effects.push_back(effect);
  return difference(output(residual, effects), without_.at(residual));
}

History Signatures::beyond_besides(Residual residual, History signature) const {
  const auto directions = directions_.find(residual);
  if (directions == directions_.end()) return signature;
  for (const History& direction : directions->second) add(signature, direction, -product(signature, direction));
  return signature;
}

namespace {

/// The smallest gap that the cause can leave, after its amount is adjusted twice.
double left_by(const CaseSetting& setting, const Signatures& signatures, Residual residual, const History& gap,
               PlantEffect effect, History signature, double enough) {
  double least = rms(gap);
  for (int round = 0; round < 3; ++round) {
    if (round > 0) signature = signatures.beyond_besides(residual, signatures.of(effect));
    const Fit found = fit(gap, signature);
    if (found.factor == 0.0 || (found.factor < 0.0 && !may_be_negative(effect))) break;
    if (round > 0 && std::abs(found.factor - 1.0) < 0.02) return std::min(least, found.left_rms);
    // The linear fit of a small cause shows whether an adjustment can help.
    if (found.left_rms > kHalfLeft * rms(gap) && found.left_rms > enough) break;
    if (round > 0) least = std::min(least, found.left_rms);
    strengthen(effect, found.factor, setting.scales);
  }
  return least;
}

std::vector<CatalogueEntry> candidates(const CaseSetting& setting, Residual residual) {
  std::vector<CatalogueEntry> entries = fitting(named_effects(), setting);
  std::erase_if(entries,
                [&](const CatalogueEntry& entry) { return residual_of(entry.interface, setting.columns) != residual; });
  return entries;
}

}  // namespace

LookAlikes look_alikes(const CaseSetting& setting, const Signatures& signatures, Residual residual, const History& gap,
                       double floor, RandomStream& random) {
  LookAlikes found;
  const double enough = kSeparableShare * floor;
  const double all = rms(gap);
  for (const CatalogueEntry& entry : candidates(setting, residual)) {
    const PlantEffect effect{entry.interface, entry.name, entry.draw(random, setting, kProbeAmount)};
    const History whole = signatures.of(effect);
    const History signature = signatures.beyond_besides(residual, whole);
    if (rms(signature) < kToleratedShare * rms(whole)) found.tolerated.push_back({entry.interface, entry.name});
    if (all == 0.0) continue;
    const double left = left_by(setting, signatures, residual, gap, effect, signature, enough);
    if (!(left < kHalfLeft * all)) continue;
    (left < enough ? found.same : found.half).push_back({entry.interface, entry.name});
  }
  return found;
}

}  // namespace hybridtest::blind
