// Simulated rigs: the transfer systems, specimens and sensors that a scenario or a site file can name.

#include "scenario/catalogue/simulated_rig.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/text/scalar.hpp"
#include "experimental_site/rigs/simulated_rig.hpp"
#include "mechanics/laws/elastic.hpp"
#include "numerical_substructure/elastic_matrix.hpp"
#include "numerical_substructure/spring_network.hpp"
#include "plant/effects/recorded_input.hpp"
#include "plant/specimens/elastic_specimen.hpp"
#include "plant/specimens/law_specimen.hpp"
#include "plant/specimens/specimen_in_transfer_system.hpp"
#include "plant/transfer_systems/ideal.hpp"
#include "scenario/catalogue/effects.hpp"
#include "scenario/catalogue/laws.hpp"
#include "scenario/catalogue/part.hpp"
#include "scenario/catalogue/transfer_systems.hpp"

namespace hybridtest {
namespace {
using config::Section;

constexpr const char* kLawsInParallel =
    "; laws in parallel on one degree of freedom are written {type: parallel, laws: [...]}";

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
    site.dofs[i].has_bandwidth = readings[i].has_bandwidth;
    site.transfer_delay_s[i] = readings[i].delay_s;
    site.rating.displacement_m = std::min(site.rating.displacement_m, readings[i].rating.displacement_m);
    site.rating.velocity_m_per_s = std::min(site.rating.velocity_m_per_s, readings[i].rating.velocity_m_per_s);
    site.rating.force_n = std::min(site.rating.force_n, readings[i].rating.force_n);
  }
  const auto has_specimen = [](const TransferSystemReading& reading) {
    return reading.specimen_stiffness_n_per_m > 0.0;
  };
  if (std::ranges::none_of(readings, has_specimen)) return;
  if (!std::ranges::all_of(readings, has_specimen)) {
    section.error("transfer_system", "some have their specimen in their model, some not; expected all or none");
  }
  site.is_in_transfer_systems = true;
  for (std::size_t i = 0; i < std::min(readings.size(), dofs); ++i) {
    site.dofs[i].make_law = [stiffness_n_per_m = readings[i].specimen_stiffness_n_per_m] {
      return std::make_unique<Elastic>(stiffness_n_per_m);
    };
  }
}

void refuse_second_specimen(Section& section) {
  if (!section.has("specimen")) return;
  section.error("specimen", "the model of the transfer system has the specimen in it; expected no other");
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
  expect_count(section, "specimen", makers.size(), static_cast<int>(dofs), kLawsInParallel);
  for (std::size_t i = 0; i < std::min(makers.size(), dofs); ++i) site.dofs[i].make_law = makers[i];
}

