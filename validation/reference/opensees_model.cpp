#include "validation/reference/opensees_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <map>
#include <sstream>

#include "core/child_process.hpp"
#include "core/config/section.hpp"
#include "core/config_error.hpp"
#include "core/opensees_program.hpp"

namespace hybridtest {
namespace {
using config::Section;

/// Of the largest entry of its row: a smaller sum is rounding.
constexpr double kSumRounding = 1e-12;
/// From here on the matrices of OpenSees are sparse.
constexpr Eigen::Index kBandedUpTo = 100;

/// Words of a material: its type and parameters. Empty: this law has no counterpart with these parameters.
using Material = std::string;

Material bilinear(Section& law) {
  return fmt::format("Steel01 {:.17g} {:.17g} {:.17g}", law.number("yield_force_n"), law.number("stiffness_n_per_m"),
                     law.number("hardening_ratio"));
}

Material giuffre_menegotto_pinto(Section& law) {
  std::string text = "Steel02";
  for (const char* key :
       {"yield_force_n", "stiffness_n_per_m", "hardening_ratio", "r0", "cr1", "cr2", "a1", "a2", "a3", "a4"}) {
    text += fmt::format(" {:.17g}", law.number(key));
  }
  return text;
}

Material bouc_wen(Section& law) {
  std::string text = "BoucWen";
  for (const char* key : {"alpha", "stiffness_n_per_m", "n", "gamma_per_m", "beta_per_m", "ao"}) {
    text += fmt::format(" {:.17g}", law.number(key));
  }
  return text + " 0.0 0.0 0.0 1.0e-14 100";
}

/// Bilinear without hardening.
Material friction(Section& law) {
  const double force = law.number("friction_force_n");
  if (force == 0.0) return {};
  return fmt::format("Steel01 {:.17g} {:.17g} 0.0", force, force / law.number("presliding_displacement_m"));
}

/// A line through four points, which goes on beyond the outer ones.
Material gap(Section& law) {
  const double touch_m = law.number("gap_m");
  if (touch_m == 0.0) return {};
  const double force = law.number("stiffness_n_per_m") * touch_m;
  return fmt::format("ElasticMultiLinear -strain {0:.17g} {1:.17g} {2:.17g} {3:.17g} -stress {4:.17g} 0.0 0.0 {5:.17g}",
                     -2.0 * touch_m, -touch_m, touch_m, 2.0 * touch_m, -force, force);
}

Material lead_rubber(Section& law) {
  if (law.number("heating_path_m") != 0.0) return {};
  const double rubber = law.number("rubber_stiffness_n_per_m");
  const double yield_m = law.number("yield_displacement_m");
  const double stiffness = rubber + law.number("lead_strength_n") / yield_m;
  return fmt::format("Steel01 {:.17g} {:.17g} {:.17g}", stiffness * yield_m, stiffness, rubber / stiffness);
}

using Writer = Material (*)(Section&);

const std::vector<std::pair<std::string_view, Writer>>& writers() {
  static const std::vector<std::pair<std::string_view, Writer>> table{
      {"elastic", [](Section& law) { return fmt::format("Elastic {:.17g}", law.number("stiffness_n_per_m")); }},
      {"bilinear", bilinear},
      {"giuffre_menegotto_pinto", giuffre_menegotto_pinto},
      {"bouc_wen", bouc_wen},
      {"self_centring",
       [](Section& law) {
         const double stiffness = law.number("stiffness_n_per_m");
         return fmt::format("SelfCentering {:.17g} {:.17g} {:.17g} {:.17g}", stiffness,
                            law.number("hardening_ratio") * stiffness, law.number("activation_force_n"),
                            law.number("flag_ratio"));
       }},
      {"lead_rubber", lead_rubber},
      {"friction", friction},
      {"gap", gap},
      {"viscous",
       [](Section& law) {
         return fmt::format("Viscous {:.17g} {:.17g}", law.number("damping_n_s_per_m"), law.number("exponent"));
       }},
  };
  return table;
}

/// Writes one scenario.
class ModelWriter {
 public:
  explicit ModelWriter(const Scenario& scenario)
      : scenario_{scenario},
        document_{config::Document::parse(scenario.effective, "scenario.yaml")},
        size_{scenario.structure.size()},
        stiffness_{scenario.structure.stiffness_n_per_m} {
    if (stiffness_.size() == 0) stiffness_.resize(size_, size_);
  }

