#include "validation/blind_batches/plant/effect_catalogue.hpp"

#include <algorithm>
#include <iterator>

namespace hybridtest::blind {
namespace {

using Setting = const CaseSetting&;

bool always(Setting /*setting*/) { return true; }
bool network_is_seen(Setting s) { return s.columns.sent && s.columns.target; }
bool compensator_is_seen(Setting s) { return s.columns.target && s.columns.command; }
bool actuator_is_seen(Setting s) { return s.columns.command; }
bool has_spring(Setting s) { return s.site.specimen.kind != LawKind::none; }
bool is_elastic(Setting s) { return s.site.specimen.kind == LawKind::elastic; }
bool is_hysteretic(Setting s) { return has_spring(s) && !is_elastic(s); }
/// If slip or damping holds the specimen, nothing springs back while the backlash is crossed.
bool stays_in_play(Setting s) { return has_spring(s) ? is_hysteretic(s) : s.site.known_mass_kg == 0.0; }
bool is_bilinear(Setting s) { return s.site.specimen.kind == LawKind::bilinear; }
bool loads_frame(Setting s) { return actuator_is_seen(s) && has_spring(s); }
/// The derivatives of an actuator without inertia jump with every new command.
bool has_acceleration(Setting s) { return !s.loop || s.site.transfer_system.kind == TransferKind::second_order; }
bool has_natural_frequency(Setting s) {
  return actuator_is_seen(s) && s.site.transfer_system.kind == TransferKind::second_order;
}

double stroke(Setting s) { return s.scales.displacement_m; }
double force(Setting s) { return s.scales.force_n; }
double stiffness(Setting s) { return force(s) / stroke(s); }
double away_from_one(RandomStream& r, double amount) { return 1.0 + r.sign() * std::min(0.6, amount); }
double seed(RandomStream& r) { return static_cast<double>(r.index(1'000'000)); }

/// Time constant of a sensor that warms.
double warming(RandomStream& r, Setting s) { return s.scales.duration_s * r.uniform(0.5, 3.0); }

/// Deflection before sliding.
double presliding(RandomStream& r, Setting s) { return stroke(s) * r.log_uniform(0.002, 0.02); }

Parameters wrong_delay(RandomStream& r, Setting s, double /*amount*/) {
  const double have_s = s.site.transfer_system.delay_s;
  const bool is_less = s.site.transfer_system.kind == TransferKind::delay && r.chance(0.5);
  return {{"delay_s", is_less ? -have_s * r.uniform(0.1, 0.9) : r.log_uniform(0.0005, 0.02)}};
}

Parameters wrong_setting(RandomStream& r, Setting s, double /*amount*/) {
  const double have_s = s.site.compensator.delay_s;
  if (have_s == 0.0) return {{"delay_s", r.log_uniform(0.005, 0.03)}};
  return {{"delay_s", have_s * (r.chance(0.5) ? r.uniform(0.3, 0.95) : r.uniform(1.05, 2.0))}};
}

Parameters coulomb(RandomStream& r, Setting s, double amount) {
  Parameters p{{"friction_force_n", amount * force(s)}, {"presliding_m", presliding(r, s)}};
  if (r.chance(0.25)) p["friction_force_backward_n"] = p["friction_force_n"] * r.uniform(0.4, 0.85);
  return p;
}

Parameters stribeck(RandomStream& r, Setting s, double amount) {
  Parameters p{{"friction_force_n", amount * force(s)}, {"presliding_m", presliding(r, s)}};
  p["static_force_n"] = p["friction_force_n"] * r.uniform(1.3, 2.5);
  p["stribeck_velocity_m_per_s"] = s.scales.velocity_m_per_s * r.log_uniform(0.01, 0.2);
  return p;
}

Parameters yielding(RandomStream& r, Setting s, double /*amount*/) {
  Parameters p{{"yield_force_n", force(s) * r.uniform(0.3, 0.95)}};
  p["hardening_ratio"] = r.uniform(0.0, 0.3);
  p["spread"] = r.uniform(0.1, 0.9);
  return p;
}

Parameters relaxation(RandomStream& r, Setting s, double amount) {
  return {{"stiffness_n_per_m", amount * stiffness(s)}, {"time_constant_s", r.log_uniform(0.1, 3.0)}};
}

Parameters fractional(RandomStream& r, Setting s, double amount) {
  Parameters p{{"force_n", std::max(0.02, amount) * force(s)}, {"stroke_m", stroke(s)}};
  p["order"] = r.uniform(0.2, 0.8);
  return p;
}

Parameters geometric(RandomStream& r, Setting s, double amount) {
  Parameters p{{"length_m", stroke(s) * r.uniform(5.0, 30.0)}};
  p["load_n"] = std::min(0.6, amount) * stiffness(s) * p["length_m"];
  return p;
}

}  // namespace

const std::vector<CatalogueEntry>& wrong_numbers() {
  static const std::vector<CatalogueEntry> entries{
      {"specimen", "stiffness_error", has_spring,
       [](RandomStream& r, Setting, double m) {
         return Parameters{{"stiffness_ratio", away_from_one(r, m)}};
       }},
      {"specimen", "strength_error", is_bilinear,
       [](RandomStream& r, Setting, double m) {
         return Parameters{{"strength_ratio", away_from_one(r, m)}};
       }},
      {"specimen", "viscous_damping", always,
       [](RandomStream&, Setting s, double m) {
         return Parameters{{"damping_n_s_per_m", m * force(s) / s.scales.velocity_m_per_s}};
       }},
      {"transfer_system", "delay", actuator_is_seen, wrong_delay},
      {"transfer_system", "bandwidth_error", has_natural_frequency,
       [](RandomStream& r, Setting s, double) {
         const double ratio = r.chance(0.6) ? r.uniform(0.4, 0.95) : r.uniform(1.05, 2.0);
         return Parameters{{"true_natural_frequency_hz", s.site.transfer_system.natural_frequency_hz * ratio}};
       }},
      {"compensator", "setting_mismatch", compensator_is_seen, wrong_setting},
  };
  return entries;
}

const std::vector<CatalogueEntry>& named_effects() {
  static const std::vector<CatalogueEntry> entries{
      {"network", "latency", network_is_seen,
       [](RandomStream& r, Setting, double) {
         return Parameters{{"delay_s", r.log_uniform(0.002, 0.05)}};
       }},
      {"network", "jitter", network_is_seen,
       [](RandomStream& r, Setting, double) {
         return Parameters{{"jitter_s", r.log_uniform(0.001, 0.02)}, {"seed", seed(r)}};
       }},
      {"network", "loss", network_is_seen,
       [](RandomStream& r, Setting, double) {
         return Parameters{{"loss_ratio", r.log_uniform(0.005, 0.2)}, {"seed", seed(r)}};
       }},
      {"network", "clock_offset", network_is_seen,
       [](RandomStream& r, Setting, double) {
         return Parameters{{"offset_s", r.log_uniform(0.002, 0.05)}};
       }},
      {"network", "clock_drift", network_is_seen,
       [](RandomStream& r, Setting, double) {
         return Parameters{{"drift_ratio", r.log_uniform(2e-4, 3e-3)}};
       }},
      {"compensator", "setting_mismatch", compensator_is_seen, wrong_setting},
      {"compensator", "bias", compensator_is_seen,
       [](RandomStream& r, Setting s, double m) {
         return Parameters{{"bias_m", r.sign() * m * stroke(s)}};
       }},
      {"transfer_system", "delay", actuator_is_seen, wrong_delay},
      {"transfer_system", "bandwidth", actuator_is_seen,
       [](RandomStream& r, Setting, double) {
         if (r.chance(0.5)) return Parameters{{"bandwidth_hz", r.log_uniform(5.0, 80.0)}};
         const double frequency_hz = r.log_uniform(8.0, 60.0);
         return Parameters{{"natural_frequency_hz", frequency_hz}, {"damping_ratio", r.uniform(0.5, 1.2)}};
       }},
      {"transfer_system", "gain", actuator_is_seen,
       [](RandomStream& r, Setting, double m) {
         return Parameters{{"gain", away_from_one(r, m)}};
       }},
      {"transfer_system", "backlash", actuator_is_seen,
       [](RandomStream&, Setting s, double m) {
         return Parameters{{"width_m", 0.6 * m * stroke(s)}};
       }},
      {"transfer_system", "deadband", actuator_is_seen,
       [](RandomStream&, Setting s, double m) {
         return Parameters{{"half_width_m", 0.3 * m * stroke(s)}};
       }},
      {"transfer_system", "velocity_limit", actuator_is_seen,
       [](RandomStream& r, Setting s, double) {
         return Parameters{{"velocity_m_per_s", s.scales.velocity_m_per_s * r.uniform(0.25, 0.95)}};
       }},
      {"transfer_system", "stroke_limit", actuator_is_seen,
       [](RandomStream& r, Setting s, double) {
         return Parameters{{"stroke_m", stroke(s) * r.uniform(0.4, 0.95)}};
       }},
      {"transfer_system", "compliance", loads_frame,
       [](RandomStream&, Setting s, double m) {
         return Parameters{{"stiffness_n_per_m", stiffness(s) / m}, {"closing_n", 0.2 * force(s)}};
       }},
      {"transfer_system", "stiction", actuator_is_seen,
       [](RandomStream& r, Setting s, double m) {
         return Parameters{{"breakaway_m", 0.5 * m * stroke(s)}, {"catching_up_hz", r.log_uniform(15.0, 150.0)}};
       }},
      {"displacement_sensor", "gain", always,
       [](RandomStream& r, Setting, double m) {
         return Parameters{{"gain", away_from_one(r, m)}};
       }},
      {"displacement_sensor", "bias", always,
       [](RandomStream& r, Setting s, double m) {
         return Parameters{{"bias_m", r.sign() * m * stroke(s)}};
       }},
      {"displacement_sensor", "drift", always,
       [](RandomStream& r, Setting s, double m) {
         return Parameters{{"drift_m_per_s", r.sign() * m * stroke(s) / s.scales.duration_s},
                           {"warming_s", warming(r, s)}};
       }},
      {"displacement_sensor", "lag", always,
       [](RandomStream& r, Setting, double) {
         return Parameters{{"time_constant_s", r.log_uniform(0.0005, 0.02)}};
       }},
      {"displacement_sensor", "quantization", always,
       [](RandomStream&, Setting s, double m) {
         return Parameters{{"step_m", 0.4 * m * stroke(s)}};
       }},
      {"specimen", "quadratic_damping", always,
       [](RandomStream&, Setting s, double m) {
         const double v = s.scales.velocity_m_per_s;
         return Parameters{{"damping_n_s2_per_m2", m * force(s) / (v * v)}, {"velocity_m_per_s", v}};
       }},
      {"specimen", "stiffness_error", has_spring,
       [](RandomStream& r, Setting, double m) {
         return Parameters{{"stiffness_ratio", away_from_one(r, m)}};
       }},
      {"specimen", "viscous_damping", always,
       [](RandomStream&, Setting s, double m) {
         return Parameters{{"damping_n_s_per_m", m * force(s) / s.scales.velocity_m_per_s}};
       }},
      {"specimen", "coulomb_friction", always, coulomb},
      {"specimen", "stribeck_friction", always, stribeck},
      {"specimen", "cubic_stiffness", always,
       [](RandomStream& r, Setting s, double m) {
         const double x = stroke(s);
         return Parameters{{"stiffness_n_per_m3", r.sign() * std::min(0.3, m) * 2.0 * force(s) / (x * x * x)},
                           {"stroke_m", x}};
       }},
      {"specimen", "yielding", is_elastic, yielding},
      {"specimen", "bouc_wen_hysteresis", always,
       [](RandomStream& r, Setting s, double m) {
         return Parameters{{"force_n", m * force(s)}, {"yield_displacement_m", stroke(s) * r.uniform(0.05, 0.4)}};
       }},
      {"specimen", "pinching", is_hysteretic,
       [](RandomStream& r, Setting s, double) {
         return Parameters{{"pinching_ratio", r.uniform(0.05, 0.8)}, {"width_m", stroke(s) * r.uniform(0.1, 0.4)}};
       }},
      {"specimen", "stiffness_degradation", is_elastic,
       [](RandomStream& r, Setting s, double) {
         return Parameters{{"degradation_per_m", r.log_uniform(0.001, 0.03) / stroke(s)}};
       }},
      {"specimen", "stiffness_degradation_with_peak", is_elastic,
       [](RandomStream& r, Setting s, double) {
         return Parameters{{"scale", stroke(s) / r.log_uniform(0.05, 0.8)}};
       }},
      {"specimen", "stiffness_degradation_with_time", is_elastic,
       [](RandomStream& r, Setting s, double) {
         return Parameters{{"scale", s.scales.duration_s / r.log_uniform(0.05, 0.8)}};
       }},
      {"specimen", "strength_degradation", is_bilinear,
       [](RandomStream& r, Setting s, double) {
         return Parameters{{"degradation_per_m", r.log_uniform(0.002, 0.03) / stroke(s)}};
       }},
      {"specimen", "gap", has_spring,
       [](RandomStream&, Setting s, double m) {
         return Parameters{{"clearance_m", 0.6 * m * stroke(s)}};
       }},
      {"specimen", "backlash", stays_in_play,
       [](RandomStream&, Setting s, double m) {
         return Parameters{{"width_m", m * stroke(s)}};
       }},
      {"specimen", "contact", always,
       [](RandomStream& r, Setting s, double) {
         return Parameters{{"stiffness_n_per_m", stiffness(s) * r.log_uniform(0.05, 3.0)},
                           {"distance_m", stroke(s) * r.uniform(0.05, 0.8)},
                           {"stroke_m", stroke(s)}};
       }},
      {"specimen", "relaxation", always, relaxation},
      {"specimen", "fractional_damping", always, fractional},
      {"specimen", "inertia", has_acceleration,
       [](RandomStream&, Setting s, double m) {
         return Parameters{{"mass_kg", m * force(s) / s.scales.acceleration_m_per_s2}};
       }},
      {"specimen", "geometric_stiffness", has_spring, geometric},
      {"specimen", "fracture", has_spring,
       [](RandomStream& r, Setting s, double) {
         return Parameters{{"time_s", s.scales.duration_s * r.uniform(0.3, 0.7)}, {"lost_ratio", r.uniform(0.02, 0.5)}};
       }},
      {"force_sensor", "gain", always,
       [](RandomStream& r, Setting, double m) {
         return Parameters{{"gain", away_from_one(r, m)}};
       }},
      {"force_sensor", "bias", always,
       [](RandomStream& r, Setting s, double m) {
         return Parameters{{"bias_n", r.sign() * m * force(s)}};
       }},
      {"force_sensor", "drift", always,
       [](RandomStream& r, Setting s, double m) {
         return Parameters{{"drift_n_per_s", r.sign() * m * force(s) / s.scales.duration_s},
                           {"warming_s", warming(r, s)}};
       }},
      {"force_sensor", "lag", always,
       [](RandomStream& r, Setting, double) {
         return Parameters{{"time_constant_s", r.log_uniform(0.0005, 0.02)}};
       }},
      {"force_sensor", "saturation", always,
       [](RandomStream& r, Setting s, double) {
         return Parameters{{"limit_n", force(s) * r.uniform(0.4, 0.97)}};
       }},
      {"force_sensor", "quantization", always,
       [](RandomStream&, Setting s, double m) {
         return Parameters{{"step_n", 0.4 * m * force(s)}};
       }},
      {"force_sensor", "time_skew", always,
       [](RandomStream& r, Setting, double) {
         return Parameters{{"skew_s", r.log_uniform(0.0003, 0.01)}};
       }},
  };
  return entries;
}

const std::vector<CatalogueEntry>& foreign_effects() {
  const auto placed = [](RandomStream& r, Setting s, double m) {
    Parameters p{{"force_n", std::max(0.02, m) * force(s)}, {"stroke_m", stroke(s)}, {"seed", seed(r)}};
    p["velocity_m_per_s"] = s.scales.velocity_m_per_s;
    p["pitch_m"] = stroke(s) * r.uniform(0.15, 0.5);
    p["place_m"] = stroke(s) * r.uniform(-0.5, 0.5);
    p["distance_m"] = stroke(s) * r.uniform(0.05, 0.3);
    return p;
  };
  const auto hunting = [](RandomStream& r, Setting s, double m) {
    Parameters p{{"amplitude_m", 0.5 * m * stroke(s)}, {"stroke_m", stroke(s)}, {"seed", seed(r)}};
    p["frequency_hz"] = r.uniform(12.0, 35.0);
    p["damping_ratio"] = r.uniform(0.01, 0.04);
    p["share"] = r.uniform(0.2, 0.9);
    p["delay_s"] = r.log_uniform(0.002, 0.02);
    return p;
  };
  const auto ringing = [](RandomStream& r, Setting s, double m) {
    Parameters p{{"mass_kg", m * force(s) / s.scales.acceleration_m_per_s2}, {"seed", seed(r)}};
    p["frequency_hz"] = r.uniform(6.0, 25.0);
    p["damping_ratio"] = r.uniform(0.01, 0.04);
    p["share"] = m;
    return p;
  };
  const auto echo = [](RandomStream& r, Setting, double m) {
    return Parameters{{"share", m}, {"delay_s", r.uniform(0.15, 0.6)}};
  };
  static const std::vector<CatalogueEntry> entries{
      {"specimen", "random_stick_slip", always, placed},
      {"specimen", "magnetic_memory", always, placed},
      {"specimen", "self_excitation", always, placed},
      {"specimen", "cogging", always, placed},
      {"specimen", "snap_through", always, placed},
      {"specimen", "place_dependent_friction", always, placed},
      {"specimen", "thermal_stiffness", always, placed},
      {"specimen", "echo", always, echo},
      {"force_sensor", "gain_walk", always, ringing},
      {"force_sensor", "acceleration_crosstalk", has_acceleration, ringing},
      {"transfer_system", "amplitude_dependent_delay", actuator_is_seen, hunting},
      {"transfer_system", "limit_cycle", actuator_is_seen, hunting},
      {"transfer_system", "frame_resonance", actuator_is_seen, hunting},
      {"transfer_system", "pump_ripple", actuator_is_seen, hunting},
  };
  return entries;
}

std::vector<CatalogueEntry> fitting(const std::vector<CatalogueEntry>& catalogue, const CaseSetting& setting) {
  std::vector<CatalogueEntry> result;
  std::ranges::copy_if(catalogue, std::back_inserter(result), [&](const CatalogueEntry& e) { return e.fits(setting); });
  return result;
}

}  // namespace hybridtest::blind
