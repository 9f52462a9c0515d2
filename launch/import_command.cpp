#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>
#include <optional>
#include <system_error>

#include "core/config_error.hpp"
#include "core/exit_code.hpp"
#include "core/opensees_program.hpp"
#include "core/text/scalar.hpp"
#include "launch/commands.hpp"
#include "launch/shipped_scenarios.hpp"
#include "scenario/opensees_import/opensees_import.hpp"
#include "scenario/scenario.hpp"

namespace hybridtest {
namespace {

namespace fs = std::filesystem;

constexpr double kTwoPi = 6.283185307179586;
constexpr double kFrequencyDifferenceMax = 1e-6;

struct ImportOptions {
  fs::path script;
  std::vector<std::string> interface;
  std::optional<fs::path> out;
  std::string length = "m";
  std::string force = "N";
  std::string program;
};

/// Frequencies of both programs side by side: columns of a file, and what is printed.
struct ModeTable {
  std::string csv = "mode,opensees_hz,hybridtest_hz,relative_difference\n";
  std::string text = "  mode   OpenSees [Hz]       here [Hz]   difference\n";
  double largest_difference = 0.0;
};

ModeTable mode_table(const Eigen::VectorXd& theirs_rad_per_s, const Eigen::VectorXd& ours_rad_per_s) {
  ModeTable table;
  for (Eigen::Index i = 0; i < std::min(theirs_rad_per_s.size(), ours_rad_per_s.size()); ++i) {
    const double theirs_hz = theirs_rad_per_s[i] / kTwoPi;
    const double ours_hz = ours_rad_per_s[i] / kTwoPi;
    const double difference = ours_hz == theirs_hz ? 0.0 : ours_hz / theirs_hz - 1.0;
    table.csv += fmt::format("{},{},{},{:.3e}\n", i + 1, theirs_hz, ours_hz, difference);
    table.text += fmt::format("  {:4} {:15.9g} {:15.9g} {:12.1e}\n", i + 1, theirs_hz, ours_hz, difference);
    // A motion that nothing holds is 0 Hz but for rounding in both.
    const bool is_at_rest = std::max(theirs_hz, ours_hz) < kFrequencyDifferenceMax * ours_rad_per_s.maxCoeff();
    if (!is_at_rest) table.largest_difference = std::max(table.largest_difference, std::abs(difference));
  }
  return table;
}

/// A scenario with the structure as it is: next to nothing stands where the specimens will.
std::string scenario_text(const std::string& name, const std::string& structure, const std::string& motion,
                          const std::vector<std::string>& interface, const std::string& script) {
  const std::string& first = interface.front();
  const std::string direction = first.ends_with("_ux")   ? "x"
                                : first.ends_with("_uy") ? "y"
                                : first.ends_with("_uz") ? "z"
                                                         : "x";
  std::string text = fmt::format(
      "# Imported from {}. The structure is the whole model: leave what is tested out of the script and import it\n"
      "# again, put the specimens in place of the springs below, and set the excitation and the step.\n"
      "schema: hybridtest/1\nname: {}\ntime: {{mode: lockstep, step_s: 0.001, duration_s: 31.0}}\n"
      "excitation: {{ground_motion: {}, scale: 1.0, direction: {}}}\n{}"
      "integrator: {{type: alpha_operator_splitting, alpha: 0.0}}\nsubstructures:\n",
      script, written_text(name), written_text(motion), direction, structure);
  for (const std::string& dof : interface) {
    text += fmt::format(
        "  - id: at_{0}\n    kind: numerical\n    interface: [{{dof: {0}}}]\n"
        "    model: {{type: elastic, stiffness_n_per_m: 1.0}}  # next to nothing\n",
        dof);
  }
  return text;
}

void write_file(const fs::path& file, const std::string& text) {
  std::ofstream stream{file, std::ios::binary};
  stream << text;
  if (!stream.flush()) throw ConfigError{file.string() + ": cannot be written"};
}

fs::path folder_of(const ImportOptions& options) {
  fs::path folder = options.out.value_or(options.script.stem());
  if (!folder.has_filename()) folder = folder.parent_path();
  if (!is_test_name(folder.filename().string())) {
    throw ConfigError{"--out " + folder.string() + ": does not serve as the name of a test; expected " +
                      std::string{kTestNameRule}};
  }
  std::error_code ignored;
  if (fs::exists(fs::symlink_status(folder, ignored))) {
    throw ConfigError{"--out " + folder.string() + ": already exists; choose another name"};
  }
  return folder;
}

int import_model(const ImportOptions& options) {
  const fs::path folder = folder_of(options);
  limit_opensees_threads();
  const ImportedModel model =
      import_opensees(options.script, options.program, model_units(options.length, options.force));
  std::vector<std::string> interface;
  for (const std::string& address : options.interface) {
    const std::string& name = model.dofs.names()[static_cast<std::size_t>(interface_row(model, address))];
    if (std::ranges::find(interface, name) != interface.end()) {
      throw ConfigError{"--interface " + address + ": named twice"};
    }
    interface.push_back(name);
  }
  const Eigen::VectorXd ours_rad_per_s = imported_frequencies_rad_per_s(model);
  const fs::path motion = read_scenario(shipped_scenario("two_storey_one_site"), {}).excitation.records.front().file;
  const fs::path motion_path = fs::path{"ground_motions"} / motion.filename();
  const ModeTable modes = mode_table(model.opensees_rad_per_s, ours_rad_per_s);
  const fs::path scenario = folder / "scenario.yaml";
  try {
    fs::create_directories(folder / motion_path.parent_path());
    fs::copy_file(motion, folder / motion_path);
  } catch (const fs::filesystem_error& error) {
    throw ConfigError{"--out " + folder.string() + ": cannot write there: " + error.code().message()};
  }
  const std::string structure = write_structure(model, folder);
  write_file(folder / "modes.csv", modes.csv);
  write_file(scenario, scenario_text(folder.filename().string(), structure, motion_path.string(), interface,
                                     options.script.filename().string()));
  fmt::print("{}: {} degrees of freedom, lengths in {}, forces in {}\n", options.script.string(), model.dofs.size(),
             options.length, options.force);
  fmt::print("{}", modes.text);
  if (model.opensees_rad_per_s.size() == 0) fmt::print("  OpenSees finds no modes to compare with\n");
  if (modes.largest_difference > kFrequencyDifferenceMax) {
    fmt::print(
        stderr,
        "warning: frequencies differ by up to {:.1e}, more than {:.0e}: OpenSees writes matrices with 11 digits; "
        "compare a run with OpenSees before you rely on the structure\n",
        modes.largest_difference, kFrequencyDifferenceMax);
  }
  static_cast<void>(read_scenario(scenario, {}));
  fmt::print("\n  hybridtest check {0}\n  hybridtest simulate {0} --seed 1\n", scenario.string());
  return kExitCompleted;
}

}  // namespace

void add_import_command(CLI::App& app, CommandAction& action) {
  auto options = std::make_shared<ImportOptions>();
  CLI::App* group = app.add_subcommand("import", "Make a scenario of a model of another program");
  group->require_subcommand(1);
  CLI::App* command = group->add_subcommand(
      "opensees", "Run a script of OpenSees and write mass, stiffness and damping of its model, with a scenario");
  command->add_option("MODEL", options->script, "Script in Tcl that builds the model")->required();
  command
      ->add_option("--interface", options->interface,
                   "Node and degree of freedom where a substructure will act, such as 3,1; as many as needed")
      ->required()
      ->expected(1, -1);
  command->add_option("--out", options->out,
                      "Folder to make; its last part is the name of the test (default: the name of MODEL)");
  command->add_option("--length", options->length, "Unit of lengths in the script")
      ->check(CLI::IsMember(length_unit_names()))
      ->capture_default_str();
  command->add_option("--force", options->force, "Unit of forces in the script; mass is force s2 / length")
      ->check(CLI::IsMember(force_unit_names()))
      ->capture_default_str();
  command->add_option("--program", options->program,
                      "OpenSees (default: that of HYBRIDTEST_OPENSEES, else OpenSees in PATH)");
  command->callback([options, &action] { action = [options] { return import_model(*options); }; });
}

}  // namespace hybridtest
