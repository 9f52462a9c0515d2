#include "scenario/catalogue/numerical_models.hpp"

#include <algorithm>
#include <functional>
#include <utility>

#include "core/config_error.hpp"
#include "core/text/nearest_name.hpp"
#include "mechanics/laws/elastic.hpp"
#include "mechanics/structure/matrix_market.hpp"
#include "numerical_substructure/elastic_matrix.hpp"
#include "numerical_substructure/spring_network.hpp"
#include "scenario/catalogue/laws.hpp"
#include "scenario/catalogue/opensees_model.hpp"
#include "scenario/named_file.hpp"

namespace hybridtest {
namespace {
using config::Section;

/// A full stiffness: a number for one degree of freedom, a matrix, or a Matrix Market file.
std::function<Eigen::MatrixXd()> read_stiffness(Section& section, int dofs, const std::filesystem::path& directory,
                                                std::vector<NamedFile>& files) {
  if (section.has("matrix_market")) {
    const std::filesystem::path file = named_file(section, "matrix_market", directory).value_or("");
    files.push_back({.file = file, .written = section.text("matrix_market")});
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
  const auto base = count == dofs ? StoreyBase::ground : StoreyBase::first_dof;
  return [storeys, base] { return std::make_unique<SpringNetwork>(shear_building(make_all(storeys), base)); };
}

Maker<SubstructureModel> one_spring_each(const std::vector<Maker<Law>>& laws) {
  return [laws] { return std::make_unique<SpringNetwork>(springs_to_ground(make_all(laws))); };
}

/// An end of a spring; one that the interface does not have is reported at the key.
void add_end(Section& section, std::string_view key, const std::string& name, double factor,
             const NamedInterface& interface, std::vector<Spring::End>& ends) {
  if (const std::optional<int> dof = interface.find(name)) {
    ends.push_back({.dof = *dof, .factor = factor});
    return;
  }
  std::string what = "'" + name + "' is not at the interface of this substructure";
  if (const auto nearest = nearest_name(name, interface.names)) {
    what += "; did you mean '" + *nearest + "'?";
  } else {
    what += "; expected one of";
    for (const std::string& known : interface.names) what += (known == interface.names.front() ? " " : ", ") + known;
    what += ", or add it to `interface`";
  }
  section.error(key, what);
}

/// `at: a`, `between: [a, b]` (the elongation is that of a less that of b) or `elongation: {a: 0.8, b: -0.8}`.
std::vector<Spring::End> read_ends(Section& spring, const NamedInterface& interface) {
  std::vector<Spring::End> ends;
  const bool has_at = spring.has_optional("at");
  const bool has_between = spring.has_optional("between");
  const bool has_elongation = spring.has_optional("elongation");
  if (static_cast<int>(has_at) + static_cast<int>(has_between) + static_cast<int>(has_elongation) != 1) {
    spring.error("",
                 "expected where the spring acts: `at: a` (between it and the ground), `between: [a, b]` or "
                 "`elongation: {a: 0.8, b: -0.8}` (a factor for each), one of the three");
  }
  if (has_at) add_end(spring, "at", spring.text("at"), 1.0, interface, ends);
  if (has_between) {
    const std::vector<std::string> names = spring.names("between");
    if (names.size() != 2) spring.error("between", "expected two degrees of freedom, such as [floor_2, floor_1]");
    for (const std::string& name : names) {
      add_end(spring, "between", name, ends.empty() ? 1.0 : -1.0, interface, ends);
    }
  }
  if (has_elongation) {
    Section elongation = spring.section("elongation");
    for (const std::string& name : elongation.keys()) {
      add_end(elongation, name, name, elongation.number(name), interface, ends);
    }
    elongation.finish();
  }
  return ends;
}

/// Laws, one for each degree of freedom, or springs that say where they act.
Maker<SubstructureModel> read_springs(Section& section, const NamedInterface& interface) {
  const auto dofs = static_cast<int>(interface.names.size());
  std::vector<Section> entries = section.sections("springs", true);
  const bool are_placed = std::ranges::any_of(entries, [](const Section& entry) {
    return entry.has("law") || entry.has("at") || entry.has("between") || entry.has("elongation");
  });
  if (!are_placed) {
    const std::vector<Maker<Law>> laws = read_laws(section, "springs");
    expect_count(section, "springs", laws.size(), dofs);
    return one_spring_each(laws);
  }
  std::vector<std::pair<std::vector<Spring::End>, Maker<Law>>> springs;
  for (Section& entry : entries) {
    std::vector<Spring::End> ends = read_ends(entry, interface);
    springs.emplace_back(std::move(ends), read_law(entry.section("law")));
    entry.finish();
  }
  return [springs, dofs] {
    std::vector<Spring> made;
    for (const auto& [ends, law] : springs) made.push_back({.ends = ends, .law = law()});
    return std::make_unique<SpringNetwork>(dofs, std::move(made));
  };
}

}  // namespace

Maker<SubstructureModel> read_model(Section section, const NamedInterface& interface,
                                    const std::filesystem::path& directory, double step_s,
                                    std::vector<NamedFile>& files) {
  const auto dofs = static_cast<int>(interface.names.size());
  std::vector<std::string> names{"elastic", "springs", "shear_building", "opensees"};
  for (const auto& law : laws()) {
    if (law.name != "elastic") names.push_back(law.name);
  }
  const auto type = section.choice("type", names);
  Maker<SubstructureModel> maker;
  if (type == 0) {
    const auto stiffness = read_stiffness(section, dofs, directory, files);
    maker = [stiffness] { return std::make_unique<ElasticMatrix>(stiffness()); };
  } else if (type == 1) {
    maker = read_springs(section, interface);
  } else if (type == 2) {
    maker = read_shear_building(section, dofs);
  } else if (type == 3) {
    maker = read_opensees_model(section, dofs, step_s, directory, files);
  } else {
    // A law by itself is a spring at the only interface degree of freedom.
    const std::vector<Maker<Law>> law{laws()[type - 3].read(section)};
    expect_count(section, "type", law.size(), dofs);
    maker = one_spring_each(law);
  }
  section.finish();
  return maker;
}

}  // namespace hybridtest