void read_sensors(Section section, SimulatedSiteReading& site) {
  SensorNoise noise;
  noise.displacement_noise_m = section.number("displacement_noise_m", kNotNegative, 0.0);
  noise.force_noise_n = section.number("force_noise_n", kNotNegative, 0.0);
  // Neither is written out where the file has neither: a scenario without them is the same as before.
  const auto read_coloured = [&](const char* level, const char* correlation_time, double& noise_level, double& time_s) {
    const bool has_level = section.has_optional(level);
    if (!section.has_optional(correlation_time) && !has_level) return;
    noise_level = section.number(level, kNotNegative);
    time_s = section.number(correlation_time, kPositive);
  };
  read_coloured("displacement_coloured_noise_m", "displacement_correlation_time_s", noise.displacement_coloured_noise_m,
                noise.displacement_correlation_time_s);
  read_coloured("force_coloured_noise_n", "force_correlation_time_s", noise.force_coloured_noise_n,
                noise.force_correlation_time_s);
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

using TransferSystems = std::vector<std::unique_ptr<TransferSystem>>;

TransferSystems make_transfer_systems(const SimulatedSiteReading& site, double period_s) {
  TransferSystems made;
  for (const SiteModel& dof : site.dofs) made.push_back(transfer_system_of(dof, period_s));
  return made;
}

std::unique_ptr<Specimen> specimen_in(const TransferSystems& transfer_systems) {
  std::vector<const TransferSystem*> of;
  for (const auto& transfer_system : transfer_systems) of.push_back(transfer_system.get());
  return std::make_unique<SpecimenInTransferSystem>(std::move(of));
}

std::unique_ptr<Specimen> make_specimen(const SimulatedSiteReading& site) {
  if (site.make_full_stiffness) return site.make_full_stiffness();
  std::vector<std::unique_ptr<Law>> laws;
  for (const SiteModel& dof : site.dofs) laws.push_back(dof.make_law ? dof.make_law() : nullptr);
  return std::make_unique<LawSpecimen>(std::move(laws));
}

/// Largest step of the readings of that sensor; 0 without quantization.
double reading_step(const SimulatedSiteReading& site, EffectInterface sensor) {
  const EffectType* const quantization = find_effect(sensor, DigitTrace::rounding);
  double step = 0.0;
  for (const SiteModel& dof : site.dofs) {
    for (const EffectSetting& effect : dof.effects) {
      if (effect.type == quantization) step = std::max(step, effect.values.front());
    }
  }
  return step;
}

/// Inputs that effects follow, each at the value that stands for it in a rig.
std::vector<std::string> nominal_inputs(const SimulatedSiteReading& site) {
  std::vector<std::string> inputs;
  for (const SiteModel& dof : site.dofs) {
    for (const EffectSetting& effect : dof.effects) {
      if (effect.type->input.empty()) continue;
      const auto nominal = std::ranges::find(effect.type->parameters, kNominalInput.name, &EffectParameter::name);
      const double value = effect.values[static_cast<std::size_t>(nominal - effect.type->parameters.begin())];
      std::string text = std::string{effect.type->input} + " at " + written_number(value);
      if (std::ranges::find(inputs, text) == inputs.end()) inputs.push_back(std::move(text));
    }
  }
  return inputs;
}

/// A force without noise reads the same on a plateau, in a gap and without a specimen.
bool force_always_varies(const SimulatedSiteReading& site) {
  const SensorNoise& noise = site.dofs.front().noise;
  return (noise.force_noise_n > 0.0 || noise.force_coloured_noise_n > 0.0) &&
         reading_step(site, EffectInterface::force_sensor) == 0.0;
}

/// Without a law, the effects are the specimen.
bool has_whole_specimen(const SimulatedSiteReading& site) {
  return site.make_full_stiffness || std::ranges::all_of(site.dofs, [](const SiteModel& dof) {
           return dof.make_law || std::ranges::none_of(dof.effects, [](const EffectSetting& effect) {
                    return effect.type->interface == EffectInterface::specimen;
                  });
         });
}

Eigen::MatrixXd secant_stiffness(Specimen& specimen, double displacement_m) {
  const int dofs = specimen.dofs();
  const SiteVector no_velocity = SiteVector::Zero(dofs);
  SiteVector pushed_m = SiteVector::Zero(dofs);
  SiteVector force_n = SiteVector::Zero(dofs);
  Eigen::MatrixXd stiffness_n_per_m{dofs, dofs};
  for (int k = 0; k < dofs; ++k) {
    pushed_m.setZero();
    pushed_m[k] = displacement_m;
    specimen.reset();
    specimen.impose(pushed_m, no_velocity, force_n);
    stiffness_n_per_m.col(k) = force_n / displacement_m;
  }
  return stiffness_n_per_m;
}

/// Empty without a law for each degree of freedom.
std::function<std::unique_ptr<SubstructureModel>()> specimen_model(const SimulatedSiteReading& site) {
  if (site.is_in_transfer_systems) return {};  // its mass is no part of such a model
  if (site.make_full_stiffness) {
    return
        [make = site.make_full_stiffness] { return std::make_unique<ElasticMatrix>(secant_stiffness(*make(), 1.0)); };
  }
  std::vector<Maker<Law>> laws;
  for (const SiteModel& dof : site.dofs) {
    if (!dof.make_law) return {};
    laws.push_back(dof.make_law);
  }
  return [laws] { return std::make_unique<SpringNetwork>(springs_to_ground(make_all(laws))); };
}

}  // namespace

