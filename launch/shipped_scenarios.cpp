#include "launch/shipped_scenarios.hpp"

#include <algorithm>
#include <fstream>
#include <system_error>

#include "core/config_error.hpp"
#include "core/text/shown.hpp"

namespace hybridtest {
namespace {

/// A site file, which has no schema, is no scenario.
bool is_scenario(const std::filesystem::path& file) {
  std::ifstream stream{file};
  for (std::string line; std::getline(stream, line);) {
    if (line.starts_with("schema:")) return true;
  }
  return false;
}

std::vector<std::string> shipped_names(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : std::filesystem::recursive_directory_iterator{folder, error}) {
    if (entry.path().extension() != ".yaml" || !is_scenario(entry.path())) continue;
    names.push_back(entry.path().lexically_relative(folder).replace_extension().string());
  }
  if (error) {
    throw ConfigError{folder.string() + ": the scenarios that ship with this program are not there (" +
                      error.message() + "); install the program again, or copy a scenario file by hand"};
  }
  std::ranges::sort(names);
  return names;
}

}  // namespace

std::filesystem::path shipped_scenarios() {
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe");
  return program.parent_path().parent_path() / "share/hybridtest/scenarios";
}

std::filesystem::path shipped_scenario(std::string_view name) {
  const std::filesystem::path folder = shipped_scenarios();
  const std::vector<std::string> names = shipped_names(folder);
  if (std::ranges::find(names, name) == names.end()) {
    throw ConfigError{"--from " + shown(name) + ": no shipped scenario has this name" +
                      name_advice(name, names, "shipped")};
  }
  return folder / (std::string{name} + ".yaml");
}

}  // namespace hybridtest
