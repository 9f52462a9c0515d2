#include "launch/compose.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "coordinator/central_difference.hpp"
#include "coordinator/explicit_newmark.hpp"
#include "experimental_site/rigs/elastic_specimen.hpp"
#include "experimental_site/rigs/law_specimen.hpp"
#include "experimental_site/rigs/simulated_rig.hpp"
#include "experimental_site/transfer_systems/delay.hpp"
#include "experimental_site/transfer_systems/first_order.hpp"
#include "experimental_site/transfer_systems/ideal.hpp"
#include "experimental_site/transfer_systems/second_order.hpp"
#include "launch/named_type.hpp"
#include "mechanics/bilinear.hpp"
#include "mechanics/bouc_wen.hpp"
#include "mechanics/elastic.hpp"
#include "mechanics/giuffre_menegotto_pinto.hpp"
#include "numerical_substructure/elastic_matrix.hpp"
#include "numerical_substructure/matrix_market.hpp"
#include "numerical_substructure/shear_building.hpp"
#include "numerical_substructure/springs.hpp"

namespace hybridtest {
namespace {

using config::kNotNegative;
using config::kPositive;
using config::Range;
using config::Section;

constexpr Range kShareBelowOne{.low = 0.0, .high = 1.0, .high_open = true};

template <class Part, class Parameters>
auto maker_of(const Parameters& parameters) {
  return [parameters] { return std::make_unique<Part>(parameters); };
}

Maker<Law> read_elastic(Section& section) {
  const double stiffness = section.number("stiffness_n_per_m", kPositive);
  return maker_of<Elastic>(stiffness);
}

Maker<Law> read_bilinear(Section& section) {
  return maker_of<Bilinear>(Bilinear::Parameters{
      .stiffness_n_per_m = section.number("stiffness_n_per_m", kPositive),
      .yield_force_n = section.number("yield_force_n", kPositive),
      .hardening_ratio = section.number("hardening_ratio", kShareBelowOne),
  });
}

Maker<Law> read_giuffre_menegotto_pinto(Section& section) {
  return maker_of<GiuffreMenegottoPinto>(GiuffreMenegottoPinto::Parameters{
      .stiffness_n_per_m = section.number("stiffness_n_per_m", kPositive),
      .yield_force_n = section.number("yield_force_n", kPositive),
      .hardening_ratio = section.number("hardening_ratio", kShareBelowOne),
      .r0 = section.number("r0", {.low = 0.0, .high = 100.0, .low_open = true}, 20.0),
      .cr1 = section.number("cr1", kShareBelowOne, 0.925),
      .cr2 = section.number("cr2", kPositive, 0.15),
  });
}

Maker<Law> read_bouc_wen(Section& section) {
  return maker_of<BoucWen>(BoucWen::Parameters{
      .stiffness_n_per_m = section.number("stiffness_n_per_m", kPositive),
      .alpha = section.number("alpha", {.low = 0.0, .high = 1.0}),
      .n = section.number("n", {.low = 1.0, .high = 100.0}, 1.0),
      .gamma_per_m = section.number("gamma_per_m"),
      .beta_per_m = section.number("beta_per_m", kNotNegative),
      .ao = section.number("ao", kPositive, 1.0),
  });
}

const std::vector<NamedType<Maker<Law>>>& laws() {
  static const std::vector<NamedType<Maker<Law>>> table{
      {"elastic", read_elastic},
      {"bilinear", read_bilinear},
      {"giuffre_menegotto_pinto", read_giuffre_menegotto_pinto},
      {"bouc_wen", read_bouc_wen},
  };
  return table;
}

std::vector<std::unique_ptr<Law>> make_all(const std::vector<Maker<Law>>& makers) {
  std::vector<std::unique_ptr<Law>> made;
  for (const Maker<Law>& maker : makers) made.push_back(maker());
  return made;
}

std::vector<Maker<Law>> read_laws(Section& section, std::string_view key) {
  std::vector<Maker<Law>> makers;
  for (const Section& entry : section.sections(key, true)) makers.push_back(read_law(entry));
  return makers;
}

void expect_count(Section& section, std::string_view key, std::size_t found, int expected) {
  if (std::cmp_equal(found, expected)) return;
  section.error(key, std::to_string(found) + " given; expected " + std::to_string(expected) +
                         ", one for each interface degree of freedom");
}

/// A full stiffness: a number for one degree of freedom, a matrix, or a Matrix Market file.
std::function<Eigen::MatrixXd()> read_stiffness(Section& section, int dofs, const std::filesystem::path& directory) {
  if (section.has("matrix_market")) {
    const std::filesystem::path file = directory / section.text("matrix_market");
    return [file, dofs] {
      Eigen::MatrixXd matrix = read_matrix_market(file);
      if (matrix.rows() != dofs || matrix.cols() != dofs) {
        throw ConfigError{file.string() + ": a matrix of " + std::to_string(matrix.rows()) + " by " +
                          std::to_string(matrix.cols()) + "; the interface has " + std::to_string(dofs) +
                          " degrees of freedom"};
      }
      return matrix;
    };
  }
  const auto size = static_cast<std::size_t>(dofs);
  Eigen::MatrixXd matrix = dofs == 1 && !section.has("stiffness_matrix_n_per_m")
                               ? Eigen::MatrixXd::Constant(1, 1, section.number("stiffness_n_per_m", kPositive))
                               : section.matrix("stiffness_matrix_n_per_m", size, size);
  return [matrix] { return matrix; };
}

Maker<SubstructureModel> read_shear_building(Section& section, int dofs) {
  std::vector<Maker<Law>> storeys;
  if (section.has("storeys")) {
    storeys = read_laws(section, "storeys");
  } else {
    for (const double stiffness : section.numbers("storey_stiffness_n_per_m", 0, kPositive)) {
      storeys.push_back(maker_of<Elastic>(stiffness));
    }
  }
  const auto count = static_cast<int>(storeys.size());
  if (count != dofs && count != dofs - 1) {
    section.error("", std::to_string(count) + " storeys on " + std::to_string(dofs) +
                          " interface degrees of freedom; expected as many (the first storey stands on the ground) or "
                          "one less (the first degree of freedom is the base)");
  }
  const auto base = count == dofs ? ShearBuilding::Base::ground : ShearBuilding::Base::first_dof;
  return [storeys, base] { return std::make_unique<ShearBuilding>(make_all(storeys), base); };
}

using TransferSystemMaker = std::function<std::unique_ptr<TransferSystem>(double control_period_s)>;

struct TransferSystemReading {
  TransferSystemMaker make;
  double delay_s = 0.0;  // at low frequency
};

TransferSystemReading read_ideal(Section&) {
  return {[](double) { return std::make_unique<Ideal>(); }, 0.0};
}

TransferSystemReading read_delay(Section& section) {
  const double delay_s = section.number("delay_s", {.low = 0.0, .high = 10.0});
  return {[delay_s](double period_s) { return std::make_unique<Delay>(from_seconds(delay_s), from_seconds(period_s)); },
          delay_s};
}

TransferSystemReading read_first_order(Section& section) {
  const double time_constant_s = section.has("time_constant_s")
                                     ? section.number("time_constant_s", kPositive)
                                     : 1.0 / (2.0 * std::numbers::pi * section.number("bandwidth_hz", kPositive));
  return {[time_constant_s](double period_s) {
            return std::make_unique<FirstOrder>(time_constant_s, from_seconds(period_s));
          },
          time_constant_s};
}

TransferSystemReading read_second_order(Section& section) {
  const SecondOrder::Parameters parameters{
      .natural_frequency_hz = section.number("natural_frequency_hz", kPositive),
      .damping_ratio = section.number("damping_ratio", {.low = 0.0, .high = 10.0, .low_open = true}),
      .delay = from_seconds(section.number("delay_s", {.low = 0.0, .high = 10.0}, 0.0)),
  };
  return {
      [parameters](double period_s) { return std::make_unique<SecondOrder>(parameters, from_seconds(period_s)); },
      parameters.damping_ratio / (std::numbers::pi * parameters.natural_frequency_hz) + to_seconds(parameters.delay)};
}

TransferSystemReading read_transfer_system(Section section) {
  return read_type<TransferSystemReading>(section, {{"ideal", read_ideal},
                                                    {"delay", read_delay},
                                                    {"first_order", read_first_order},
                                                    {"second_order", read_second_order}});
}

std::function<std::unique_ptr<Specimen>()> read_specimen(Section& rig, int dofs) {
  std::vector<Section> sections = rig.sections("specimen", true);
  if (sections.size() == 1 && sections.front().has("stiffness_matrix_n_per_m")) {
    Section& section = sections.front();
    static_cast<void>(section.choice("type", {"elastic"}));
    const auto size = static_cast<std::size_t>(dofs);
    const Eigen::MatrixXd stiffness = section.matrix("stiffness_matrix_n_per_m", size, size);
    section.finish();
    return [stiffness] { return std::make_unique<ElasticSpecimen>(stiffness); };
  }
  std::vector<Maker<Law>> makers;
  for (const Section& section : sections) makers.push_back(read_law(section));
  expect_count(rig, "specimen", makers.size(), dofs);
  return [makers] { return std::make_unique<LawSpecimen>(make_all(makers)); };
}

SimulatedRig::SensorNoise read_sensors(Section section) {
  SimulatedRig::SensorNoise noise;
  noise.displacement_noise_m = section.number("displacement_noise_m", kNotNegative, 0.0);
  noise.force_noise_n = section.number("force_noise_n", kNotNegative, 0.0);
  noise.seed = static_cast<std::uint64_t>(section.integer("seed", 0, std::int64_t{1} << 53, 0));
  section.finish();
  return noise;
}

}  // namespace

RigReading read_simulated_rig(Section& section, int dofs) {
  std::vector<TransferSystemReading> transfer_systems;
  for (const Section& entry : section.sections("transfer_system", true)) {
    transfer_systems.push_back(read_transfer_system(entry));
  }
  if (transfer_systems.size() == 1) transfer_systems.resize(static_cast<std::size_t>(dofs), transfer_systems.front());
  expect_count(section, "transfer_system", transfer_systems.size(), dofs);
  const auto specimen = read_specimen(section, dofs);
  const SimulatedRig::SensorNoise noise = read_sensors(section.section_or_empty("sensors"));

  RigReading reading;
  for (const auto& transfer_system : transfer_systems) {
    reading.transfer_delay_s = std::max(reading.transfer_delay_s, transfer_system.delay_s);
  }
  reading.make = [transfer_systems, specimen, noise](double period_s) {
    std::vector<std::unique_ptr<TransferSystem>> made;
    for (const auto& transfer_system : transfer_systems) made.push_back(transfer_system.make(period_s));
    return std::make_unique<SimulatedRig>(std::move(made), specimen(), noise, from_seconds(period_s));
  };
  return reading;
}

Maker<Law> read_law(Section section) { return read_type(section, laws()); }

Maker<SubstructureModel> read_model(Section section, int dofs, const std::filesystem::path& directory) {
  std::vector<std::string> names{"elastic", "springs", "shear_building"};
  for (const auto& law : laws()) {
    if (law.name != "elastic") names.push_back(law.name);
  }
  const auto type = section.choice("type", names);
  Maker<SubstructureModel> maker;
  if (type == 0) {
    const auto stiffness = read_stiffness(section, dofs, directory);
    maker = [stiffness] { return std::make_unique<ElasticMatrix>(stiffness()); };
  } else if (type == 1) {
    const std::vector<Maker<Law>> springs = read_laws(section, "springs");
    expect_count(section, "springs", springs.size(), dofs);
    maker = [springs] { return std::make_unique<Springs>(make_all(springs)); };
  } else if (type == 2) {
    maker = read_shear_building(section, dofs);
  } else {
    // A law by itself is a spring at the only interface degree of freedom.
    const std::vector<Maker<Law>> springs{laws()[type - 2].read(section)};
    expect_count(section, "type", springs.size(), dofs);
    maker = [springs] { return std::make_unique<Springs>(make_all(springs)); };
  }
  section.finish();
  return maker;
}

std::string read_integrator_type(Section section) {
  const std::vector<std::string> names{"central_difference", "explicit_newmark"};
  std::string type = names[section.choice("type", names)];
  section.finish();
  return type;
}

std::unique_ptr<Integrator> make_integrator(std::string_view type, const LinearStructure& structure, double step_s) {
  if (type == "explicit_newmark") return std::make_unique<ExplicitNewmark>(structure, step_s);
  return std::make_unique<CentralDifference>(structure, step_s);
}

}  // namespace hybridtest
