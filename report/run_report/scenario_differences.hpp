#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace hybridtest::run_report {

/// A line of a text beside another.
struct DiffLine {
  enum class Kind { same, removed, added };
  Kind kind = Kind::same;
  std::string text;
};

/// The lines of `after`, with those that only `before` has where they stood: the longest common subsequence of lines.
[[nodiscard]] std::vector<DiffLine> line_differences(std::string_view before, std::string_view after);

/// The lines that differ, each with the keys above it (`substructures > compensator > delay_s: 0.02`); removed and
/// added ones. Both texts are effective scenarios, which list the keys in the same order.
[[nodiscard]] std::vector<DiffLine> scenario_differences(std::string_view before, std::string_view after);

}  // namespace hybridtest::run_report
