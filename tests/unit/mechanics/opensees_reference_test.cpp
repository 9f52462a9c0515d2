#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <ostream>
#include <string>

#include "mechanics/laws/bilinear.hpp"
#include "mechanics/laws/bouc_wen.hpp"
#include "mechanics/laws/elastic.hpp"
#include "mechanics/laws/giuffre_menegotto_pinto.hpp"
#include "tests/unit/mechanics/reference_history.hpp"

/// Each law follows the first storey of a committed OpenSees history (tests/reference) and is compared with its force.
/// Never skipped; the tests beside this one compare with another motion where the recorded data stand.
namespace hybridtest {
namespace {

struct FirstStorey {
  std::string reference;
  std::function<std::unique_ptr<Law>()> make_law;
  double tolerance;  // share of the largest force
};

void PrintTo(const FirstStorey& storey, std::ostream* stream) { *stream << storey.reference; }

class CommittedReference : public testing::TestWithParam<FirstStorey> {};

double largest_force_error(Law& law, const ReferenceHistory& reference) {
  constexpr int kStepsPerSample = 100;  // 0.0001 s, as the reference was computed
  double largest_n = 0.0;
  for (std::size_t i = 1; i < reference.force_n.size(); ++i) {
    double force_n = 0.0;
    for (int step = 1; step <= kStepsPerSample; ++step) {
      force_n = law.trial(reference.displacement_between(i - 1, static_cast<double>(step) / kStepsPerSample), 0.0);
      law.commit();
    }
    largest_n = std::max(largest_n, std::abs(force_n - reference.force_n[i]));
  }
  return largest_n / reference.largest_force_n();
}

TEST_P(CommittedReference, LawGivesTheForceOfOpenSees) {
  const ReferenceHistory reference =
      read_reference(std::string{HYBRIDTEST_SOURCE_DIR} + "/tests/reference/" + GetParam().reference + ".csv");
  ASSERT_EQ(reference.force_n.size(), 3101U);
  const double error = largest_force_error(*GetParam().make_law(), reference);
  RecordProperty("largest_force_error", std::to_string(error));
  EXPECT_LE(error, GetParam().tolerance);
}

// What remains of bilinear and steel02 is the interpolation of the displacement between samples of 0.01 s (up to 1.9e-6
// m, 1.3e-4 of the largest force), because the design motion has a corner every 0.005 s. OpenSees integrates its
// Bouc-Wen law by backward Euler, to first order.
INSTANTIATE_TEST_SUITE_P(
    Laws, CommittedReference,
    testing::Values(
        FirstStorey{"two_storey_linear", [] { return std::make_unique<Elastic>(4.0e6); },
                    3e-8 /* measured 1.9e-8: digits */},
        FirstStorey{"two_storey_bilinear",
                    [] {
                      return std::make_unique<Bilinear>(Bilinear::Parameters{
                          .stiffness_n_per_m = 4.0e6, .yield_force_n = 40.0e3, .hardening_ratio = 0.05});
                    },
                    8e-5 /* measured 6.8e-5 */},
        FirstStorey{"two_storey_steel02",
                    [] {
                      return std::make_unique<GiuffreMenegottoPinto>(
                          GiuffreMenegottoPinto::Parameters{.stiffness_n_per_m = 4.0e6,
                                                            .yield_force_n = 40.0e3,
                                                            .hardening_ratio = 0.03,
                                                            .r0 = 18.0,
                                                            .cr1 = 0.925,
                                                            .cr2 = 0.15});
                    },
                    1.1e-4 /* measured 9.3e-5 */},
        FirstStorey{"two_storey_boucwen",
                    [] {
                      return std::make_unique<BoucWen>(BoucWen::Parameters{
                          .stiffness_n_per_m = 4.0e6, .alpha = 0.1, .n = 1.0, .gamma_per_m = 50.0, .beta_per_m = 50.0});
                    },
                    3.3e-4 /* measured 2.8e-4 */},
        FirstStorey{"three_storey_base_isolated",
                    [] {
                      return std::make_unique<BoucWen>(BoucWen::Parameters{
                          .stiffness_n_per_m = 6.4e6, .alpha = 0.1, .n = 1.0, .gamma_per_m = 90.0, .beta_per_m = 90.0});
                    },
                    2.9e-4 /* measured 2.5e-4 */}),
    [](const auto& instance) { return instance.param.reference; });

}  // namespace
}  // namespace hybridtest
