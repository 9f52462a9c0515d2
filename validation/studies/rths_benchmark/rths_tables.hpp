#pragma once

#include <span>
#include <string>
#include <vector>

#include "validation/studies/rths_benchmark/harness_check.hpp"
#include "validation/studies/rths_benchmark/rths_study.hpp"
#include "validation/studies/rths_benchmark/verdict.hpp"

namespace hybridtest::rths {

/// `table.csv`: compensator, case, motion, plant (`nominal` or its number), J1 … J9, peak_force_n. The criteria
/// of a run that did not reach its end are `nan`.
[[nodiscard]] std::string criteria_csv(const std::vector<Candidate>& candidates, std::span<const StudyRun> runs);

/// `tracking.csv`: beside each J2 its floors and J2 of the displacement without sensor noise, the delay that
/// J1 cannot show, and how the run ended.
[[nodiscard]] std::string tracking_csv(const BenchmarkInputs& inputs, const std::vector<Candidate>& candidates,
                                       std::span<const StudyRun> runs);

/// `summary.md`.
[[nodiscard]] std::string summary_markdown(const BenchmarkInputs& inputs, const HarnessCheck& check,
                                           const std::vector<Candidate>& candidates, std::span<const StudyRun> runs,
                                           const StudySettings& settings);

}  // namespace hybridtest::rths
