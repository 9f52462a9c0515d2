#include <fmt/format.h>

#include <fstream>
#include <optional>
#include <regex>
#include <system_error>

#include "coordinator/excitation/read_ground_motion.hpp"
#include "core/config_error.hpp"
#include "core/exit_code.hpp"
#include "core/input_file.hpp"
#include "core/text/scalar.hpp"
#include "core/text/shown.hpp"
#include "launch/commands.hpp"
#include "launch/shipped_scenarios.hpp"
#include "scenario/scenario.hpp"

namespace hybridtest {
namespace {

namespace fs = std::filesystem;

struct NewOptions {
  fs::path folder;
  std::string from = "two_storey_one_site";
  std::optional<fs::path> motion;
  std::optional<std::string> unit;
  std::optional<double> dt_s;
};

const std::vector<std::string>& unit_names() {
  static const std::vector<std::string> kNames{"g", "m_per_s2", "cm_per_s2"};
  return kNames;
}

GroundMotionOptions motion_options(const NewOptions& options) {
  GroundMotionOptions motion;
  motion.dt_s = options.dt_s;
  if (options.unit) {
    const auto position = std::ranges::find(unit_names(), *options.unit) - unit_names().begin();
    motion.unit = static_cast<AccelerationUnit>(position);
  }
  return motion;
}

/// The section of the user's own motion, unscaled.
std::string excitation_of(const NewOptions& options, const std::string& motion_path) {
  std::string line = "excitation: {ground_motion: " + written_text(motion_path) + ", scale: 1.0";
  if (options.unit) line += ", unit: " + *options.unit;
  if (options.dt_s) line += ", dt_s: " + written_number(*options.dt_s);
  return line + "}";
}

/// A shipped scenario, with its comments, under another name and with its motion beside it. Every shipped scenario has
/// `name` and `excitation` on one line each; a test makes a folder from each of them.
std::string text_of_new(const NewOptions& options, std::string text, const std::string& name,
                        const std::string& motion_path) {
  const auto replace = [&](const char* pattern, std::string by) {
    by = std::regex_replace(by, std::regex{"[$]"}, "$$$$");  // a dollar is not an instruction
    text = std::regex_replace(text, std::regex{pattern, std::regex::multiline}, by,
                              std::regex_constants::format_first_only);
  };
  replace("^name:.*$", "name: " + written_text(name));
  if (options.motion) {
    replace("^excitation:.*$", excitation_of(options, motion_path));
  } else {
    replace("ground_motion: [^,}]*", "ground_motion: " + written_text(motion_path));
  }
  return text;
}

/// @throws ConfigError for a scenario whose ground motion is in the model of an OpenSees that leads.
fs::path motion_of(const fs::path& shipped, const std::string& name) {
  const Scenario scenario = read_scenario(shipped, {});
  if (!scenario.excitation.records.empty()) return scenario.excitation.records.front().file;
  throw ConfigError{"--from " + name + ": has no ground motion of its own; copy its folder " +
                    shipped.parent_path().string() + " with the files that its model reads"};
}

int make_new(const NewOptions& options) {
  const fs::path folder = options.folder.has_filename() ? options.folder : options.folder.parent_path();
  const std::string name = folder.filename().string();
  if (!is_test_name(name)) {
    throw ConfigError{"NAME " + shown(folder.string()) + ": '" + shown(name) +
                      "' does not serve as the name of a test; "
                      "expected " +
                      std::string{kTestNameRule}};
  }
  std::error_code ignored;
  if (fs::exists(fs::symlink_status(folder, ignored))) {
    throw ConfigError{"NAME " + folder.string() + ": already exists; choose another name"};
  }
  const fs::path shipped = shipped_scenario(options.from);
  if (options.motion) static_cast<void>(read_ground_motion(*options.motion, motion_options(options)));
  const fs::path motion = options.motion ? *options.motion : motion_of(shipped, options.from);
  const fs::path motion_path = fs::path{"ground_motions"} / motion.filename();
  const std::string text =
      text_of_new(options, read_input_file(shipped, std::size_t{4} << 20U, "a scenario"), name, motion_path.string());
  const fs::path scenario = folder / "scenario.yaml";
  try {
    fs::create_directories(folder / motion_path.parent_path());
    fs::copy_file(motion, folder / motion_path);
    std::ofstream file{scenario, std::ios::binary};
    file << text;
    if (!file.flush()) throw fs::filesystem_error{"", scenario, std::make_error_code(std::errc::io_error)};
  } catch (const fs::filesystem_error& error) {
    throw ConfigError{"NAME " + folder.string() + ": cannot write there: " + error.code().message()};
  }
  const Scenario made = read_scenario(scenario, {});
  const double motion_s = read_ground_motion(made.excitation.records.front().file, motion_options(options)).end_s();
  fmt::print("{}: made from {}\nground motion {}: {:.6g} s; the test lasts {:.6g} s (time.duration_s)\n\n",
             scenario.string(), options.from, (folder / motion_path).string(), motion_s, made.time.duration_s);
  fmt::print("  hybridtest check {0}\n  hybridtest simulate {0} --seed 1\n  hybridtest run {0}\n", scenario.string());
  return kExitCompleted;
}

}  // namespace

void add_new_command(CLI::App& app, CommandAction& action) {
  auto options = std::make_shared<NewOptions>();
  CLI::App* command =
      app.add_subcommand("new", "Make a folder with a scenario and its ground motion that can be run and edited");
  command->add_option("NAME", options->folder, "Folder to make; its last part is the name of the test")->required();
  command->add_option("--from", options->from, "Shipped scenario to copy; an unknown name lists all of them")
      ->capture_default_str();
  CLI::Option* motion = command->add_option(
      "--motion", options->motion,
      "Ground motion to copy and use, unscaled, instead of that of the shipped scenario: PEER AT2, or "
      "text in one or two columns");
  command->add_option("--unit", options->unit, "Unit of the values of --motion, if the file does not name it")
      ->check(CLI::IsMember(unit_names()))
      ->needs(motion);
  command->add_option("--dt-s", options->dt_s, "Time step of a --motion with one column, in s")
      ->check(CLI::PositiveNumber)
      ->needs(motion);
  command->callback([options, &action] { action = [options] { return make_new(*options); }; });
}

}  // namespace hybridtest
