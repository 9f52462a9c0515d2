#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "diagnosis/result/diagnosis_report.hpp"
#include "diagnosis/test_response.hpp"

namespace hybridtest {

/// A test that might have been recorded if the completed model is right: with another draw of the noise of the sensors,
/// and with other parameters within their intervals. What is kept of it.
struct PossibleTest {
  ResponseError error;  // that the completed model leaves of it
  Eigen::VectorXd peaks_m;
  double energy_taken_j = 0.0;
};

[[nodiscard]] PossibleTest possible_test(const TestResponse& drawn, const TestResponse& completed);

/// So many draws that one more of the same kind lies between the smallest and the largest of them in 95 %:
/// (n - 1) / (n + 1), whatever their distribution.
[[nodiscard]] constexpr std::size_t draws_for_95() noexcept { return 39; }

struct PossibleTests {
  std::vector<PossibleTest> of_noise;  // other noise, parameters as found: what a right model leaves
  std::vector<PossibleTest> of_both;   // other noise and other parameters; draws_for_95() of them for an interval
};

/// How far the causes shrink the difference between the recorded and the simulated test, with its floor, what is left
/// unknown, and intervals.
///
/// The simulated tests have no noise of the sensors; the recorded one has, in its loop. The floor is the root mean
/// square of what that noise alone changes of the completed model's response.
///
/// The intervals are of a test of the same structure and ground motion that is not recorded yet: of its peaks, its
/// energy, and what the completed model leaves and removes of it. They go from the smallest to the largest of all
/// draws, so they hold it in 95 % or more where the completed model has the right form. Where it has not, what it
/// leaves beyond noise and doubt in the parameters comes back in each test: that widens what may be left of response,
/// peaks and energy, but not the intervals of peaks and energy themselves.
/// @param names   one per degree of freedom of the response.
[[nodiscard]] report::ResponseShrink response_shrink(const TestResponse& recorded, const TestResponse& given,
                                                     const TestResponse& completed, const PossibleTests& possible,
                                                     std::span<const std::string> names);

}  // namespace hybridtest
