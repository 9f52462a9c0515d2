#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <ostream>
#include <string>
#include <tuple>
#include <vector>

#include "core/random.hpp"
#include "diagnosis/diagnose.hpp"
#include "diagnosis/intake/intake.hpp"
#include "mechanics/laws/bilinear.hpp"
#include "mechanics/laws/presliding_element.hpp"
#include "plant/transfer_systems/ideal.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

// What changes nothing in the specimen changes nothing in the answer.
namespace hybridtest {
namespace {

constexpr double kDuration_s = 6.0;
constexpr double kFriction_n = 4000.0;
constexpr double kStrength_n = 24e3;  // at 12 mm, of 27 mm
constexpr double kHardeningRatio = 0.05;

/// How the same test was recorded, and what its user takes the specimen's stiffness for.
struct Recorded {
  std::string name;
  double rate_hz = 500.0;
  double metre = 1.0;  // of this test in metres of the plain one
  double newton = 1.0;
  double sign = 1.0;
  double begins_s = 0.0;
  int times = 1;
  std::size_t dof = 0;     // of two, the other being a spring that the model has; 0: of one
  double believed = 1.0;   // stiffness of the user's spring over the real one
  double stretched = 1.0;  // time stamps of a slow test, over those of this one
  bool has_steps = false;  // in the place of time stamps

  friend void PrintTo(const Recorded& how, std::ostream* out) { *out << how.name; }
};

/// A parameter of a cause, in SI, and how it grows with the units of force and length.
struct Expected {
  std::string_view parameter;
  double value = 0.0;
  double newtons = 0.0;
  double metres = 0.0;
};

/// What the specimen is, what the user's model lacks, and what is to be found.
struct Specimen {
  std::string name;
  std::function<std::function<double(double)>()> force_n;  // of a displacement, with its history
  std::function<std::unique_ptr<Law>(const Recorded&)> believed;
  std::string_view effect;
  std::vector<Expected> parameters;
  // Of a spring beside the cause; a cause with its own stiffness stands alone.
  bool has_own_stiffness = true;

