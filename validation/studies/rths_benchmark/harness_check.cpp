#include "validation/studies/rths_benchmark/harness_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "compensation/no_compensation.hpp"
#include "compensation/no_force_compensation.hpp"
#include "validation/studies/parallel_runs.hpp"
#include "validation/studies/rths_benchmark/virtual_run.hpp"

namespace hybridtest::rths {
namespace {

/// Values from an implementation of the benchmark that shares no code with this one.
constexpr std::array<PublishedRow, HarnessCheck::kRows> kPublished{{
    {1, 0, {{4.64, 10.15, 10.75, 35.95, 17.57, 32.23, 32.35, 14.81, 14.75}}},
    {1, 1, {{4.64, 9.94, 10.33, 25.93, 16.17, 23.09, 23.16, 13.95, 13.88}}},
    {2, 0, {{4.64, 9.58, 10.32, 32.96, 16.37, 30.45, 30.54, 15.26, 15.22}}},
    {3, 0, {{4.64, 8.95, 9.61, 49.78, 35.94, 49.74, 49.75, 35.48, 35.53}}},
    {4, 0, {{4.64, 10.37, 10.62, 72.48, 34.45, 68.45, 68.61, 33.39, 33.26}}},
}};

VirtualTest nominal_test(const BenchmarkInputs& inputs, int case_number, std::size_t motion) {
  return {.case_number = case_number,
          .motion = inputs.motion(motion),
          .reference = inputs.reference(case_number, motion),
          .plant = {},
          .has_sensor_noise = false};
}

Criteria run_released(const BenchmarkInputs& inputs, const PublishedRow& row) {
  ReleasedController controller;
  NoForceCompensation no_force_compensation;
  return run_virtual_test(nominal_test(inputs, row.case_number, row.motion), controller, no_force_compensation)
      .criteria;
}

bool diverges_uncompensated(const BenchmarkInputs& inputs, int case_number, std::size_t motion) {
  CompensatedPath path{std::make_unique<NoCompensation>(), Arrangement::straight};
  NoForceCompensation no_force_compensation;
  return !run_virtual_test(nominal_test(inputs, case_number, motion), path, no_force_compensation).is_complete;
}

}  // namespace

std::span<const PublishedRow> published_rows() { return kPublished; }

HarnessCheck check_harness(const BenchmarkInputs& inputs, unsigned threads) {
  constexpr std::size_t kUncompensated = kCases * kMotions;
  HarnessCheck check;
  std::array<bool, kUncompensated> diverged{};
  run_in_parallel(HarnessCheck::kRows + kUncompensated, threads, [&](std::size_t i) {
    if (i < HarnessCheck::kRows) {
      check.found[i] = run_released(inputs, kPublished[i]);
    } else {
      const std::size_t run = i - HarnessCheck::kRows;
      diverged[run] = diverges_uncompensated(inputs, static_cast<int>(run / kMotions) + 1, run % kMotions);
    }
  });
  for (std::size_t row = 0; row < HarnessCheck::kRows; ++row) {
    for (std::size_t j = 1; j <= Criteria::kCount; ++j) {
      const double published = kPublished[row].criteria.j(j);
      const double deviation = std::abs(check.found[row].j(j) / published - 1.0);
      // NaN counts as an infinite deviation.
      check.largest_deviation_share =
          std::isfinite(deviation) ? std::max(check.largest_deviation_share, deviation) : HUGE_VAL;
    }
  }
  check.uncompensated_runs = static_cast<int>(kUncompensated);
  check.uncompensated_diverged = static_cast<int>(std::ranges::count(diverged, true));
  return check;
}

std::string to_markdown(const HarnessCheck& check) {
  std::string text =
      "| case, motion | | J1 [ms] | J2 | J3 | J4 | J5 | J6 | J7 | J8 | J9 [%] |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
  for (std::size_t row = 0; row < HarnessCheck::kRows; ++row) {
    const PublishedRow& published = kPublished[row];
    const auto add = [&](std::string_view what, const Criteria& criteria) {
      text += fmt::format("| {}, {} | {} |", published.case_number, kMotionNames[published.motion], what);
      for (const double value : criteria.values) text += fmt::format(" {:.2f} |", value);
      text += '\n';
    };
    add("published", published.criteria);
    add("here", check.found[row]);
  }
  text += fmt::format(
      "\nLargest deviation of any value: {:.2f} % (at most {:.0f} %). Without compensation {} of {} runs "
      "diverge to the force limit.\n{}\n",
      100.0 * check.largest_deviation_share, 100.0 * HarnessCheck::kToleranceShare, check.uncompensated_diverged,
      check.uncompensated_runs,
      check.is_confirmed() ? "The harness is confirmed."
                           : "The harness is NOT confirmed: results of a study would not be valid.");
  return text;
}

}  // namespace hybridtest::rths
