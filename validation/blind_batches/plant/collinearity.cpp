#include "validation/blind_batches/plant/blind_case.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "validation/blind_batches/plant/effect_catalogue.hpp"

namespace hybridtest::blind {
namespace {

/// Two signatures count as equal if they differ by less than this share of the rms of the floor.
constexpr double kSeparableShare = 0.3;
constexpr double kProbeAmount = 0.05;

bool is_any_of(std::string_view name, std::initializer_list<std::string_view> names) {
  return std::ranges::find(names, name) != names.end();
}

/// Quantities that have either sign.
bool may_be_negative(const PlantEffect& effect) {
  return is_any_of(effect.name, {"bias", "drift", "viscous_damping", "stiffness_error", "gain", "cubic_stiffness",
                                 "time_skew", "delay"});
}

/// Makes the effect `factor` times as strong, to first order.
void strengthen(PlantEffect& effect, double factor) {
  for (auto& [name, value] : effect.parameters) {
    if (is_any_of(name, {"gain", "stiffness_ratio"})) {
      value = 1.0 + factor * (value - 1.0);
    } else if (is_any_of(name, {"bandwidth_hz", "natural_frequency_hz"}) ||
               (effect.name == "compliance" && name == "stiffness_n_per_m")) {
      value /= factor;
    } else if (effect.interface != "network" && is_any_of(name, {"delay_s",
                                                                 "skew_s",
                                                                 "damping_n_s_per_m",
                                                                 "damping_n_s2_per_m2",
                                                                 "friction_force_n",
                                                                 "friction_force_backward_n",
                                                                 "static_force_n",
                                                                 "force_n",
                                                                 "load_n",
                                                                 "mass_kg",
                                                                 "bias_m",
                                                                 "bias_n",
                                                                 "drift_m_per_s",
                                                                 "drift_n_per_s",
                                                                 "stiffness_n_per_m3",
                                                                 "stiffness_n_per_m",
                                                                 "width_m",
                                                                 "half_width_m",
                                                                 "breakaway_m",
                                                                 "clearance_m",
                                                                 "degradation_per_m"})) {
      value *= factor;
    } else if (name == "time_constant_s" && effect.name == "lag") {
      value *= factor;
    }
  }
}

/// The part of the residual that the cause gives for the recorded command of the actuator, or the recorded
/// motion of the specimen.
History signature(const CaseSetting& setting, Residual residual, const PlantEffect& effect) {
  return true_gap(residual, setting.site, run_plant(setting.site, {effect}, setting.fit_m.front()));
}

struct Fit {
  double factor = 0.0;
  double left_rms = 0.0;
};

Fit fit(const History& gap, const History& signature) {
  double product = 0.0;
  double square = 0.0;
  for (std::size_t i = 0; i < gap.size(); ++i) {
    product += gap[i] * signature[i];
    square += signature[i] * signature[i];
  }
  if (square == 0.0) return {0.0, rms(gap)};
  History left = gap;
  add(left, signature, -product / square);
  return {product / square, rms(left)};
}

std::vector<CatalogueEntry> candidates(const CaseSetting& setting, Residual residual) {
  std::vector<CatalogueEntry> entries = fitting(named_effects(), setting);
  std::erase_if(entries,
                [&](const CatalogueEntry& entry) { return residual_of(entry.interface, setting.columns) != residual; });
  return entries;
}

/// The smallest gap that the cause can leave, after its amount is adjusted twice.
double left_by(const CaseSetting& setting, Residual residual, const History& gap, PlantEffect effect, double enough) {
  double least = rms(gap);
  for (int round = 0; round < 3; ++round) {
    const Fit found = fit(gap, signature(setting, residual, effect));
    if (found.factor == 0.0 || (found.factor < 0.0 && !may_be_negative(effect))) break;
    if (round > 0 && std::abs(found.factor - 1.0) < 0.02) return std::min(least, found.left_rms);
    // The linear fit of a small cause shows whether an adjustment can help.
    if (found.left_rms > 0.5 * rms(gap) && found.left_rms > enough) break;
    if (round > 0) least = std::min(least, found.left_rms);
    strengthen(effect, found.factor);
  }
  return least;
}

}  // namespace

Residual residual_of(const std::string& interface, const RecordedColumns& columns) {
  if (interface == "network") return Residual::network;
  if (interface == "compensator") return Residual::compensator;
  if (interface == "transfer_system") return Residual::transfer_system;
  if (interface == "displacement_sensor" && columns.command) return Residual::transfer_system;
  return Residual::specimen;
}

History true_gap(Residual residual, const Site& site, const TrueSignals& signals) {
  switch (residual) {
    case Residual::network: return difference(signals.target_m, stage_output(residual, site, {}, signals.sent_m));
    case Residual::compensator:
      return difference(signals.command_m, stage_output(residual, site, {}, signals.target_m));
    case Residual::transfer_system:
      return difference(signals.read_m, stage_output(residual, site, {}, signals.command_m));
    case Residual::specimen: return difference(signals.read_n, stage_output(residual, site, {}, signals.read_m));
  }
  return {};
}

std::vector<Cause> collinear_causes(const CaseSetting& setting, Residual residual, const History& gap, double floor,
                                    RandomStream& random) {
  std::vector<Cause> causes;
  const double enough = kSeparableShare * floor;
  for (const CatalogueEntry& entry : candidates(setting, residual)) {
    const PlantEffect effect{entry.interface, entry.name, entry.draw(random, setting, kProbeAmount)};
    if (left_by(setting, residual, gap, effect, enough) < enough) causes.push_back({entry.interface, entry.name});
  }
  return causes;
}

double best_explained(const CaseSetting& setting, Residual residual, const History& gap, RandomStream& random) {
  const double all = rms(gap);
  double best = 0.0;
  for (const CatalogueEntry& entry : candidates(setting, residual)) {
    const PlantEffect effect{entry.interface, entry.name, entry.draw(random, setting, kProbeAmount)};
    const double left = fit(gap, signature(setting, residual, effect)).left_rms / all;
    best = std::max(best, 1.0 - left * left);
  }
  return best;
}

}  // namespace hybridtest::blind
