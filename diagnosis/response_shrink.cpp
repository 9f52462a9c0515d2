#include "diagnosis/response_shrink.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/assert.hpp"

namespace hybridtest {

namespace {

double square(double value) noexcept { return value * value; }

/// What the completed model leaves of these tests on average [mean square over that of the response].
double energy_left(std::span<const PossibleTest> tests) {
  double sum = 0.0;
  for (const PossibleTest& test : tests) sum += square(test.error.nrmse);
  return sum / static_cast<double>(tests.size());
}

/// Smallest and largest of a number over tests.
template <typename Number>
report::Interval extremes(std::span<const PossibleTest> tests, const Number& number) {
  const auto [least, most] = std::ranges::minmax(tests, {}, number);
  return {number(least), number(most)};
}

void add_floor(std::span<const PossibleTest> of_noise, report::ResponseShrink& shrink) {
  if (of_noise.empty()) return;
  const double before = square(shrink.nrmse_before);
  const double after = square(shrink.nrmse_after);
  const double floor = energy_left(of_noise);
  shrink.floor_nrmse = std::sqrt(floor);
  if (before > floor) shrink.explainable_fraction = std::min(1.0, (before - after) / (before - floor));
  if (before > 0.0) shrink.unknown_share = std::max(0.0, after - floor) / before;
}

/// Of an error of one number. What is left of it beyond the average of the draws repeats, and adds to theirs.
template <typename Number>
report::Interval error_left(std::span<const PossibleTest> tests, double after, const Number& number) {
  double average = 0.0;
  for (const PossibleTest& test : tests) average += number(test) / static_cast<double>(tests.size());
  const report::Interval drawn = extremes(tests, number);
  return {drawn.low, drawn.high + std::max(0.0, after - average)};
}

void add_intervals(const PossibleTests& possible, report::ResponseShrink& shrink) {
  const double repeats = std::max(0.0, square(shrink.nrmse_after) - energy_left(possible.of_both));
  std::vector<PossibleTest> tests = possible.of_both;
  tests.insert(tests.end(), possible.of_noise.begin(), possible.of_noise.end());
  const report::Interval left = extremes(tests, [](const PossibleTest& test) { return test.error.nrmse; });
  shrink.nrmse_after_ci95 = {left.low, std::sqrt(square(left.high) + repeats)};
  if (const double before = square(shrink.nrmse_before); before > 0.0) {
    shrink.ci95 = {1.0 - square(shrink.nrmse_after_ci95->high) / before, 1.0 - square(left.low) / before};
  }
  shrink.peak_error_after_ci95 =
      error_left(tests, shrink.peak_error_after, [](const PossibleTest& test) { return test.error.peak_error; });
  if (shrink.energy_error_after) {
    shrink.energy_error_after_ci95 =
        error_left(tests, *shrink.energy_error_after, [](const PossibleTest& test) { return test.error.energy_error; });
  }
  for (std::size_t dof = 0; dof < shrink.peaks.size(); ++dof) {
    const auto peak = [&](const PossibleTest& test) { return test.peaks_m[static_cast<Eigen::Index>(dof)]; };
    shrink.peaks[dof].ci95 = extremes(tests, peak);
  }
  shrink.energy_taken->ci95 = extremes(tests, [](const PossibleTest& test) { return test.energy_taken_j; });
}

}  // namespace

PossibleTest possible_test(const TestResponse& drawn, const TestResponse& completed) {
  return {.error = response_error(drawn, completed),
          .peaks_m = peaks_m(drawn, drawn.steps()),
          .energy_taken_j = energy_taken_j(drawn, drawn.steps())};
}

report::ResponseShrink response_shrink(const TestResponse& recorded, const TestResponse& given,
                                       const TestResponse& completed, const PossibleTests& possible,
                                       std::span<const std::string> names) {
  HYBRIDTEST_ASSERT(std::ssize(names) == recorded.displacement_m.rows());
  const ResponseError before = response_error(recorded, given);
  const ResponseError after = response_error(recorded, completed);
  report::ResponseShrink shrink{.nrmse_before = before.nrmse,
                                .nrmse_after = after.nrmse,
                                .peak_error_before = before.peak_error,
                                .peak_error_after = after.peak_error,
                                .energy_error_before = before.energy_error,
                                .energy_error_after = after.energy_error};
  if (before.nrmse > 0.0) shrink.variance_removed = 1.0 - square(after.nrmse / before.nrmse);
  add_floor(possible.of_noise, shrink);
  if (possible.of_both.empty()) return shrink;
  const Eigen::Index steps = std::min(recorded.steps(), completed.steps());
  const Eigen::VectorXd real_m = peaks_m(recorded, steps);
  const Eigen::VectorXd predicted_m = peaks_m(completed, steps);
  for (std::size_t dof = 0; dof < names.size(); ++dof) {
    const auto row = static_cast<Eigen::Index>(dof);
    shrink.peaks.push_back({.of = names[dof], .recorded = real_m[row], .predicted = predicted_m[row]});
  }
  shrink.energy_taken = {
      .of = {}, .recorded = energy_taken_j(recorded, steps), .predicted = energy_taken_j(completed, steps)};
  add_intervals(possible, shrink);
  return shrink;
}

}  // namespace hybridtest
