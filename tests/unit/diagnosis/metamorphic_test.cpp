#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "core/random.hpp"
#include "diagnosis/diagnose.hpp"
#include "diagnosis/intake/intake.hpp"
#include "mechanics/laws/presliding_element.hpp"
#include "plant/transfer_systems/ideal.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

// What changes nothing in the specimen changes nothing in the answer.
namespace hybridtest {
namespace {

constexpr double kDuration_s = 6.0;
constexpr double kFriction_n = 4000.0;

/// How the same test was recorded.
struct Recorded {
  double rate_hz = 500.0;
  double metre = 1.0;  // of this test in metres of the plain one
  double newton = 1.0;
  double sign = 1.0;
  double begins_s = 0.0;
  int times = 1;
};

/// Dry friction beside a spring that the model knows.
Recording recording_of(const Recorded& how) {
  const auto samples = static_cast<std::size_t>(kDuration_s * how.rate_hz);
  std::string text = "time_s,measured_displacement_m,measured_force_n\n";
  PreslidingElement friction{2e-4};
  Random random{11};
  for (std::size_t i = 0; i < samples * static_cast<std::size_t>(how.times); ++i) {
    const double time_s = static_cast<double>(i) / how.rate_hz;
    // A whole number of cycles of either sine, so that the test goes on when it is repeated.
    const double place_m =
        0.02 * std::sin(2.0 * std::numbers::pi * time_s) + 0.008 * std::sin(2.0 * std::numbers::pi * 2.5 * time_s);
    const double force_n =
        kMadeStiffness_n_per_m * place_m + kFriction_n * friction.share(place_m) + 20.0 * random.normal();
    text += fmt::format("{:.4f},{:.9f},{:.5f}\n", how.begins_s + time_s,
                        how.sign * how.metre * (place_m + 1e-6 * random.normal()), how.sign * how.newton * force_n);
  }
  Intake intake = read_csv_recording(text, "made.csv");
  EXPECT_TRUE(intake.recording.has_value()) << intake.findings.front().text("made.csv");
  return intake.recording.value();
}

report::DiagnosisReport answer_of(const Recorded& how) {
  const double stiffness_n_per_m = kMadeStiffness_n_per_m * how.newton / how.metre;
  SiteModel model = made_model();
  model.make_law = [stiffness_n_per_m] { return std::make_unique<Elastic>(stiffness_n_per_m); };
  const Recording recording = recording_of(how);
  return diagnose(model, {&recording, 1}, {}).report;
}

void expect_friction(const Recorded& how) {
  const report::DiagnosisReport answer = answer_of(how);
  EXPECT_EQ(answer.verdict, report::Verdict::named);
  ASSERT_FALSE(answer.ranking.empty());
  EXPECT_EQ(std::ranges::count_if(answer.ranking, &report::RankedCause::is_cause), 1);
  const report::RankedCause& cause = answer.ranking.front();
  EXPECT_EQ(cause.interface, "specimen");
  EXPECT_EQ(cause.effect, "coulomb_friction");
  EXPECT_NEAR(cause.parameters.front().value, how.newton * kFriction_n, 0.01 * how.newton * kFriction_n);
  EXPECT_NEAR(answer.interface_shrink->variance_removed, 1.0, 0.01);
}

TEST(Metamorphic, PlainTest) { expect_friction({}); }

TEST(Metamorphic, UnitsDoNotMatter) {
  expect_friction({.newton = 1e-3});
  expect_friction({.metre = 10.0, .newton = 300.0});
}

TEST(Metamorphic, SignConventionOfBothChannelsDoesNotMatter) { expect_friction({.sign = -1.0}); }

TEST(Metamorphic, SamplingRateDoesNotMatter) {
  expect_friction({.rate_hz = 1000.0});
  expect_friction({.rate_hz = 250.0});
}

TEST(Metamorphic, TheSameTestTwiceIsTheSameAnswer) { expect_friction({.times = 2}); }

TEST(Metamorphic, TimeOfDayDoesNotMatter) { expect_friction({.begins_s = 3600.0}); }

}  // namespace
}  // namespace hybridtest
