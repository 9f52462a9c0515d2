#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "validation/blind_batches/plant/blind_case.hpp"
#include "validation/blind_batches/plant/plant.hpp"

namespace hybridtest::blind {

namespace {

/// Share of the cases that are recorded in a closed loop.
constexpr double kLoopShare = 0.7;
/// A loop whose motion passes this multiple of what was planned is not stable.
constexpr double kRunaway = 5.0;

TransferModel draw_transfer_system(RandomStream& random, bool is_loop) {
  TransferModel model;
  model.kind = static_cast<TransferKind>(
      random.weighted(is_loop ? std::vector{0.0, 0.2, 0.25, 0.55} : std::vector{0.25, 0.25, 0.2, 0.3}));
  model.delay_s = rounded(random.log_uniform(0.004, is_loop ? 0.02 : 0.03));
  model.bandwidth_hz = rounded(random.log_uniform(is_loop ? 12.0 : 8.0, 60.0));
  model.natural_frequency_hz = rounded(random.log_uniform(is_loop ? 15.0 : 10.0, 50.0));
  model.damping_ratio = rounded(random.uniform(0.5, 1.1));
  if (model.kind == TransferKind::second_order) model.delay_s = rounded(random.uniform(0.0, 0.008));
  return model;
}

LawModel draw_law(RandomStream& random, double stroke_m, double stiffness_n_per_m, bool is_loop) {
  LawModel law;
  law.kind = static_cast<LawKind>(
      random.weighted(is_loop ? std::vector{0.0, 0.55, 0.25, 0.08, 0.12} : std::vector{0.13, 0.59, 0.14, 0.07, 0.07}));
  law.stiffness_n_per_m = rounded(stiffness_n_per_m);
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

RecordedColumns draw_columns(RandomStream& random, bool is_loop) {
  switch (random.weighted(is_loop ? std::vector{0.3, 0.1, 0.0, 0.6} : std::vector{0.45, 0.22, 0.13, 0.2})) {
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

/// White, coloured, or with the hum of the mains, a third each.
NoiseModel draw_noise(double signal_rms, RandomStream& random) {
  NoiseModel noise;
  noise.standard_deviation = rounded(signal_rms * std::pow(10.0, -random.uniform(40.0, 75.0) / 20.0));
  const std::size_t kind = random.index(3);
  if (kind == 1) noise.memory = random.uniform(0.6, 0.97);
  if (kind == 2) noise.hum_hz = random.chance(0.5) ? 50.0 : 60.0;
  return noise;
}

/// Of slow motion.
double delay_of(const TransferModel& model) {
  switch (model.kind) {
    case TransferKind::ideal: return 0.0;
    case TransferKind::delay: return model.delay_s;
    case TransferKind::first_order: return 1.0 / (kTwoPi * model.bandwidth_hz);
    case TransferKind::second_order:
      return model.delay_s + 2.0 * model.damping_ratio / (kTwoPi * model.natural_frequency_hz);
  }
  return 0.0;
}

Site draw_loop_site(double rate_hz, double stroke_m, double stiffness_n_per_m, RandomStream& random) {
  Site site;
  site.rate_hz = rate_hz;
  site.transfer_system = draw_transfer_system(random, true);
  site.specimen = draw_law(random, stroke_m, stiffness_n_per_m, true);
  // Its setting is what the user knows; whether it suits the actuator is another matter.
  const double delay_s = delay_of(site.transfer_system) * random.uniform(0.75, 1.1);
  if (random.chance(0.85)) site.compensator = {static_cast<int>(1 + random.index(3)), rounded(delay_s)};
  return site;
}

double largest(const std::vector<PlantRecording>& recordings) {
  double most = 0.0;
  for (const PlantRecording& recording : recordings) {
    for (std::size_t i = 0; i < recording.measured_m.size(); ++i) {
      if (!std::isfinite(recording.measured_m[i]) || !std::isfinite(recording.measured_n[i])) return HUGE_VAL;
      most = std::max(most, std::abs(recording.measured_m[i]));
    }
  }
  return most;
}

void scale(History& values, double factor) {
  for (double& value : values) value *= factor;
}

/// Scales the ground motions until the tested storey moves by about its stroke, and keeps what was sent.
/// @returns whether the loop is stable.
bool plan_loop(CaseSetting& setting, double stroke_m) {
  LoopSetting& loop = *setting.loop;
  RandomStream silent{0, 0, "no noise yet"};
  std::vector<History*> grounds;
  for (History& ground : loop.fit_ground_m_per_s2) grounds.push_back(&ground);
  grounds.push_back(&loop.held_out_ground_m_per_s2);
  double guess = 0.0;
  setting.fit_m.clear();
  for (History* ground : grounds) {
    if (guess > 0.0) scale(*ground, guess);
    PlantRecording here;
    for (int round = 0; round < 3; ++round) {
      const std::vector<PlantRecording> recordings = run_test(setting, {}, *ground, silent);
      const double most = largest(recordings);
      if (!std::isfinite(most) || (round > 0 && most > kRunaway * stroke_m)) return false;
      here = recordings.front();
      const double factor = stroke_m / peak(here.measured_m);
      if (factor > 0.8 && factor < 1.25) break;
      if (round == 2) break;
      scale(*ground, factor);
      guess = (guess > 0.0 ? guess : 1.0) * factor;
    }
    if (ground == &loop.held_out_ground_m_per_s2) {
      setting.held_out_m = here.sent_m;
    } else {
      setting.fit_m.push_back(here.sent_m);
    }
  }
  return true;
}

/// A building of which the lowest one or two storeys are tested; more damping where the first draw is not stable.
/// @returns false for a loop that no damping keeps stable.
bool draw_loop(CaseSetting& setting, const ExcitationSettings& excitation, RandomStream& random,
               RandomStream& motions) {
  const double stiffness = random.log_uniform(1e4, 1e8);
  const std::size_t storeys = 1 + random.index(3);
  History stiffnesses;
  for (std::size_t i = 0; i < storeys; ++i) stiffnesses.push_back(stiffness * random.uniform(0.7, 1.2));
  LoopSetting loop;
  const bool has_other = storeys > 1 && random.chance(0.4);
  const std::size_t here = has_other && random.chance(0.5) ? 1 : 0;
  setting.site = draw_loop_site(excitation.rate_hz, excitation.stroke_m, stiffnesses[here], random);
  stiffnesses[here] = setting.site.specimen.stiffness_n_per_m;
  double late_s = delay_of(setting.site.transfer_system) - setting.site.compensator.delay_s;
  if (has_other) {
    loop.other = draw_loop_site(excitation.rate_hz, excitation.stroke_m, stiffnesses[1 - here], random);
    loop.other_is_first = here == 1;
    stiffnesses[1 - here] = loop.other->specimen.stiffness_n_per_m;
    late_s = std::max(late_s, delay_of(loop.other->transfer_system) - loop.other->compensator.delay_s);
  }
  const double lowest_hz = random.log_uniform(0.7, 2.5);
  const std::size_t fits = motions.chance(0.25) ? 2 : 1;
  for (std::size_t i = 0; i <= fits; ++i) {
    History ground = ground_motion(excitation.rate_hz, excitation.duration_s, excitation.rest_s, motions);
    if (i < fits) {
      loop.fit_ground_m_per_s2.push_back(std::move(ground));
    } else {
      loop.held_out_ground_m_per_s2 = std::move(ground);
    }
  }
  // A delay is negative damping: of half the angle that passes in it.
  double damping_ratio = random.uniform(0.02, 0.05) + std::max(0.0, 0.6 * kTwoPi * lowest_hz * late_s);
  for (int attempt = 0; attempt < 4; ++attempt, damping_ratio *= 2.0) {
    loop.building = shear_building(stiffnesses, lowest_hz, damping_ratio);
    setting.loop = loop;
    if (plan_loop(setting, excitation.stroke_m)) return true;
  }
  return false;
}

void draw_planned_motion(CaseSetting& setting, ExcitationSettings excitation, RandomStream& random,
                         RandomStream& motions) {
  Site& site = setting.site;
  setting.loop.reset();
  site = {};
  site.rate_hz = excitation.rate_hz;
  site.transfer_system = draw_transfer_system(random, false);
  site.specimen = draw_law(random, excitation.stroke_m, random.log_uniform(1e4, 1e8), false);
  if (site.specimen.kind == LawKind::none) draw_known_effects(site, random, excitation.stroke_m);
  if (random.chance(0.5)) {
    site.compensator = {static_cast<int>(1 + random.index(3)), rounded(random.log_uniform(0.008, 0.03))};
  }
  setting.fit_m.clear();
  const std::size_t fits = motions.chance(0.25) ? 2 : 1;
  for (std::size_t i = 0; i < fits; ++i) {
    setting.fit_m.push_back(draw_excitation(excitation, motions));
    excitation.stroke_m *= motions.uniform(0.5, 1.0);
  }
  excitation.stroke_m = peak(setting.fit_m.front()) * motions.uniform(0.85, 1.15);
  setting.held_out_m = draw_excitation(excitation, motions);
}

}  // namespace

double rounded(double value, int digits) {
  if (value == 0.0) return 0.0;
  const double unit = std::pow(10.0, std::floor(std::log10(std::abs(value))) - digits + 1);
  return unit < 1.0 ? std::round(value / unit) / std::round(1.0 / unit) : std::round(value / unit) * unit;
}

std::vector<PlantRecording> run_test(const CaseSetting& setting, const PlantEffects& effects,
                                     const History& ground_m_per_s2, RandomStream& noise) {
  const LoopSetting& loop = *setting.loop;
  std::vector<TestedStorey> tested{{setting.site, effects}};
  if (loop.other) tested.push_back({*loop.other, {}});
  if (loop.other_is_first) std::swap(tested[0], tested[1]);
  std::vector<PlantRecording> recordings = run_closed_loop(loop.building, tested, ground_m_per_s2, noise);
  if (loop.other_is_first) std::swap(recordings[0], recordings[1]);
  return recordings;
}

bool is_stable(const std::vector<PlantRecording>& recordings, double stroke_m) {
  return largest(recordings) < kRunaway * stroke_m;
}

CaseSetting draw_case_setting(std::uint64_t seed, std::uint64_t index) {
  RandomStream random{seed, index, "site"};
  RandomStream motions{seed, index, "excitation"};
  CaseSetting setting;
  ExcitationSettings excitation;
  excitation.rate_hz = std::vector<double>{256.0, 400.0, 512.0, 800.0, 1024.0}[random.index(5)];
  excitation.duration_s = std::round(random.uniform(10.0, 18.0));
  excitation.stroke_m = random.log_uniform(0.005, 0.15);
  excitation.velocity_m_per_s = random.log_uniform(0.1, 1.0);
  excitation.rest_s = random.chance(0.8) ? random.uniform(0.5, 1.5) : 0.0;
  const bool is_loop = random.chance(kLoopShare) && draw_loop(setting, excitation, random, motions);
  if (!is_loop) draw_planned_motion(setting, excitation, random, motions);
  setting.columns = draw_columns(random, is_loop);

  Site& site = setting.site;
  const TrueSignals signals = run_plant(site, {}, setting.fit_m.front());
  setting.scales = scales_of(site, signals);
  site.displacement_noise_m = draw_noise(rms(signals.read_m), random);
  site.force_noise_n = draw_noise(rms(signals.read_n), random);
  if (is_loop && setting.loop->other) {
    Site& other = *setting.loop->other;
    other.displacement_noise_m = draw_noise(rms(signals.read_m), random);
    other.force_noise_n = draw_noise(rms(signals.read_n), random);
  }
  return setting;
}

}  // namespace hybridtest::blind
