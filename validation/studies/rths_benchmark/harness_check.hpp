#pragma once

#include <array>
#include <span>
#include <string>

#include "validation/studies/rths_benchmark/benchmark_inputs.hpp"
#include "validation/studies/rths_benchmark/criteria.hpp"

namespace hybridtest::rths {

/// A row of the published table: the released controller on the nominal plant, without sensor noise.
struct PublishedRow {
  int case_number = 0;
  std::size_t motion = 0;
  Criteria criteria;
};

[[nodiscard]] std::span<const PublishedRow> published_rows();

/// Checks that this harness reproduces the benchmark: the released controller must give the published values,
/// and the plant without compensation must reach its force limit under every motion and in every case.
struct HarnessCheck {
  static constexpr double kToleranceShare = 0.03;
  static constexpr std::size_t kRows = 5;

  std::array<Criteria, kRows> found;
  double largest_deviation_share = 0.0;  // of any value from its published one
  int uncompensated_runs = 0;
  int uncompensated_diverged = 0;

  [[nodiscard]] bool is_confirmed() const noexcept {
    return largest_deviation_share <= kToleranceShare && uncompensated_diverged == uncompensated_runs;
  }
};

[[nodiscard]] HarnessCheck check_harness(const BenchmarkInputs& inputs, unsigned threads);

/// As a table in Markdown, the published values beside those found.
[[nodiscard]] std::string to_markdown(const HarnessCheck& check);

}  // namespace hybridtest::rths