SimulatedSiteReading read_simulated_site(Section& section, int dofs, AbsentPart absent) {
  SimulatedSiteReading site;
  site.dofs.resize(static_cast<std::size_t>(dofs));
  site.transfer_delay_s.resize(static_cast<std::size_t>(dofs), 0.0);
  for (SiteModel& dof : site.dofs) {
    dof.make_transfer_system = [](double, double) { return std::make_unique<Ideal>(); };
  }
  const bool needs_all = absent == AbsentPart::refused;
  if (needs_all || section.has("transfer_system")) read_transfer_systems(section, site);
  if (site.is_in_transfer_systems) {
    refuse_second_specimen(section);
  } else if (needs_all || section.has("specimen")) {
    read_specimen(section, site);
  }
  read_sensors(section.section_or_empty("sensors"), site);
  read_site_effects(section, site);
  return site;
}

RigReading read_simulated_rig(Section& section, int dofs, std::uint64_t first_noise_stream, AbsentPart absent) {
  SimulatedSiteReading site = read_simulated_site(section, dofs, absent);
  site.dofs.front().noise.first_stream = first_noise_stream;
  RigReading reading;
  reading.type = "simulated";
  reading.transfer_delay_s = site.transfer_delay_s;
  reading.rating = site.rating;
  const SensorNoise& noise = site.dofs.front().noise;
  reading.displacement_noise_m = std::hypot(noise.displacement_noise_m, noise.displacement_coloured_noise_m);
  reading.force_noise_n = std::hypot(noise.force_noise_n, noise.force_coloured_noise_n);
  reading.displacement_resolution_m = reading_step(site, EffectInterface::displacement_sensor);
  reading.force_always_varies = force_always_varies(site);
  reading.nominal_inputs = nominal_inputs(site);
  if (has_whole_specimen(site)) {
    reading.stiffness_n_per_m = [site](double displacement_m) {
      return secant_stiffness(*make_specimen(site), displacement_m);
    };
  }
  reading.make_specimen = specimen_model(site);
  reading.make_linear = [site, own = reading.stiffness_n_per_m](double period_s, double displacement_m,
                                                                const Eigen::MatrixXd& given) {
    TransferSystems transfer_systems = make_transfer_systems(site, period_s);
    if (site.is_in_transfer_systems) {
      auto specimen = specimen_in(transfer_systems);
      return std::make_unique<SimulatedRig>(std::move(transfer_systems), std::move(specimen), SensorNoise{},
                                            from_seconds(period_s));
    }
    Eigen::MatrixXd stiffness = own ? own(displacement_m) : given;
    const double largest = stiffness.cwiseAbs().maxCoeff();
    if (!(largest > 0.0 && std::isfinite(largest))) stiffness = given;
    return std::make_unique<SimulatedRig>(std::move(transfer_systems), std::make_unique<ElasticSpecimen>(stiffness),
                                          SensorNoise{}, from_seconds(period_s));
  };
  reading.make = [site](double period_s) {
    TransferSystems transfer_systems = make_transfer_systems(site, period_s);
    auto specimen = site.is_in_transfer_systems ? specimen_in(transfer_systems) : make_specimen(site);
    std::vector<SimulatedRig::Effects> effects;
    for (const SiteModel& dof : site.dofs) effects.push_back(SimulatedRig::effects_of(dof, period_s));
    return std::make_unique<SimulatedRig>(std::move(transfer_systems), std::move(specimen), site.dofs.front().noise,
                                          from_seconds(period_s), std::move(effects));
  };
  return reading;
}

}  // namespace hybridtest
