#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "core/random.hpp"
#include "diagnosis/diagnose.hpp"
#include "mechanics/laws/bilinear.hpp"
#include "tests/unit/diagnosis/answers.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

// Effects of the same signature on a recording are a set, whichever of them is the true one.
namespace hybridtest {
namespace {

using report::Verdict;
using testing::IsSupersetOf;
using testing::Not;

constexpr double kStrength_n = 24e3;  // at 12 mm, of 27 mm

std::unique_ptr<Law> spring() { return std::make_unique<Elastic>(kMadeStiffness_n_per_m); }
std::unique_ptr<Law> that_yields() {
  return std::make_unique<Bilinear>(Bilinear::Parameters{kMadeStiffness_n_per_m, kStrength_n, 0.05});
}

enum class Truth { gain, frame, frame_read_late };

/// A drawn site: an actuator with a wrong gain, or on a frame that gives way, and how late it is.
struct Site {
  Truth truth = Truth::gain;
  unsigned draw = 0;
  bool is_late = false;

  friend void PrintTo(const Site& site, std::ostream* out) {
    constexpr const char* kNames[]{"Gain", "Frame", "FrameReadLate"};
    *out << kNames[static_cast<int>(site.truth)] << (site.is_late ? "BesideDelay" : "") << site.draw;
  }
};

Recording recording_of(const Site& site, const std::unique_ptr<Law>& law) {
  Random random{100U + site.draw};
  // 6 to 15 % of the motion, more than numbers that are slightly off; what the drawn noise is to it, no more than a
  // thousandth.
  const double lost = 0.06 + 0.09 * random.uniform();
  const double delay_s = site.is_late ? 0.002 + 0.01 * random.uniform() : 0.0;
  const double noise_m = 1e-6 + 9e-6 * random.uniform();
  const double noise_n = 10.0 + 40.0 * random.uniform();
  const double frequency_hz = 0.5 + random.uniform();
  Recording recording;
  recording.file = "made.csv";
  recording.sample_period_s = kSitePeriod_s;
  recording.samples = 6000;
  recording.dofs.resize(1);
  const double compliance_m_per_n = lost / (1.0 - lost) / kMadeStiffness_n_per_m;
  double force_n = 0.0;
  for (std::size_t i = 0; i < recording.samples; ++i) {
    const auto commanded_m = [&](double time_s) { return made_motion_m(frequency_hz * std::max(0.0, time_s)); };
    const double time_s = kSitePeriod_s * static_cast<double>(i);
    const double sent_m = commanded_m(time_s - delay_s);
    double place_m = (1.0 - lost) * sent_m;
    if (site.truth == Truth::frame_read_late) place_m = sent_m - compliance_m_per_n * force_n;
    if (site.truth == Truth::frame) {
      // Where actuator and specimen are in equilibrium; it converges as the frame is stiffer than the specimen.
      for (int step = 0; step < 40; ++step) {
        place_m = sent_m - compliance_m_per_n * law->trial(place_m, 0.0);
        law->revert();
      }
    }
    force_n = law->trial(place_m, 0.0);
    law->commit();
    recording.dofs[0].of(Channel::command_displacement).push_back(commanded_m(time_s));
    recording.dofs[0].of(Channel::measured_displacement).push_back(place_m + noise_m * random.normal());
    recording.dofs[0].of(Channel::measured_force).push_back(force_n + noise_n * random.normal());
  }
  return recording;
}

report::DiagnosisReport answer_to(const Recording& recording, std::unique_ptr<Law> (*law)()) {
  SiteModel model = made_model();
  model.make_law = law;
  return diagnosis_of(model, recording).report;
}

std::vector<std::string> causes_in(const report::DiagnosisReport& answer) {
  std::vector<std::string> names;
  for (const report::RankedCause& cause : answer.ranking) {
    if (cause.is_cause) names.push_back(std::string{cause.effect});
  }
  return names;
}

/// Effects that cannot be told from another one here.
std::vector<std::string> members_in(const report::DiagnosisReport& report) {
  std::vector<std::string> names;
  for (const report::RankedCause& cause : report.ranking) {
    if (cause.is_indistinguishable) names.push_back(cause.effect);
  }
  return names;
}

class GainOrFrame : public testing::TestWithParam<Site> {};

TEST_P(GainOrFrame, IsASetUnderASpring) {
  const report::DiagnosisReport answer = answer_to(recording_of(GetParam(), spring()), spring);
  // Where the delay has the largest share, it is named, and the set is the smaller cause's.
  const bool is_delay_first = answer.ranking.front().effect == "delay";
  EXPECT_EQ(answer.verdict, is_delay_first ? Verdict::named : Verdict::set);
  EXPECT_THAT(members_in(answer), IsSupersetOf({"gain", "compliance"}));
}

TEST_P(GainOrFrame, IsToldUnderASpecimenThatYields) {
  const report::DiagnosisReport answer = answer_to(recording_of(GetParam(), that_yields()), that_yields);
  const std::vector<std::string> causes = causes_in(answer);
  const bool is_gain = GetParam().truth == Truth::gain;
  EXPECT_THAT(causes, testing::Contains(is_gain ? "gain" : "compliance"));
  EXPECT_THAT(causes, Not(testing::Contains(is_gain ? "compliance" : "gain")));
}

std::vector<Site> drawn_sites() {
  std::vector<Site> sites;
  for (const Truth truth : {Truth::gain, Truth::frame, Truth::frame_read_late}) {
    for (unsigned draw = 0; draw < 4; ++draw) sites.push_back({truth, draw, draw >= 2});
  }
  return sites;
}

/// A specimen whose stiffness and strength are these multiples of the model's, behind a load cell with a gain.
Recording behind_gain(double gain, double stiffness, double strength, unsigned draw) {
  Random random{draw};
  Bilinear law{Bilinear::Parameters{stiffness * kMadeStiffness_n_per_m, strength * kStrength_n, 0.05}};
  Recording recording;
  recording.file = "made.csv";
  recording.sample_period_s = kSitePeriod_s;
  recording.samples = 6000;
  recording.dofs.resize(1);
  for (std::size_t i = 0; i < recording.samples; ++i) {
    const double place_m = made_motion_m(kSitePeriod_s * static_cast<double>(i));
    const double force_n = law.trial(place_m, 0.0);
    law.commit();
    recording.dofs[0].of(Channel::measured_displacement).push_back(place_m + 1e-5 * random.normal());
    recording.dofs[0].of(Channel::measured_force).push_back(gain * force_n + 200.0 * random.normal());
  }
  return recording;
}

class GainOrStrength : public testing::TestWithParam<unsigned> {};

/// The cell reads too little by what the specimen is stiffer: the stiffness seems right and the strength off; and less
/// stiff by as much beside a strength that is less off by as much, the load cell.
TEST_P(GainOrStrength, IsASetWhereTheStiffnessMayBeOffToo) {
  const report::DiagnosisReport answer = answer_to(behind_gain(0.93, 1.0 / 0.965, 1.0, GetParam()), that_yields);
  EXPECT_EQ(answer.verdict, Verdict::set);
  EXPECT_THAT(members_in(answer), IsSupersetOf({"gain", "strength_error"}));
}

/// The cell reads too much and the specimen is a little stiffer besides, or far too little of one that is a little
/// softer: both numbers of the law are off by more than a slight error, or the load cell's gain is, beside a stiffness
/// that is less off.
TEST_P(GainOrStrength, IsASetWhereBothNumbersOfTheLawSeemWrong) {
  const bool is_much = GetParam() % 2 == 0;
  const Recording recording = behind_gain(is_much ? 0.7 : 1.08, is_much ? 0.95 : 1.03, 1.0, GetParam());
  const report::DiagnosisReport answer = answer_to(recording, that_yields);
  EXPECT_EQ(answer.verdict, Verdict::set);
  EXPECT_THAT(members_in(answer), IsSupersetOf({"gain", "strength_error", "stiffness_error"}));
}

/// Control: with a gain for the strength the stiffness would have to be off by a fifth.
TEST_P(GainOrStrength, IsToldWhereTheStiffnessIsOffTheOtherWay) {
  const report::DiagnosisReport answer = answer_to(behind_gain(1.0, 0.88, 1.1, GetParam()), that_yields);
  EXPECT_EQ(answer.verdict, Verdict::named);
  EXPECT_THAT(causes_in(answer), testing::UnorderedElementsAre("stiffness_error", "strength_error"));
}

INSTANTIATE_TEST_SUITE_P(Drawn, GainOrStrength, testing::Range(1U, 5U));

INSTANTIATE_TEST_SUITE_P(Drawn, GainOrFrame, testing::ValuesIn(drawn_sites()), testing::PrintToStringParamName());

}  // namespace
}  // namespace hybridtest
