// Simulated rigs: the transfer systems, specimens and sensors that a scenario or a site file can name.

#include "scenario/catalogue/simulated_rig.hpp"

#include <algorithm>
#include <numbers>
#include <string>
#include <utility>

#include "experimental_site/rigs/simulated_rig.hpp"
#include "plant/specimens/elastic_specimen.hpp"
#include "plant/specimens/law_specimen.hpp"
#include "plant/transfer_systems/delay.hpp"
#include "plant/transfer_systems/first_order.hpp"
#include "plant/transfer_systems/ideal.hpp"
#include "plant/transfer_systems/second_order.hpp"
#include "plant/transfer_systems/servo_hydraulic.hpp"
#include "scenario/catalogue/effects.hpp"
#include "scenario/catalogue/laws.hpp"
#include "scenario/catalogue/part.hpp"

namespace hybridtest {
namespace {
using config::Section;

struct TransferSystemReading {
  std::function<std::unique_ptr<TransferSystem>(double period_s, double delay_change_s)> make;
  double delay_s = 0.0;       // at low frequency
  double pure_delay_s = 0.0;  // of it, without any lag
};

TransferSystemReading read_ideal(Section&) {
  return {.make = [](double, double) { return std::make_unique<Ideal>(); }};
}

TransferSystemReading read_delay(Section& section) {
  const double delay_s = section.number("delay_s", {.low = 0.0, .high = 10.0});
  return {.make =
              [delay_s](double period_s, double delay_change_s) {
                return std::make_unique<Delay>(from_seconds(delay_s + delay_change_s), from_seconds(period_s));
              },
          .delay_s = delay_s,
          .pure_delay_s = delay_s};
}

TransferSystemReading read_first_order(Section& section) {
  const double time_constant_s = section.has("time_constant_s")
                                     ? section.number("time_constant_s", kPositive)
                                     : 1.0 / (2.0 * std::numbers::pi * section.number("bandwidth_hz", kPositive));
  return {.make = [time_constant_s](
                      double period_s,
                      double) { return std::make_unique<FirstOrder>(time_constant_s, from_seconds(period_s)); },
          .delay_s = time_constant_s};
}

TransferSystemReading read_second_order(Section& section) {
  const SecondOrder::Parameters parameters{
      .natural_frequency_hz = section.number("natural_frequency_hz", kPositive),
      .damping_ratio = section.number("damping_ratio", {.low = 0.0, .high = 10.0, .low_open = true}),
      .delay = from_seconds(section.number("delay_s", {.low = 0.0, .high = 10.0}, 0.0)),
  };
  const double delay_s = to_seconds(parameters.delay);
  return {.make =
              [parameters](double period_s, double delay_change_s) {
                SecondOrder::Parameters changed = parameters;
                changed.delay += from_seconds(delay_change_s);
                return std::make_unique<SecondOrder>(changed, from_seconds(period_s));
              },
          .delay_s = parameters.damping_ratio / (std::numbers::pi * parameters.natural_frequency_hz) + delay_s,
          .pure_delay_s = delay_s};
}

TransferSystemReading read_servo_hydraulic(Section& section) {
  ServoHydraulic::Parameters p;
  const auto required = [&](std::string_view key, double& value) { value = section.number(key, kPositive); };
  const auto optional = [&](std::string_view key, double& value) { value = section.number(key, kNotNegative, value); };
  required("piston_area_m2", p.piston_area_m2);
  required("supply_pressure_pa", p.supply_pressure_pa);
  required("rated_flow_m3_per_s", p.rated_flow_m3_per_s);
  required("stroke_m", p.stroke_m);
  required("oil_volume_m3", p.oil_volume_m3);
  required("moving_mass_kg", p.moving_mass_kg);
  required("valve_frequency_hz", p.valve_frequency_hz);
  required("proportional_gain_per_m", p.proportional_gain_per_m);
  p.load_stiffness_n_per_m = section.number("load_stiffness_n_per_m", kNotNegative);
  optional("bulk_modulus_pa", p.bulk_modulus_pa);
  optional("leakage_m3_per_s_pa", p.leakage_m3_per_s_pa);
  optional("damping_n_s_per_m", p.damping_n_s_per_m);
  optional("valve_damping_ratio", p.valve_damping_ratio);
  optional("integral_gain_per_m_s", p.integral_gain_per_m_s);
  optional("derivative_gain_s_per_m", p.derivative_gain_s_per_m);
  optional("command_gain", p.command_gain);
  // The loop's integrator, x' = Kp Qr / A (u - x), and the valve in front of it.
  const double loop_s = p.piston_area_m2 / (p.proportional_gain_per_m * p.rated_flow_m3_per_s);
  const double rate_s = p.derivative_gain_s_per_m / p.proportional_gain_per_m;
  return {.make = [p](double period_s, double) { return std::make_unique<ServoHydraulic>(p, from_seconds(period_s)); },
          .delay_s = std::max(0.0, loop_s - rate_s)};
}

TransferSystemReading read_transfer_system(Section section) {
  return read_type<TransferSystemReading>(section, {{"ideal", read_ideal},
                                                    {"delay", read_delay},
                                                    {"first_order", read_first_order},
                                                    {"second_order", read_second_order},
                                                    {"servo_hydraulic", read_servo_hydraulic}});
}

void read_transfer_systems(Section& section, SimulatedSiteReading& site) {
  std::vector<TransferSystemReading> readings;
  for (const Section& entry : section.sections("transfer_system", true)) {
    readings.push_back(read_transfer_system(entry));
  }
  const std::size_t dofs = site.dofs.size();
  if (readings.size() == 1) readings.resize(dofs, readings.front());
  expect_count(section, "transfer_system", readings.size(), static_cast<int>(dofs));
  for (std::size_t i = 0; i < std::min(readings.size(), dofs); ++i) {
    site.dofs[i].make_transfer_system = readings[i].make;
    site.dofs[i].removable_delay_s = readings[i].pure_delay_s;
    site.transfer_delay_s = std::max(site.transfer_delay_s, readings[i].delay_s);
  }
}

void read_specimen(Section& section, SimulatedSiteReading& site) {
  std::vector<Section> entries = section.sections("specimen", true);
  const std::size_t dofs = site.dofs.size();
  if (entries.size() == 1 && entries.front().has("stiffness_matrix_n_per_m")) {
    Section& entry = entries.front();
    static_cast<void>(entry.choice("type", {"elastic"}));
    const Eigen::MatrixXd stiffness = entry.matrix("stiffness_matrix_n_per_m", dofs, dofs);
    entry.finish();
    site.make_full_stiffness = [stiffness] { return std::make_unique<ElasticSpecimen>(stiffness); };
    return;
  }
  std::vector<Maker<Law>> makers;
  for (const Section& entry : entries) makers.push_back(read_specimen_law(entry));
  expect_count(section, "specimen", makers.size(), static_cast<int>(dofs));
  for (std::size_t i = 0; i < std::min(makers.size(), dofs); ++i) site.dofs[i].make_law = makers[i];
}

void read_sensors(Section section, SimulatedSiteReading& site) {
  SensorNoise noise;
  noise.displacement_noise_m = section.number("displacement_noise_m", kNotNegative, 0.0);
  noise.force_noise_n = section.number("force_noise_n", kNotNegative, 0.0);
  noise.seed = static_cast<std::uint64_t>(section.integer("seed", 0, std::int64_t{1} << 53, 0));
  section.finish();
  for (std::size_t i = 0; i < site.dofs.size(); ++i) {
    site.dofs[i].noise = noise;
    site.dofs[i].noise.first_stream = 2 * i;
  }
}

void read_site_effects(Section& section, SimulatedSiteReading& site) {
  const auto dofs = static_cast<int>(site.dofs.size());
  for (const ListedEffect& effect : read_effects(section, site_interfaces(), dofs)) {
    for (int dof = effect.dof.value_or(0); dof < effect.dof.value_or(dofs - 1) + 1; ++dof) {
      site.dofs[static_cast<std::size_t>(dof)].effects.push_back(effect.setting);
    }
  }
}

std::unique_ptr<Specimen> make_specimen(const SimulatedSiteReading& site) {
  if (site.make_full_stiffness) return site.make_full_stiffness();
  std::vector<std::unique_ptr<Law>> laws;
  for (const SiteModel& dof : site.dofs) laws.push_back(dof.make_law ? dof.make_law() : nullptr);
  return std::make_unique<LawSpecimen>(std::move(laws));
}

}  // namespace

SimulatedSiteReading read_simulated_site(Section& section, int dofs, AbsentPart absent) {
  SimulatedSiteReading site;
  site.dofs.resize(static_cast<std::size_t>(dofs));
  for (SiteModel& dof : site.dofs) {
    dof.make_transfer_system = [](double, double) { return std::make_unique<Ideal>(); };
  }
  const bool needs_all = absent == AbsentPart::refused;
  if (needs_all || section.has("transfer_system")) read_transfer_systems(section, site);
  if (needs_all || section.has("specimen")) read_specimen(section, site);
  read_sensors(section.section_or_empty("sensors"), site);
  read_site_effects(section, site);
  return site;
}

RigReading read_simulated_rig(Section& section, int dofs, std::uint64_t first_noise_stream) {
  SimulatedSiteReading site = read_simulated_site(section, dofs, AbsentPart::refused);
  site.dofs.front().noise.first_stream = first_noise_stream;
  RigReading reading;
  reading.type = "simulated";
  reading.transfer_delay_s = site.transfer_delay_s;
  reading.make = [site](double period_s) {
    std::vector<std::unique_ptr<TransferSystem>> transfer_systems;
    std::vector<SimulatedRig::Effects> effects;
    for (const SiteModel& dof : site.dofs) {
      transfer_systems.push_back(dof.make_transfer_system(period_s, delay_change_s(dof)));
      effects.push_back(SimulatedRig::effects_of(dof, period_s));
    }
    return std::make_unique<SimulatedRig>(std::move(transfer_systems), make_specimen(site), site.dofs.front().noise,
                                          from_seconds(period_s), std::move(effects));
  };
  return reading;
}

}  // namespace hybridtest