  [[nodiscard]] std::string text(const std::filesystem::path& results) {
    if (scenario_.excitation.free_vibration) refuse("excitation.free_vibration: an initial motion is not written");
    check_effects();
    const Eigen::SparseMatrix<double>& damping = scenario_.structure.damping_n_s_per_m;
    if (!Eigen::SparseMatrix<double>{damping.transpose()}.isApprox(damping, kSumRounding)) {
      refuse("structure.damping: a matrix that is not symmetric is not written");
    }
    write_nodes();
    write_substructures();
    write_matrix(stiffness_, [](double value) { return fmt::format("Elastic {:.17g}", value); });
    write_matrix(scenario_.structure.damping_n_s_per_m,
                 [](double value) { return fmt::format("Elastic 0.0 {:.17g}", value); });
    write_loads();
    write_initial_acceleration();
    write_analysis(results);
    if (!issues_.empty()) {
      std::string all = scenario_.file.string() + " cannot be written for OpenSees:";
      for (const std::string& issue : issues_) all += "\n  " + issue;
      throw ConfigError{all + "\n`hybridtest reference` without --with opensees computes it in this process"};
    }
    return std::move(text_);
  }

 private:
  void refuse(const std::string& what) { issues_.push_back(what); }
  void line(const std::string& what) { text_ += what + "\n"; }

  /// Errors of mass and damping are in the matrices; one of the stiffness is not in the laws.
  void check_effects() {
    Section root = document_.root();
    if (!root.has("effects")) return;
    for (Section& effect : root.sections("effects", true)) {
      if (effect.text("type") == "stiffness_error") refuse("effects: stiffness_error is not written");
    }
  }

  void write_nodes() {
    line("# " + scenario_.name +
         ": the whole test without coupling, written by `hybridtest reference --with opensees`.");
    line("# SI units. Node 0 is the ground; the other nodes are the degrees of freedom:");
    line("model BasicBuilder -ndm 1 -ndf 1\nnode 0 0.0\nfix 0 1");
    const Eigen::SparseMatrix<double>& mass = scenario_.structure.mass_kg;
    for (Eigen::Index dof = 0; dof < size_; ++dof) {
      line(fmt::format("node {} 0.0 -mass {:.17g}  ;# {}", dof + 1, mass.coeff(dof, dof),
                       scenario_.dofs[static_cast<std::size_t>(dof)]));
      for (Eigen::SparseMatrix<double>::InnerIterator entry{mass, dof}; entry; ++entry) {
        if (entry.row() <= dof || entry.value() == 0.0) continue;
        refuse(fmt::format("structure.mass: mass between '{}' and '{}'; a node of OpenSees has a mass of its own alone",
                           scenario_.dofs[static_cast<std::size_t>(dof)],
                           scenario_.dofs[static_cast<std::size_t>(entry.row())]));
        return;
      }
    }
  }

  /// A spring from one node to another one; the ground is 0.
  void write_spring(Eigen::Index from, Eigen::Index to, const Material& material) {
    ++tag_;
    const std::size_t type_end = material.find(' ');
    line(fmt::format("uniaxialMaterial {} {}{}", material.substr(0, type_end), tag_, material.substr(type_end)));
    line(fmt::format("element zeroLength {0} {1} {2} -mat {0} -dir 1 -doRayleigh 0", tag_, from, to));
  }

  /// A symmetric matrix as springs: -a_ij between i and j, the sum of row i between i and the ground.
  template <class Make>
  void write_matrix(const Eigen::SparseMatrix<double>& matrix, const Make& make) {
    Eigen::VectorXd sums = Eigen::VectorXd::Zero(size_);
    Eigen::VectorXd largest = Eigen::VectorXd::Zero(size_);
    for (Eigen::Index column = 0; column < matrix.outerSize(); ++column) {
      for (Eigen::SparseMatrix<double>::InnerIterator entry{matrix, column}; entry; ++entry) {
        sums[entry.row()] += entry.value();
        largest[entry.row()] = std::max(largest[entry.row()], std::abs(entry.value()));
        if (entry.row() > column && entry.value() != 0.0) {
          write_spring(column + 1, entry.row() + 1, make(-entry.value()));
        }
      }
    }
    for (Eigen::Index dof = 0; dof < size_; ++dof) {
      if (std::abs(sums[dof]) > kSumRounding * largest[dof]) write_spring(0, dof + 1, make(sums[dof]));
    }
  }

