#pragma once

#include <array>
#include <span>

namespace hybridtest::rths {

/// After removing the mean. @param values   not empty.
[[nodiscard]] double standard_deviation(std::span<const double> values);
[[nodiscard]] double largest_magnitude(std::span<const double> values);

/// 100 std(values - of) / std(of). Both of one length.
[[nodiscard]] double deviation_error_percent(std::span<const double> values, std::span<const double> of);
/// 100 max |values - of| / max |of|.
[[nodiscard]] double peak_error_percent(std::span<const double> values, std::span<const double> of);
/// The lag [s], 0 to 49 samples, at which the sum of follower(i) leader(i - lag) is largest. A follower that
/// is ahead reads 0.
[[nodiscard]] double correlation_lag_s(std::span<const double> follower, std::span<const double> leader,
                                       double period_s);
/// The delay [s] of a follower by least squares of follower - leader on the leader's rate: finer than a
/// sample, negative for a lead; for delays that are short against the motion.
[[nodiscard]] double fitted_delay_s(std::span<const double> follower, std::span<const double> leader, double period_s);

/// The recorded signals of a run, one value per sample.
struct TestSignals {
  std::span<const double> target_m;    // x_n of floor 1
  std::span<const double> measured_m;  // x_m, with sensor noise
  std::span<const double> floor_2_m;
  std::span<const double> floor_3_m;
};

/// The motion of the reference structure.
struct ReferenceSignals {
  std::span<const double> floor_1_m;
  std::span<const double> floor_2_m;
  std::span<const double> floor_3_m;
};

/// J1 [ms] and J2 to J9 [%] of the benchmark.
struct Criteria {
  static constexpr std::size_t kCount = 9;
  std::array<double, kCount> values{};

  /// @param number   1 to 9.
  [[nodiscard]] double j(std::size_t number) const noexcept { return values[number - 1]; }
};

[[nodiscard]] Criteria evaluate_criteria(const TestSignals& test, const ReferenceSignals& reference, double period_s);
/// All values NaN, for a run that did not reach its end.
[[nodiscard]] Criteria no_criteria() noexcept;

}  // namespace hybridtest::rths
