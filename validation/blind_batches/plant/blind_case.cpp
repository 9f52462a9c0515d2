#include "validation/blind_batches/plant/blind_case.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "validation/blind_batches/plant/effect_catalogue.hpp"
#include "validation/blind_batches/plant/plant.hpp"

namespace hybridtest::blind {

namespace {

TransferModel draw_transfer_system(RandomStream& random) {
  TransferModel model;
  model.kind = static_cast<TransferKind>(random.weighted({0.25, 0.25, 0.2, 0.3}));
  model.delay_s = rounded(random.log_uniform(0.004, 0.03));
  model.bandwidth_hz = rounded(random.log_uniform(8.0, 60.0));
  model.natural_frequency_hz = rounded(random.log_uniform(10.0, 50.0));
  model.damping_ratio = rounded(random.uniform(0.5, 1.1));
  if (model.kind == TransferKind::second_order) model.delay_s = rounded(random.uniform(0.0, 0.008));
  return model;
}

LawModel draw_law(RandomStream& random, double stroke_m) {
  LawModel law;
  law.kind = static_cast<LawKind>(random.weighted({0.13, 0.65, 0.08, 0.07, 0.07}));
  law.stiffness_n_per_m = rounded(random.log_uniform(1e4, 1e8));
  const double yield_m = stroke_m * random.uniform(0.15, 0.6);
  law.yield_force_n = rounded(law.stiffness_n_per_m * yield_m);
  law.hardening_ratio = rounded(random.uniform(0.01, 0.15));
  law.alpha = rounded(random.uniform(0.03, 0.3));
  const double opening = 1.0 / yield_m;
  const double share = random.uniform(0.4, 0.8);
  law.beta_per_m = rounded(opening * share);
  law.gamma_per_m = rounded(opening * (1.0 - share));
  return law;
}

/// A specimen without a spring: the user lists a mass, a damper or both.
void draw_known_effects(Site& site, RandomStream& random, double stroke_m) {
  const double force_n = random.log_uniform(1e2, 1e5);
  const std::size_t which = random.index(3);
  if (which != 1) site.known_mass_kg = rounded(force_n / (stroke_m * 60.0));
  if (which != 0) site.known_damping_n_s_per_m = rounded(force_n / (stroke_m * 8.0));
}

RecordedColumns draw_columns(RandomStream& random) {
  switch (random.weighted({0.45, 0.22, 0.13, 0.2})) {
    case 0: return {.sent = false, .target = true, .command = true};
    case 1: return {.sent = false, .target = false, .command = true};
    case 2: return {};
    default: return {.sent = true, .target = true, .command = true};
  }
}

Scales scales_of(const Site& site, const TrueSignals& signals) {
  return {peak(signals.motion.displacement_m), peak(signals.motion.velocity_m_per_s),
          // Of the smooth motion: play and straight lines have no acceleration to speak of.
          peak(smoothed(signals.motion.acceleration_m_per_s2, signals.motion.period_s, 40.0)), peak(signals.force_n),
          static_cast<double>(signals.sent_m.size()) / site.rate_hz};
}

}  // namespace

double rounded(double value, int digits) {
  if (value == 0.0) return 0.0;
  const double unit = std::pow(10.0, std::floor(std::log10(std::abs(value))) - digits + 1);
  return unit < 1.0 ? std::round(value / unit) / std::round(1.0 / unit) : std::round(value / unit) * unit;
}

CaseSetting draw_case_setting(std::uint64_t seed, std::uint64_t index) {
  RandomStream random{seed, index, "site"};
  CaseSetting setting;
  Site& site = setting.site;
  ExcitationSettings excitation;
  excitation.rate_hz = site.rate_hz = std::vector<double>{512.0, 600.0, 800.0, 1000.0, 1024.0}[random.index(5)];
  excitation.duration_s = std::round(random.uniform(12.0, 20.0));
  excitation.stroke_m = random.log_uniform(0.005, 0.15);
  excitation.velocity_m_per_s = random.log_uniform(0.1, 1.0);
  excitation.rest_s = random.chance(0.8) ? random.uniform(0.5, 1.5) : 0.0;
  site.transfer_system = draw_transfer_system(random);
  site.specimen = draw_law(random, excitation.stroke_m);
  if (site.specimen.kind == LawKind::none) draw_known_effects(site, random, excitation.stroke_m);
  if (random.chance(0.5)) {
    site.compensator = {static_cast<int>(1 + random.index(3)), rounded(random.log_uniform(0.008, 0.03))};
  }
  setting.columns = draw_columns(random);

  RandomStream motions{seed, index, "excitation"};
  const std::size_t fits = motions.chance(0.35) ? 2 : 1;
  for (std::size_t i = 0; i < fits; ++i) {
    setting.fit_m.push_back(draw_excitation(excitation, motions));
    excitation.stroke_m *= motions.uniform(0.5, 1.0);
  }
  excitation.stroke_m = peak(setting.fit_m.front()) * motions.uniform(0.85, 1.15);
  setting.held_out_m = draw_excitation(excitation, motions);

  const TrueSignals signals = run_plant(site, {}, setting.fit_m.front());
  setting.scales = scales_of(site, signals);
  site.displacement_noise_m = rounded(rms(signals.read_m) * std::pow(10.0, -random.uniform(40.0, 80.0) / 20.0));
  site.force_noise_n = rounded(rms(signals.read_n) * std::pow(10.0, -random.uniform(40.0, 80.0) / 20.0));
  return setting;
}

namespace {

/// Highest frequency of a motion: above it the straight lines between samples would be visible.
constexpr double kFrequency_hz_max = 12.0;

double highest_hz(const ExcitationSettings& settings, double share) {
  return std::min(kFrequency_hz_max, share * settings.velocity_m_per_s / (kTwoPi * settings.stroke_m));
}

/// Oscillator under white noise below an envelope (Jennings, Housner and Tsai, 1968), by
/// semi-implicit Euler. Its displacement is the motion of a storey.
History earthquake(const ExcitationSettings& settings, std::size_t samples, RandomStream& random) {
  const double period_s = 1.0 / settings.rate_hz / 8.0;
  const double omega = kTwoPi * std::min(highest_hz(settings, 0.8), random.log_uniform(0.5, 3.0));
  const double damping = random.uniform(0.03, 0.12);
  const double length_s = static_cast<double>(samples) / settings.rate_hz;
  const double rise_s = random.uniform(0.1, 0.25) * length_s;
  const double strong_s = random.uniform(0.3, 0.5) * length_s;
  const double decay_per_s = random.uniform(3.0, 5.0) / (length_s - strong_s);
  History motion(samples);
  double x = 0.0;
  double v = 0.0;
  double ground = 0.0;  // white noise under a corner of 6 Hz
  for (std::size_t i = 0; i < samples * 8; ++i) {
    const double t = static_cast<double>(i) * period_s;
    double envelope = std::min(1.0, (t / rise_s) * (t / rise_s));
    if (t > strong_s) envelope *= std::exp(-decay_per_s * (t - strong_s));
    ground += kTwoPi * 6.0 * period_s * (random.normal() / std::sqrt(period_s) - ground);
    v += period_s * (envelope * ground - 2.0 * damping * omega * v - omega * omega * x);
    x += period_s * v;
    if (i % 8 == 0) motion[i / 8] = x;
  }
  return motion;
}

History sweep(const ExcitationSettings& settings, std::size_t samples, RandomStream& random) {
  const double length_s = static_cast<double>(samples) / settings.rate_hz;
  const double low_hz = random.log_uniform(0.15, 0.4);
  const double steady_hz = std::max(low_hz, highest_hz(settings, 1.0));
  const double high_hz = std::min(kFrequency_hz_max, steady_hz * random.uniform(2.0, 6.0));
  const double rate = std::log(high_hz / low_hz);
  History motion(samples);
  for (std::size_t i = 0; i < samples; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(samples);
    const double frequency_hz = low_hz * std::exp(rate * share);
    const double phase = kTwoPi * low_hz * length_s / rate * (std::exp(rate * share) - 1.0);
    // At constant velocity if the stroke would require a higher one.
    motion[i] = std::min(1.0, steady_hz / frequency_hz) * std::sin(phase);
  }
  return motion;
}

History growing_sinusoid(const ExcitationSettings& settings, std::size_t samples, RandomStream& random) {
  const double frequency_hz = std::min(highest_hz(settings, 1.0), random.log_uniform(0.3, 3.0));
  const double power = random.uniform(0.7, 1.5);
  History motion(samples);
  for (std::size_t i = 0; i < samples; ++i) {
    const double t = static_cast<double>(i) / settings.rate_hz;
    motion[i] =
        std::pow(static_cast<double>(i) / static_cast<double>(samples), power) * std::sin(kTwoPi * frequency_hz * t);
  }
  return motion;
}

/// Cycles of stepwise larger amplitude, each amplitude two or three times (as FEMA 461).
History protocol(const ExcitationSettings& settings, std::size_t samples, RandomStream& random) {
  const double length_s = static_cast<double>(samples) / settings.rate_hz;
  const double wanted_hz = std::min(highest_hz(settings, 1.0), random.log_uniform(0.4, 2.0));
  const std::size_t repeats = 2 + random.index(2);
  const auto cycles = static_cast<double>(
      std::max<std::size_t>(2, static_cast<std::size_t>(wanted_hz * length_s / static_cast<double>(repeats))) *
      repeats);
  const double steps = cycles / static_cast<double>(repeats);
  History motion(samples);
  for (std::size_t i = 0; i < samples; ++i) {
    const double cycle = cycles * static_cast<double>(i) / static_cast<double>(samples);
    const double amplitude = (1.0 + std::floor(cycle / static_cast<double>(repeats))) / steps;
    motion[i] = amplitude * std::sin(kTwoPi * cycle);
  }
  return motion;
}

History band_noise(const ExcitationSettings& settings, std::size_t samples, RandomStream& random) {
  constexpr std::size_t kTones = 60;
  const double low_hz = random.log_uniform(0.1, 0.4);
  const double high_hz = std::max(2.0 * low_hz, highest_hz(settings, random.uniform(0.6, 1.6)));
  History motion(samples, 0.0);
  for (std::size_t tone = 0; tone < kTones; ++tone) {
    const double frequency_hz = random.uniform(low_hz, high_hz);
    const double phase = random.uniform(0.0, kTwoPi);
    for (std::size_t i = 0; i < samples; ++i) {
      motion[i] += std::sin(kTwoPi * frequency_hz * static_cast<double>(i) / settings.rate_hz + phase);
    }
  }
  return motion;
}

/// Raised cosine over the first and last `length` samples.
void taper(History& motion, std::size_t length) {
  for (std::size_t i = 0; i < length; ++i) {
    const double weight = 0.5 - 0.5 * std::cos(std::numbers::pi * static_cast<double>(i) / static_cast<double>(length));
    motion[i] *= weight;
    motion[motion.size() - 1 - i] *= weight;
  }
}

}  // namespace

History draw_excitation(const ExcitationSettings& settings, RandomStream& random) {
  using Draw = History (*)(const ExcitationSettings&, std::size_t, RandomStream&);
  static const std::vector<Draw> kDraws{earthquake, sweep, growing_sinusoid, protocol, band_noise};
  const auto total = static_cast<std::size_t>(settings.duration_s * settings.rate_hz) + 1;
  const auto rest = static_cast<std::size_t>(settings.rest_s * settings.rate_hz);
  const std::size_t moving = total - 2 * rest;
  History motion = kDraws[random.weighted({0.4, 0.15, 0.12, 0.13, 0.2})](settings, moving, random);
  taper(motion, static_cast<std::size_t>(0.4 * settings.rate_hz));
  const double factor = settings.stroke_m / peak(motion);
  History history(total, 0.0);
  for (std::size_t i = 0; i < moving; ++i) history[rest + i] = factor * motion[i];
  return history;
}

namespace {

/// If one library effect explains more than this share of a foreign effect, it does not count as unknown.
constexpr double kExplainedOfUnknownMax = 0.5;
constexpr int kAttempts = 20;
/// Digital stages have no noise; this value represents their rounding.
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
  // The true model contains the effects of the displacement sensor, but not its noise.
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
  // Few recordings have the columns that show the network; in those its effects are drawn more often.
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

/// Gap caused by one effect alone, over the floor, under one excitation.
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

/// Fills in the interface and size of the largest gap, and the acceptable causes.
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