  void write_substructures() {
    Section root = document_.root();
    std::vector<Section> sections = root.sections("substructures");
    for (std::size_t i = 0; i < sections.size(); ++i) {
      const SubstructureScenario& substructure = scenario_.substructures[i];
      if (substructure.role == Role::numerical_substructure) {
        write_model(substructure, sections[i].section("model"));
      } else {
        write_site(substructure, sections[i]);
      }
    }
  }

  void write_site(const SubstructureScenario& substructure, Section& section) {
    Section rig = section.section("rig");
    const bool is_simulated = rig.text("type") == "simulated";
    if (!is_simulated && !section.has("model")) {
      refuse(substructure.id + ": its specimen is not known; give a `model` beside the rig");
      return;
    }
    Section site = is_simulated ? rig : section.section("model");
    if (site.has("geometry")) {
      refuse(substructure.id + ": a specimen behind a `geometry` is not written");
      return;
    }
    std::vector<Section> laws = site.sections("specimen", true);
    if (laws.size() == 1 && laws.front().has("stiffness_matrix_n_per_m")) {
      const auto dofs = static_cast<std::size_t>(substructure.interface.size());
      stiffness_ += substructure.interface.on_structure(laws.front().matrix("stiffness_matrix_n_per_m", dofs, dofs));
      return;
    }
    for (std::size_t k = 0; k < laws.size(); ++k) write_law(substructure, {{k, 1.0}}, laws[k]);
  }

  void write_model(const SubstructureScenario& substructure, Section model) {
    const std::string type = model.text("type");
    if (type == "elastic") {
      stiffness_ += substructure.interface.on_structure(substructure.initial_stiffness_n_per_m);
    } else if (type == "springs") {
      write_springs(substructure, model);
    } else if (type == "shear_building") {
      write_storeys(substructure, model);
    } else if (type == "opensees") {
      refuse(substructure.id + ": a model in OpenSees is not written; join the scripts by hand");
    } else {
      write_law(substructure, {{0, 1.0}}, model);
    }
  }

  /// Weights of interface degrees of freedom in an elongation.
  using Weights = std::map<std::size_t, double>;

  void write_springs(const SubstructureScenario& substructure, Section& model) {
    std::vector<Section> springs = model.sections("springs", true);
    for (std::size_t k = 0; k < springs.size(); ++k) {
      Section& spring = springs[k];
      if (!spring.has("law")) {
        write_law(substructure, {{k, 1.0}}, spring);
        continue;
      }
      Weights weights;
      if (spring.has("at")) {
        weights[position(substructure, spring.text("at"))] = 1.0;
      } else if (spring.has("between")) {
        const std::vector<std::string> ends = spring.names("between");
        weights[position(substructure, ends[0])] = 1.0;
        weights[position(substructure, ends[1])] = -1.0;
      } else {
        Section elongation = spring.section("elongation");
        for (const std::string& name : elongation.keys()) {
          weights[position(substructure, name)] = elongation.number(name);
        }
      }
      write_law(substructure, weights, spring.section("law"));
    }
  }

  void write_storeys(const SubstructureScenario& substructure, Section& model) {
    const auto dofs = static_cast<std::size_t>(substructure.interface.size());
    if (!model.has("storeys")) {
      stiffness_ += substructure.interface.on_structure(substructure.initial_stiffness_n_per_m);
      return;
    }
    std::vector<Section> storeys = model.sections("storeys", true);
    const std::size_t first = dofs - storeys.size();  // 1 where the first degree of freedom is the base
    for (std::size_t k = 0; k < storeys.size(); ++k) {
      Weights weights{{k + first, 1.0}};
      if (k + first > 0) weights[k + first - 1] = -1.0;
      write_law(substructure, weights, storeys[k]);
    }
  }

