#include "scenario/catalogue/opensees_model.hpp"

#include <algorithm>
#include <regex>

#include "core/config_error.hpp"
#include "core/input_file.hpp"
#include "mechanics/structure/stiffness_matrix.hpp"
#include "numerical_substructure/opensees/opensees_model.hpp"

namespace hybridtest {
namespace {
using config::Section;

constexpr std::size_t kScriptBytes = std::size_t{64} << 20U;

/// Paths that a script names in `source`, literally or beside itself.
std::vector<std::string> sourced(const std::string& script) {
  static const std::regex kSource{
      R"((?:^|[\n;{])[ \t]*source[ \t]+(?:\[file join \[file dirname \[info script\]\] +)?"?([^\s;"\]\[$]+))"};
  std::vector<std::string> found;
  for (std::sregex_iterator one{script.begin(), script.end(), kSource}; one != std::sregex_iterator{}; ++one) {
    found.push_back((*one)[1]);
  }
  return found;
}

/// A file that the script reads. Its path starts at the folder of the script.
void add_file(const NamedFile& script, const std::string& path, std::vector<NamedFile>& files) {
  const std::filesystem::path file = script.file.parent_path() / path;
  if (why_unreadable(file)) return;  // a folder, or not there: OpenSees says so where it is needed
  const std::string written = (std::filesystem::path{script.written}.parent_path() / path).lexically_normal().string();
  if (std::ranges::any_of(files, [&](const NamedFile& known) { return known.written == written; })) return;
  files.push_back({.file = file, .written = written});
  for (const std::string& further : sourced(read_input_file(file, kScriptBytes, "a Tcl script"))) {
    add_file(script, further, files);
  }
}

std::filesystem::path read_script(Section& section, const std::filesystem::path& directory,
                                  std::vector<NamedFile>& files) {
  const NamedFile script{.file = named_file(section, "script", directory).value_or(""),
                         .written = section.text("script")};
  const std::vector<std::string> listed =
      section.has_optional("files") ? section.names("files") : std::vector<std::string>{};
  if (script.file.empty()) return {};
  if (const auto why = why_unreadable(script.file)) {
    section.error("script", script.file.string() + ": " + *why + "; expected a Tcl script");
    return {};
  }
  files.push_back(script);
  for (const std::string& path : sourced(read_input_file(script.file, kScriptBytes, "a Tcl script"))) {
    add_file(script, path, files);
  }
  for (const std::string& path : listed) {
    if (const auto why = why_unreadable(script.file.parent_path() / path)) {
      section.error("files", (script.file.parent_path() / path).string() + ": " + *why +
                                 "; a path starts at the folder of the script");
      continue;
    }
    add_file(script, path, files);
  }
  return script.file;
}

std::vector<OpenSeesDof> read_model_interface(Section& section, int dofs) {
  std::vector<OpenSeesDof> interface;
  for (Section& entry : section.sections("interface")) {
    OpenSeesDof dof{.node = static_cast<int>(entry.integer("node", 0, 2'000'000'000)),
                    .dof = static_cast<int>(entry.integer("dof", 1, 6)),
                    .is_rotation = entry.boolean("rotation", false)};
    const auto is_same = [&](const OpenSeesDof& other) { return other.node == dof.node && other.dof == dof.dof; };
    if (std::ranges::any_of(interface, is_same)) {
      entry.error("node", "dof " + std::to_string(dof.dof) + " of node " + std::to_string(dof.node) +
                              " is listed twice; each degree of freedom of the interface has one of its own");
    }
    interface.push_back(dof);
    entry.finish();
  }
  expect_count(section, "interface", interface.size(), dofs,
               ": {node: ..., dof: ...} for each entry of the `interface` of the substructure, in its order");
  interface.resize(static_cast<std::size_t>(dofs));
  return interface;
}

}  // namespace

Maker<SubstructureModel> read_opensees_model(Section& section, int dofs, double step_s,
                                             const std::filesystem::path& directory, std::vector<NamedFile>& files) {
  OpenSeesSettings settings;
  settings.script = read_script(section, directory, files);
  settings.interface = read_model_interface(section, dofs);
  settings.program = section.text("program", "");
  settings.length_unit_m = section.number("length_unit_m", {.low = 1e-6, .high = 1e6}, 1.0);
  settings.force_unit_n = section.number("force_unit_n", {.low = 1e-6, .high = 1e12}, 1.0);
  settings.tolerance_m = section.number("tolerance_m", {.low = 1e-15, .high = 1e-3}, kOpenSeesTolerance_m);
  settings.answer_timeout =
      from_seconds(section.number("answer_timeout_s", {.low = 0.1, .high = 86400.0}, kOpenSeesAnswer_s));
  settings.step_s = step_s;
  if (section.has_optional("initial_stiffness_n_per_m")) {
    const auto size = static_cast<std::size_t>(dofs);
    try {
      settings.initial_stiffness_n_per_m = checked_stiffness(section.matrix("initial_stiffness_n_per_m", size, size));
    } catch (const ConfigError& error) {
      section.error("initial_stiffness_n_per_m", error.what());
    }
  }
  return [settings] { return std::make_unique<OpenSeesModel>(settings); };
}

}  // namespace hybridtest
