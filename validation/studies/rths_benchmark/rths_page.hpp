#pragma once

#include <span>
#include <string>
#include <vector>

#include "validation/studies/rths_benchmark/rths_study.hpp"

namespace hybridtest::rths {

/// `plots.html`: one page that needs no network. Runs some of the candidates again for their histories.
[[nodiscard]] std::string page_html(const BenchmarkInputs& inputs, const std::vector<Candidate>& candidates,
                                    std::span<const StudyRun> runs, const StudySettings& settings);

/// Its first figure: tracking and structure errors of every compensator, a row for each.
[[nodiscard]] std::string error_figure(const BenchmarkInputs& inputs, const std::vector<Candidate>& candidates,
                                       std::span<const StudyRun> runs);

}  // namespace hybridtest::rths