  friend void PrintTo(const Specimen& specimen, std::ostream* out) { *out << specimen.name; }
};

std::function<double(double)> following(const std::shared_ptr<Law>& law) {
  return [law](double place_m) {
    const double force_n = law->trial(place_m, 0.0);
    law->commit();
    return force_n;
  };
}

std::function<double(double)> yields() {
  return following(
      std::make_shared<Bilinear>(Bilinear::Parameters{kMadeStiffness_n_per_m, kStrength_n, kHardeningRatio}));
}

std::function<double(double)> rubs() {
  return [friction = PreslidingElement{2e-4}](double place_m) mutable {
    return kMadeStiffness_n_per_m * place_m + kFriction_n * friction.share(place_m);
  };
}

double believed_stiffness(const Recorded& how) {
  return how.believed * kMadeStiffness_n_per_m * how.newton / how.metre;
}

std::unique_ptr<Law> a_spring(const Recorded& how) { return std::make_unique<Elastic>(believed_stiffness(how)); }

std::unique_ptr<Law> too_strong(const Recorded& how) {
  return std::make_unique<Bilinear>(
      Bilinear::Parameters{believed_stiffness(how), 1.25 * kStrength_n * how.newton, kHardeningRatio});
}

const std::vector<Expected> kYielding{{"stiffness_n_per_m", kMadeStiffness_n_per_m, 1.0, -1.0},
                                      {"yield_force_n", kStrength_n, 1.0},
                                      {"hardening_ratio", kHardeningRatio}};

const std::vector<Specimen> kSpecimens{
    {"RubsBesideASpring", rubs, a_spring, "coulomb_friction", {{"friction_force_n", kFriction_n, 1.0}}, false},
    {"YieldsUnderASpring", yields, a_spring, "yielding", kYielding},
    {"YieldsEarlier", yields, too_strong, "strength_error", {{"strength_error_ratio", -0.2}}},
};

const std::vector<Recorded> kRecorded{
    {.name = "Plain"},
    {.name = "WeakerInSi", .newton = 1e-3},
    {.name = "StrongerInSi", .newton = 100.0},
    {.name = "LongerAndStrongerInSi", .metre = 10.0, .newton = 300.0},
    {.name = "ShorterInSi", .metre = 0.1},
    {.name = "OtherSign", .sign = -1.0},
    {.name = "TwiceTheRate", .rate_hz = 1000.0},
    {.name = "HalfTheRate", .rate_hz = 250.0},
    {.name = "Twice", .times = 2},
    {.name = "AnHourLater", .begins_s = 3600.0},
    {.name = "SecondDof", .dof = 1},
    {.name = "PseudoTimeTenTimes", .stretched = 10.0},
    {.name = "PseudoTimeASecondAPoint", .stretched = 500.0},
    {.name = "Steps", .has_steps = true},
};

const std::vector<Recorded> kBelieved{
    {.name = "ATenthOfTheStiffness", .believed = 0.1},
    {.name = "HalfTheStiffness", .believed = 0.5},
    {.name = "ThreeTimesTheStiffness", .believed = 3.0},
    {.name = "TenTimesTheStiffness", .believed = 10.0},
};

/// Readings of displacement and force, as a file has them.
std::string readings(const Recorded& how, double place_m, double force_n, Random& random) {
  const double read_m = how.sign * how.metre * (place_m + 1e-6 * random.normal());
  const double read_n = how.sign * how.newton * (force_n + 20.0 * random.normal());
  return fmt::format(",{:.10f},{:.6f}", read_m, read_n);
}

Recording recording_of(const Specimen& specimen, const Recorded& how) {
  const auto samples = static_cast<std::size_t>(kDuration_s * how.rate_hz);
  std::string text = how.has_steps ? "step" : "time_s";
  for (std::size_t dof = 0; dof < how.dof + 1; ++dof) {
    const std::string suffix = how.dof == 0 ? "" : fmt::format("_{}", dof + 1);
    text += fmt::format(",measured_displacement_m{0},measured_force_n{0}", suffix);
  }
  text += "\n";
  const std::function<double(double)> force_n = specimen.force_n();
  Random random{11};
  Random other{12};
  for (std::size_t i = 0; i < samples * static_cast<std::size_t>(how.times); ++i) {
    const double time_s = static_cast<double>(i) / how.rate_hz;
    // A whole number of cycles of either sine, so that the test goes on when it is repeated.
    const double place_m =
        0.02 * std::sin(2.0 * std::numbers::pi * time_s) + 0.008 * std::sin(2.0 * std::numbers::pi * 2.5 * time_s);
    text += how.has_steps ? std::to_string(i + 1) : fmt::format("{:.4f}", how.begins_s + how.stretched * time_s);
    for (std::size_t dof = 0; dof < how.dof; ++dof) {
      text += readings(how, place_m, kMadeStiffness_n_per_m * place_m, other);
    }
    text += readings(how, place_m, force_n(place_m), random) + "\n";
  }
  Intake intake = read_csv_recording(text, "made.csv");
  EXPECT_TRUE(intake.recording.has_value()) << intake.findings.front().text("made.csv");
  return intake.recording.value();
}

void expect_cause(const Specimen& specimen, const Recorded& how, const report::RankedCause& cause) {
  EXPECT_EQ(cause.interface, "specimen");
  EXPECT_EQ(cause.effect, specimen.effect);
  for (const Expected& expected : specimen.parameters) {
    const auto found = std::ranges::find(cause.parameters, expected.parameter, &report::ReportedParameter::name);
    ASSERT_NE(found, cause.parameters.end()) << expected.parameter;
    const double value = expected.value * std::pow(how.newton, expected.newtons) * std::pow(how.metre, expected.metres);
    // 20 N of noise on thousands of samples leave less; the corners of friction and of yielding lie between samples.
    EXPECT_NEAR(found->value, value, 0.01 * std::abs(value)) << expected.parameter;
  }
}

class Metamorphic : public testing::TestWithParam<std::tuple<Specimen, Recorded>> {};

TEST_P(Metamorphic, AnswerIsThatOfThePlainTest) {
  const Specimen& specimen = std::get<0>(GetParam());
  const Recorded& how = std::get<1>(GetParam());
  SiteModel model = made_model();
  model.make_law = [&] { return specimen.believed(how); };
  const Recording recording = recording_of(specimen, how);
  DiagnoseSettings settings;
  settings.threads = 2;
  settings.dof = how.dof;
  const report::DiagnosisReport answer = diagnose(model, {&recording, 1}, settings).report;
  EXPECT_EQ(answer.verdict, report::Verdict::named);
  ASSERT_FALSE(answer.ranking.empty());
  const auto cause = std::ranges::find(answer.ranking, specimen.effect, &report::RankedCause::effect);
  ASSERT_NE(cause, answer.ranking.end()) << answer.ranking.front().effect;
  EXPECT_TRUE(cause->is_cause) << answer.ranking.front().effect;
  expect_cause(specimen, how, *cause);
  // Beside an effect that leaves the user's spring as it is, a spring that is wrong is one more.
  const bool has_wrong_spring = how.believed != 1.0 && !specimen.has_own_stiffness;
  EXPECT_EQ(std::ranges::count_if(answer.ranking, &report::RankedCause::is_cause), has_wrong_spring ? 2 : 1);
  EXPECT_EQ(has_wrong_spring, std::ranges::any_of(answer.ranking, [](const report::RankedCause& one) {
              return one.is_cause && one.effect == "stiffness_error";
            }));
  EXPECT_NEAR(answer.interface_shrink->variance_removed, 1.0, 0.01);
}

std::string name_of_case(const testing::TestParamInfo<std::tuple<Specimen, Recorded>>& info) {
  return std::get<0>(info.param).name + std::get<1>(info.param).name;
}

INSTANTIATE_TEST_SUITE_P(Recorded, Metamorphic,
                         testing::Combine(testing::ValuesIn(kSpecimens), testing::ValuesIn(kRecorded)), name_of_case);

// A wrong stiffness beside a wrong strength is a second wrong number, so not for the last specimen.
INSTANTIATE_TEST_SUITE_P(Believed, Metamorphic,
                         testing::Combine(testing::Values(kSpecimens[0], kSpecimens[1]), testing::ValuesIn(kBelieved)),
                         name_of_case);

}  // namespace
}  // namespace hybridtest
