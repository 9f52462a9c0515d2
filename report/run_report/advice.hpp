#pragma once

#include <string>
#include <vector>

#include "recording/summary/run_summary.hpp"

namespace hybridtest::run_report {

/// How good the end of a test is, for the colour of its verdict.
enum class Standing { good, fair, bad };

[[nodiscard]] Standing standing_of(const RunSummary& summary);

/// What happened and what to do next, one sentence or two for each finding, the most urgent first. Empty for a test
/// that completed with valid data and without a remark.
[[nodiscard]] std::vector<std::string> advice_for(const RunSummary& summary);

}  // namespace hybridtest::run_report
