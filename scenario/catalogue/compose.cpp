#include "scenario/catalogue/compose.hpp"

#include <utility>

#include "coordinator/central_difference.hpp"
#include "coordinator/explicit_newmark.hpp"
#include "mechanics/laws/bilinear.hpp"
#include "mechanics/laws/bouc_wen.hpp"
#include "mechanics/laws/bouc_wen_baber_noori.hpp"
#include "mechanics/laws/elastic.hpp"
#include "mechanics/laws/friction.hpp"
#include "mechanics/laws/gap_spring.hpp"
#include "mechanics/laws/giuffre_menegotto_pinto.hpp"
#include "mechanics/laws/viscous.hpp"
#include "mechanics/structure/matrix_market.hpp"
#include "numerical_substructure/elastic_matrix.hpp"
#include "numerical_substructure/shear_building.hpp"
#include "numerical_substructure/springs.hpp"
#include "scenario/catalogue/compose_simulated_rig.hpp"
#include "scenario/catalogue/named_type.hpp"

namespace hybridtest {
namespace {
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

Maker<Law> read_bouc_wen_baber_noori(Section& section) {
  const BoucWenBaberNoori::Parameters none;
  return maker_of<BoucWenBaberNoori>(BoucWenBaberNoori::Parameters{
      .stiffness_n_per_m = section.number("stiffness_n_per_m", kPositive),
      .alpha = section.number("alpha", {.low = 0.0, .high = 1.0}),
      .n = section.number("n", {.low = 1.0, .high = 100.0}, none.n),
      .gamma_per_m = section.number("gamma_per_m"),
      .beta_per_m = section.number("beta_per_m", kNotNegative),
      .ao = section.number("ao", kPositive, none.ao),
      .strength_degradation_per_j = section.number("strength_degradation_per_j", kNotNegative, 0.0),
      .stiffness_degradation_per_j = section.number("stiffness_degradation_per_j", kNotNegative, 0.0),
      .pinching = section.number("pinching", kShareBelowOne, 0.0),
      .pinching_rate_per_j = section.number("pinching_rate_per_j", kNotNegative, 0.0),
      .pinching_level = section.number("pinching_level", {.low = 0.0, .high = 1.0}, 0.0),
      .pinching_width_m = section.number("pinching_width_m", kPositive, none.pinching_width_m),
      .width_rate_m_per_j = section.number("width_rate_m_per_j", kNotNegative, 0.0),
      .width_share = section.number("width_share", kPositive, none.width_share),
  });
}

Maker<Law> read_friction(Section& section) {
  return maker_of<Friction>(Friction::Parameters{
      .friction_force_n = section.number("friction_force_n", kNotNegative),
      .presliding_displacement_m = section.number("presliding_displacement_m", kPositive, 1e-5),
  });
}

Maker<Law> read_gap(Section& section) {
  return maker_of<GapSpring>(GapSpring::Parameters{
      .stiffness_n_per_m = section.number("stiffness_n_per_m", kPositive),
      .gap_m = section.number("gap_m", kNotNegative),
  });
}

Maker<Law> read_viscous(Section& section) {
  return maker_of<Viscous>(Viscous::Parameters{
      .damping_n_s_per_m = section.number("damping_n_s_per_m", kNotNegative),
      .exponent = section.number("exponent", {.low = 0.1, .high = 3.0}, 1.0),
  });
}

const std::vector<NamedType<Maker<Law>>>& laws() {
  static const std::vector<NamedType<Maker<Law>>> table{
      {"elastic", read_elastic},
      {"bilinear", read_bilinear},
      {"giuffre_menegotto_pinto", read_giuffre_menegotto_pinto},
      {"bouc_wen", read_bouc_wen},
      {"bouc_wen_baber_noori", read_bouc_wen_baber_noori},
      {"friction", read_friction},
      {"gap", read_gap},
      {"viscous", read_viscous},
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

}  // namespace

void expect_count(Section& section, std::string_view key, std::size_t found, int expected) {
  if (std::cmp_equal(found, expected)) return;
  section.error(key, std::to_string(found) + " given; expected " + std::to_string(expected) +
                         ", one for each interface degree of freedom");
}

Maker<Law> read_law(Section section) { return read_type(section, laws()); }

Maker<Law> read_specimen_law(Section section) {
  std::vector<NamedType<Maker<Law>>> types{{"none", [](Section&) { return Maker<Law>{}; }}};
  types.insert(types.end(), laws().begin(), laws().end());
  return read_type(section, types);
}

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