  /// Of an interface degree of freedom, by its name or an address that the scenario was read with.
  [[nodiscard]] std::size_t position(const SubstructureScenario& substructure, const std::string& name) {
    const std::vector<std::string>& names = substructure.interface_names;
    const auto found = std::ranges::find(names, name);
    if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
    refuse(substructure.id + ": the degree of freedom '" + name + "' is not written; use its name");
    return 0;
  }

  /// One law, or several in parallel, along an elongation.
  void write_law(const SubstructureScenario& substructure, const Weights& weights, Section law) {
    const std::string type = law.text("type");
    if (type == "none") {
      refuse(substructure.id + ": a specimen without a law; its effects are not written");
      return;
    }
    if (type == "parallel") {
      for (Section& each : law.sections("laws", true)) write_law(substructure, weights, each);
      return;
    }
    const auto writer = std::ranges::find(writers(), type, [](const auto& row) { return row.first; });
    const Material material = writer == writers().end() ? Material{} : writer->second(law);
    if (material.empty()) {
      std::string known;
      for (const auto& [name, make] : writers()) known += (known.empty() ? "" : ", ") + std::string{name};
      refuse(fmt::format("{}: the law {} has no counterpart {}; those with one: {}", substructure.id, type,
                         writer == writers().end() ? "in OpenSees" : "with these parameters", known));
      return;
    }
    Eigen::VectorXd structure = Eigen::VectorXd::Zero(size_);
    Eigen::VectorXd interface = Eigen::VectorXd::Zero(substructure.interface.size());
    for (const auto& [dof, weight] : weights) interface[static_cast<Eigen::Index>(dof)] = weight;
    substructure.interface.add_to_structure(interface, structure);
    Eigen::Index plus = 0;
    Eigen::Index minus = 0;
    bool is_drift = true;
    for (Eigen::Index dof = 0; dof < size_; ++dof) {
      if (structure[dof] == 0.0) continue;
      Eigen::Index& end = structure[dof] > 0.0 ? plus : minus;
      is_drift = is_drift && std::abs(structure[dof]) == 1.0 && end == 0;
      end = dof + 1;
    }
    if (!is_drift) {
      refuse(substructure.id + ": a spring along an `elongation` with factors is not written");
      return;
    }
    write_spring(minus, plus, material);
  }

  void write_series(int tag, const std::vector<double>& values) {
    std::string list;
    for (const double value : values) list += fmt::format(" {:.17g}", value);
    list += fmt::format(" {:.17g}", values.back());  // the last value of a series counts as zero
    line(fmt::format("timeSeries Path {} -dt {:.17g} -values {{{}}}", tag, scenario_.time.step_s, list));
  }

  /// A load at each degree of freedom with a factor.
  void write_pattern(int tag, const Eigen::VectorXd& factors) {
    line(fmt::format("pattern Plain {0} {0} {{", tag));
    for (Eigen::Index dof = 0; dof < size_; ++dof) {
      if (factors[dof] != 0.0) line(fmt::format("  load {} {:.17g}", dof + 1, factors[dof]));
    }
    line("}");
  }

  void write_loads() {
    int tag = 0;
    for (const GroundRecord& record : scenario_.excitation.records) {
      write_series(++tag, record.acceleration_m_per_s2);
      write_pattern(tag, -(scenario_.structure.mass_kg * record.influence));
    }
    for (const AppliedForce& force : scenario_.excitation.forces) {
      Eigen::VectorXd factors = Eigen::VectorXd::Zero(size_);
      for (std::size_t k = 0; k < force.load.dofs.size(); ++k) factors[force.load.dofs[k]] = force.load.factors[k];
      write_series(++tag, force.load.force_n);
      write_pattern(tag, factors);
    }
  }

  /// The structure begins at rest with the acceleration of the first load; OpenSees would begin without one.
  void write_initial_acceleration() {
    const AppliedLoad load = scenario_.excitation.load(scenario_.structure);
    Eigen::VectorXd ground_n = Eigen::VectorXd::Zero(size_);
    Eigen::VectorXd forces_n = Eigen::VectorXd::Zero(size_);
    load.ground_at(0, ground_n);
    if (load.has_forces()) load.forces_at(0, forces_n);
    for (Eigen::Index dof = 0; dof < size_; ++dof) {
      const double acceleration = (ground_n[dof] + forces_n[dof]) / scenario_.structure.mass_kg.coeff(dof, dof);
      if (acceleration != 0.0) line(fmt::format("setNodeAccel {} 1 {:.17g} -commit", dof + 1, acceleration));
    }
  }

