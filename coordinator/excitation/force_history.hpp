#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "coordinator/excitation/time_history.hpp"

namespace hybridtest {

/// Forces over time from a file, one for each of its columns.
struct ForceHistory {
  std::vector<std::string> columns;    // names, without the unit
  std::vector<TimeHistory> histories;  // [N], one per column
};

/// Larger forces are a wrong unit and would overflow later.
inline constexpr double kForce_n_max = 1e15;
/// Most columns of a file of forces.
inline constexpr std::size_t kForceColumnsMax = 10'000;

/// Reads columns of text, separated by blanks or commas: the time in s, equally spaced within one percent of the step,
/// then one force per column. The first line names them, each with its unit: `time_s,roof.x_n` or `_kn`.
/// @throws ConfigError with file, line and what was expected, as read_ground_motion().
[[nodiscard]] ForceHistory read_force_history(const std::filesystem::path& file);
/// The same from text. `name` is the file name in messages.
[[nodiscard]] ForceHistory parse_force_history(std::string_view text, const std::string& name);

}  // namespace hybridtest
