#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace hybridtest {

/// The folder of the scenarios that ship with the program: `../share/hybridtest/scenarios`, seen from the folder of
/// this program, in the build folder as where it is installed.
[[nodiscard]] std::filesystem::path shipped_scenarios();

/// The file of a shipped scenario, such as `two_storey_one_site` or `founding_study/exact`.
/// @throws ConfigError for an unknown name; lists the known ones.
[[nodiscard]] std::filesystem::path shipped_scenario(std::string_view name);

}  // namespace hybridtest
