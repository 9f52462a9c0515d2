#include "validation/blind_batches/plant/blind_case.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "validation/blind_batches/plant/collinearity.hpp"
#include "validation/blind_batches/plant/effect_catalogue.hpp"

namespace hybridtest::blind {
namespace {

/// A foreign effect of which a single library effect explains more is no unknown one.
constexpr double kExplainedOfUnknownMax = 0.5;
constexpr int kAttempts = 20;
/// Digital stages have no noise; this stands for their rounding.
constexpr double kFloorMin = 1e-6;

/// Of a recording against the true and the user's model, driven by what was measured.
struct Residuals {
  History true_model;
  History user_model;
  double floor = 0.0;  // rms of what noise alone leaves, by the quieter of the two models
};

Residuals residuals_of(Residual residual, const Site& site, const PlantEffects& effects, const TrueSignals& signals,
                       const PlantRecording& recording) {
  const auto less = [&](const History& output, const History& true_input, const History& user_input) {
    Residuals result;
    result.true_model = difference(output, stage_output(residual, site, effects, true_input));
    result.user_model = difference(output, stage_output(residual, site, {}, user_input));
    // The true model may amplify noise that does not hide its effect.
    const double of_noise = rms(difference(result.user_model, true_gap(residual, site, signals)));
    result.floor = std::max(std::min(rms(result.true_model), of_noise), kFloorMin * rms(output));
    return result;
  };
  switch (residual) {
    case Residual::network: return less(recording.target_m, recording.sent_m, recording.sent_m);
    case Residual::compensator: return less(recording.command_m, recording.target_m, recording.target_m);
    case Residual::transfer_system: return less(recording.measured_m, recording.command_m, recording.command_m);
    case Residual::specimen: break;
  }
  // The true model knows what the displacement sensor did besides its noise.
  History moved = difference(recording.measured_m, signals.read_m);
  add(moved, sampled(signals.motion.displacement_m));
  return less(recording.measured_n, moved, recording.measured_m);
}

double variance_removed(const Residuals& residuals) {
  const double ratio = rms(residuals.true_model) / std::max(rms(residuals.user_model), 1e-300);
  return 1.0 - ratio * ratio;
}

PlantEffect draw_from(const std::vector<CatalogueEntry>& catalogue, const CaseSetting& setting, RandomStream& random,
                      double amount) {
  const std::vector<CatalogueEntry> entries = fitting(catalogue, setting);
  // The network is seen by few columns; where it is, its effects get more of a share.
  std::vector<double> weights;
  for (const CatalogueEntry& entry : entries) weights.push_back(entry.interface == "network" ? 2.5 : 1.0);
  const CatalogueEntry& entry = entries[random.weighted(weights)];
  return {entry.interface, entry.name, entry.draw(random, setting, amount)};
}

PlantEffects draw_foreign(const CaseSetting& setting, RandomStream& random) {
  PlantEffect best;
  double least = 2.0;
  for (int attempt = 0; attempt < kAttempts && least > kExplainedOfUnknownMax; ++attempt) {
    PlantEffect effect = draw_from(foreign_effects(), setting, random, random.log_uniform(0.03, 0.4));
    const Residual residual = residual_of(effect.interface, setting.columns);
    const History gap = true_gap(residual, setting.site, run_plant(setting.site, {effect}, setting.fit_m.front()));
    const double explained = best_explained(setting, residual, gap, random);
    if (explained < least) {
      least = explained;
      best = std::move(effect);
    }
  }
  return {best};
}

PlantEffects draw_pair(const CaseSetting& setting, RandomStream& random) {
  PlantEffects pair{draw_from(named_effects(), setting, random, random.log_uniform(0.03, 0.3))};
  while (pair.size() < 2) {
    PlantEffect second = draw_from(named_effects(), setting, random, random.log_uniform(0.03, 0.3));
    if (second.name != pair.front().name) pair.push_back(std::move(second));
  }
  return pair;
}

/// Gap that an effect alone makes, over the floor, under one excitation.
double gap_to_floor(const Site& site, const PlantEffect& effect, Residual residual, const History& sent, double floor) {
  return rms(true_gap(residual, site, run_plant(site, {effect}, sent))) / floor;
}

/// Of the causes that hold every sample up by as much, and that nothing in a recording of one clock tells apart, the
/// other one.
std::optional<Cause> twin_of(const PlantEffect& effect) {
  if (effect.interface != "network") return {};
  if (effect.name == "latency") return Cause{"network", "clock_offset"};
  if (effect.name == "clock_offset") return Cause{"network", "latency"};
  return {};
}

/// Fills in where the gap is largest and how large, and the acceptable causes.
void judge(BlindCase& blind_case, const TrueSignals& first, const TrueSignals& held_out, RandomStream random) {
  const CaseSetting& setting = blind_case.setting;
  const Site& site = setting.site;
  Truth& truth = blind_case.truth;
  for (const PlantEffect& effect : truth.effects) {
    const Residual residual = residual_of(effect.interface, setting.columns);
    const double floor = residuals_of(residual, site, truth.effects, first, blind_case.fit.front()).floor;
    const History gap = true_gap(residual, site, run_plant(site, {effect}, setting.fit_m.front()));
    if (rms(gap) / floor > truth.gap_to_floor) {
      const Residuals later = residuals_of(residual, site, truth.effects, held_out, blind_case.held_out);
      truth.residual = residual;
      truth.gap_to_floor = rms(gap) / floor;
      truth.held_out_gap_to_floor = gap_to_floor(site, effect, residual, setting.held_out_m, later.floor);
      truth.variance_removed = variance_removed(later);
    }
    if (truth.kind == TruthClass::unknown) continue;
    std::vector<Cause> causes = collinear_causes(setting, residual, gap, floor, random);
    causes.insert(causes.begin(), {effect.interface, effect.name});
    if (auto twin = twin_of(effect)) causes.push_back(std::move(*twin));
    for (Cause& cause : causes) {
      if (std::ranges::find(truth.acceptable, cause) == truth.acceptable.end()) {
        truth.acceptable.push_back(std::move(cause));
      }
    }
  }
}

}  // namespace

BlindCase make_case(CaseSetting setting, TruthClass kind, PlantEffects effects, std::uint64_t seed,
                    std::uint64_t index) {
  BlindCase result;
  result.setting = std::move(setting);
  result.truth.kind = kind;
  result.truth.effects = std::move(effects);
  const Site& site = result.setting.site;
  RandomStream noise{seed, index, "noise"};
  TrueSignals first;
  for (const History& sent : result.setting.fit_m) {
    TrueSignals signals = run_plant(site, result.truth.effects, sent);
    result.fit.push_back(record(site, signals, noise));
    if (result.fit.size() == 1) first = std::move(signals);
  }
  const TrueSignals held_out = run_plant(site, result.truth.effects, result.setting.held_out_m);
  result.held_out = record(site, held_out, noise);
  judge(result, first, held_out, RandomStream{seed, index, "collinearity"});
  return result;
}

BlindCase draw_case(std::uint64_t seed, std::uint64_t index) {
  CaseSetting setting = draw_case_setting(seed, index);
  RandomStream random{seed, index, "effect"};
  const double amount = random.log_uniform(0.002, 0.4);
  switch (random.weighted({0.12, 0.14, 0.42, 0.22, 0.10})) {
    case 0: return make_case(std::move(setting), TruthClass::none, {}, seed, index);
    case 1: {
      PlantEffect wrong = draw_from(wrong_numbers(), setting, random, amount);
      return make_case(std::move(setting), TruthClass::named, {std::move(wrong)}, seed, index);
    }
    case 2: {
      PlantEffect effect = draw_from(named_effects(), setting, random, amount);
      return make_case(std::move(setting), TruthClass::named, {std::move(effect)}, seed, index);
    }
    case 3: {
      PlantEffects foreign = draw_foreign(setting, random);
      return make_case(std::move(setting), TruthClass::unknown, std::move(foreign), seed, index);
    }
    default: {
      PlantEffects pair = draw_pair(setting, random);
      return make_case(std::move(setting), TruthClass::pair, std::move(pair), seed, index);
    }
  }
}

}  // namespace hybridtest::blind
