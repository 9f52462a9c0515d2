#include "scenario/catalogue/numerical_models.hpp"

#include <functional>
#include <utility>

#include "core/config_error.hpp"
#include "mechanics/laws/elastic.hpp"
#include "mechanics/structure/matrix_market.hpp"
#include "numerical_substructure/elastic_matrix.hpp"
#include "numerical_substructure/shear_building.hpp"
#include "numerical_substructure/springs.hpp"
#include "scenario/catalogue/laws.hpp"
#include "scenario/named_file.hpp"

namespace hybridtest {
namespace {
using config::Section;

/// A full stiffness: a number for one degree of freedom, a matrix, or a Matrix Market file.
std::function<Eigen::MatrixXd()> read_stiffness(Section& section, int dofs, const std::filesystem::path& directory) {
  if (section.has("matrix_market")) {
    const std::filesystem::path file = named_file(section, "matrix_market", directory).value_or("");
    return [file, dofs] {
      const Eigen::SparseMatrix<double> matrix = read_matrix_market(file);
      if (matrix.rows() != dofs || matrix.cols() != dofs) {
        throw ConfigError{file.string() + ": a matrix of " + std::to_string(matrix.rows()) + " by " +
                          std::to_string(matrix.cols()) + "; the interface has " + std::to_string(dofs) +
                          " degrees of freedom"};
      }
      return Eigen::MatrixXd{matrix};
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
      storeys.push_back([stiffness] { return std::make_unique<Elastic>(stiffness); });
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

}  // namespace hybridtest
