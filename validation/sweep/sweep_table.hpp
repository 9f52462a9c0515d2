#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "validation/sweep/sweep_plan.hpp"

namespace hybridtest {

/// The results of a sweep: one row per case in the order of their numbers, empty cells where a case has no such result
/// or is not done. It has nothing that depends on the machine.
struct SweepTable {
  std::vector<std::string> columns;  // case, seed, one per key that varies, then results with their units
  std::vector<std::vector<std::string>> rows;
  std::size_t done = 0;  // rows with results

  /// Position of a column. @throws ConfigError naming the columns that there are.
  [[nodiscard]] std::size_t column(std::string_view name) const;
};

/// Reads the results that are there.
[[nodiscard]] SweepTable read_results(const SweepPlan& plan, const SweepFiles& files);

/// Comma separated, with quotes where a cell needs them.
[[nodiscard]] std::string to_csv(const SweepTable& table);

}  // namespace hybridtest
