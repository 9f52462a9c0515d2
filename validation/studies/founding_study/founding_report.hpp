#pragma once

#include <span>
#include <string>

#include "validation/studies/founding_study/findings.hpp"

namespace hybridtest::founding {

/// `table.csv`: one row per method.
[[nodiscard]] std::string table_csv(std::span<const MethodRun> runs);
/// `summary.md`: the findings and the table.
[[nodiscard]] std::string summary_markdown(std::span<const MethodRun> runs);
/// `plots.html`: the methods ranked by their error, error curves, displacement against exact, one figure per method as
/// in the study, and the forces near a jump.
[[nodiscard]] std::string page_html(std::span<const MethodRun> runs);

}  // namespace hybridtest::founding