  void write_analysis(const std::filesystem::path& results) {
    std::string nodes;
    for (Eigen::Index dof = 0; dof < size_; ++dof) nodes += fmt::format(" {}", dof + 1);
    line(fmt::format("recorder Node -file {{{}}} -precision 17 -time -node{} -dof 1 disp", results.string(), nodes));
    line(size_ <= kBandedUpTo ? "constraints Plain\nnumberer RCM\nsystem BandGeneral"
                              : "constraints Plain\nnumberer RCM\nsystem UmfPack");
    line("test NormDispIncr 1.0e-11 50\nalgorithm Newton\nintegrator Newmark 0.5 0.25\nanalysis Transient");
    line(fmt::format("set step_s {:.17g}\nset steps {}", scenario_.time.step_s, scenario_.time.last_step));
    text_ += R"(for {set step 1} {$step <= $steps} {incr step} {
  set failed [analyze 1 $step_s]
  foreach other {{KrylovNewton} {NewtonLineSearch} {ModifiedNewton -initial}} {
    if {$failed == 0} { break }
    algorithm {*}$other
    set failed [analyze 1 $step_s]
    algorithm Newton
  }
  if {$failed != 0} {
    puts stderr "no equilibrium at [expr {$step * $step_s}] s"
    wipe
    exit 1
  }
}
wipe
exit 0
)";
  }

  const Scenario& scenario_;
  config::Document document_;
  Eigen::Index size_;
  Eigen::SparseMatrix<double> stiffness_;  // of the structure and of elastic substructures
  int tag_ = 0;                            // of springs and their materials
  std::string text_;
  std::vector<std::string> issues_;
};

}  // namespace

const std::vector<std::string_view>& laws_with_counterpart() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> all;
    for (const auto& [name, write] : writers()) all.push_back(name);
    all.emplace_back("parallel");
    return all;
  }();
  return names;
}

std::string opensees_model(const Scenario& scenario, const std::filesystem::path& results) {
  if (scenario.opensees) {
    throw ConfigError{scenario.file.string() + ": OpenSees leads this test: its own script is the model"};
  }
  return ModelWriter{scenario}.text(results);
}

ReferenceResponse read_opensees_response(const Scenario& scenario, const std::filesystem::path& results) {
  const Step last = scenario.time.last_step;
  const Eigen::Index size = scenario.structure.size();
  ReferenceResponse response{.step_s = scenario.time.step_s, .displacement_m = Eigen::MatrixXd::Zero(size, last + 1)};
  std::ifstream file{results};
  Step step = 0;
  for (std::string row; step < last && std::getline(file, row);) {
    std::istringstream words{row};
    double value = 0.0;
    words >> value;  // time
    ++step;
    for (Eigen::Index dof = 0; dof < size && words >> value; ++dof) response.displacement_m(dof, step) = value;
    if (!words) break;
  }
  if (step < last || !file) {
    throw ConfigError{fmt::format("{}: {} of {} steps are there; look at the log of OpenSees beside it",
                                  results.string(), step, last)};
  }
  return response;
}

void run_opensees(const std::filesystem::path& script, const std::string& program,
                  const std::function<void()>& waiting) {
  constexpr Duration kLook = std::chrono::milliseconds{200};
  constexpr std::size_t kLines = 10;
  limit_opensees_threads();
  ChildStart start;
  start.program = find_opensees(program);
  start.arguments = {std::filesystem::absolute(script).string()};
  start.directory = std::filesystem::absolute(script).parent_path();
  start.log_file = std::filesystem::absolute(script).replace_extension(".log");
  start.is_killed_with_parent = true;
  ChildProcess opensees{"opensees", start};
  while (!opensees.wait_for_end(kLook)) {
    if (waiting) waiting();
  }
  if (*opensees.exit_code() == 0) return;
  std::string text =
      fmt::format("OpenSees ended with the exit code {}; the end of its output {}:", *opensees.exit_code(),
                  start.log_file.string());
  for (const std::string& line : opensees.last_lines(kLines)) text += "\n  " + line;
  throw ConfigError{text};
}

}  // namespace hybridtest
