#include "validation/blind_batches/plant/case_setting.hpp"

#include <algorithm>
#include <cmath>

#include "validation/blind_batches/plant/excitation.hpp"
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

}  // namespace hybridtest::blind
