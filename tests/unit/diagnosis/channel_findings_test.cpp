#include "diagnosis/sanity/channel_findings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "core/random.hpp"
#include "diagnosis/diagnose.hpp"
#include "diagnosis/page/diagnosis_json.hpp"
#include "diagnosis/page/wording.hpp"
#include "mechanics/laws/bilinear.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

namespace hybridtest {
namespace {

using report::Verdict;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

double spring_n(double time_s) { return kMadeStiffness_n_per_m * made_motion_m(time_s); }
double acceleration_m_per_s2(double t) {
  return (made_velocity_m_per_s(t + 1e-3) - made_velocity_m_per_s(t - 1e-3)) / 2e-3;
}

/// A force that has nothing to do with the motion.
double other_n(double t) {
  return 2e4 * std::sin(11.0 * t + 3.0 * std::sin(1.7 * t)) + 1e4 * std::sin(4.3 * t * t / 12.0);
}

std::vector<std::string> found_in(const Recording& recording, const SiteModel& model = made_model()) {
  std::vector<std::string> texts;
  for (const ChannelFinding& finding : check_channels(model, {&recording, 1}, 0)) {
    texts.push_back((finding.is_unusable ? "! " : "  ") + finding.said.interface + ": " + finding.said.what);
  }
  return texts;
}

std::vector<std::string> found_with(const std::function<double(double)>& force_n) {
  return found_in(made_recording(made_motion_m, force_n));
}

/// The diagnosis must not name anything at the specimen or its load cell.
void expect_not_judged(const Recording& recording, const std::string& why) {
  const Diagnosis diagnosis = diagnose(made_model(), {&recording, 1}, {});
  EXPECT_TRUE(diagnosis.causes.empty()) << diagnosis.causes.front().type->name;
  EXPECT_EQ(diagnosis.report.verdict, Verdict::not_excited) << "the actuator agrees, of the specimen nothing is known";
  EXPECT_FALSE(diagnosis.report.next_experiment.empty());
  const std::string json = diagnosis_json(diagnosis);
  const std::string expected = "\"specimen\": \"measured_force_n " + why;
  EXPECT_NE(json.find(expected), std::string::npos) << expected;
  EXPECT_NE(json.find("\"what_to_do\""), std::string::npos);
  EXPECT_THAT(diagnosis.report.notes, testing::Contains(HasSubstr(why)));
}

TEST(ChannelFindings, DeadForceIsNotJudged) {
  EXPECT_THAT(found_in(made_recording(
                  made_motion_m, [](double) { return 120.0; }, 0.0)),
              ElementsAre(HasSubstr("! specimen: measured_force_n never changes")));
  const Recording noise = made_recording(made_motion_m, [](double) { return 0.0; });
  EXPECT_THAT(found_in(noise), ElementsAre(HasSubstr("! specimen: measured_force_n is nothing but noise of 20")));
  expect_not_judged(noise, "is nothing but noise");
}

/// The plug of the load cell comes off after two thirds of the test; its amplifier has hum besides.
TEST(ChannelFindings, ForceThatDiesIsNotJudged) {
  const auto comes_off = [](double until_s, double left_n) {
    return made_recording(made_motion_m, [=](double t) {
      return t < until_s ? spring_n(t) : 10.0 * std::sin(2.0 * std::numbers::pi * 50.0 * t) + left_n * spring_n(t);
    });
  };
  EXPECT_THAT(found_in(comes_off(8.0, 0.0)),
              ElementsAre(HasSubstr("! specimen: measured_force_n is nothing but noise of 19.2")));
  expect_not_judged(comes_off(8.0, 0.0), "is nothing but noise of 19.2");
  const Recording dies = comes_off(8.0, 0.0);
  const std::string sentence = report::verdict_sentence(diagnose(made_model(), {&dies, 1}, {}).report);
  EXPECT_THAT(sentence, HasSubstr("not sufficient to check the model: measured_force_n is nothing but noise"));
  EXPECT_THAT(sentence, HasSubstr("(8.10\u00a0s) on"));
  EXPECT_THAT(found_in(comes_off(8.0, 0.05)), IsEmpty()) << "control: a twentieth of the specimen is left";
  EXPECT_THAT(found_in(comes_off(11.9, 0.0)), IsEmpty()) << "control: the motion does not go to and fro after that";
}

/// As a load cell whose range is far below the force, which is fast: at every sample at one end or the other.
TEST(ChannelFindings, ForceThatIsCutOffIsNoNoise) {
  Random random{7};
  const Recording recording = made_recording(
      made_motion_m, [&](double) { return random.uniform(-1.0, 1.0) < 0.0 ? -500.0 : 500.0; }, 0.0);
  EXPECT_THAT(found_in(recording), ElementsAre(HasSubstr("stands at -500\u00a0N or 500\u00a0N for the most part")));
  expect_not_judged(recording, "stands at");
}

/// The spring reads 56 kN at most.
TEST(ChannelFindings, WildReadingsAreSaid) {
  Recording recording = made_recording(made_motion_m, spring_n);
  std::vector<double>& force_n = recording.dofs[0].of(Channel::measured_force);
  const double most_n = std::ranges::max(force_n);
  force_n[2000] = -7e6;
  EXPECT_THAT(found_in(recording), ElementsAre(HasSubstr("! force_sensor: measured_force_n has a reading of "
                                                         "-7e+06 N")));
  expect_not_judged(recording, "has a reading of -7e+06 N");
  for (const std::size_t at : {2000U, 2001U, 4500U}) force_n[at] = 80.0 * most_n;
  EXPECT_THAT(found_in(recording), ElementsAre(HasSubstr("! force_sensor: measured_force_n has 3 readings of up to")));
  // A transducer has them, too, with nothing recorded in front of it.
  recording = made_recording(made_motion_m, spring_n);
  recording.dofs[0].of(Channel::command_displacement).clear();
  recording.dofs[0].of(Channel::measured_displacement)[100] = -9999.0;
  EXPECT_THAT(found_in(recording), ElementsAre(HasSubstr("! displacement_sensor: measured_displacement_m has a "
                                                         "reading of -9999 m")));
}

/// A cable with a bad contact: for some samples the reading is zero, as often as it likes.
TEST(ChannelFindings, DropoutsAreSaid) {
  for (const Channel channel : {Channel::measured_force, Channel::measured_displacement}) {
    Recording recording = made_recording(made_motion_m, spring_n);
    std::vector<double>& values = recording.dofs[0].of(channel);
    std::size_t lost = 0;
    std::size_t places = 0;
    for (std::size_t at = 500; at + 10 < values.size(); at += 701) {
      if (std::abs(values[at]) < 0.3 * std::ranges::max(values)) continue;
      std::fill_n(values.begin() + static_cast<std::ptrdiff_t>(at), 5, 0.0);
      lost += 5;
      ++places;
    }
    ASSERT_GE(places, 2U);
    EXPECT_THAT(found_in(recording), ElementsAre(HasSubstr(" in " + std::to_string(places) + " places, " +
                                                           std::to_string(lost) + " samples in all")));
  }
}

/// A force of exactly zero is no dropout where the specimen has a gap, nor where one place alone is lost.
TEST(ChannelFindings, ForceOfZeroIsNoDropout) {
  const auto gap_n = [](double t) {
    const double beyond_m = std::max(0.0, std::abs(made_motion_m(t)) - 0.004);
    return kMadeStiffness_n_per_m * std::copysign(beyond_m, made_motion_m(t));
  };
  EXPECT_THAT(found_in(made_recording(made_motion_m, gap_n, 0.0)), IsEmpty());
  Recording recording = made_recording(made_motion_m, spring_n);
  std::vector<double>& force_n = recording.dofs[0].of(Channel::measured_force);
  std::fill_n(std::ranges::max_element(force_n), 4, 0.0);
  EXPECT_THAT(found_in(recording), IsEmpty());
}

/// As large and longer is a blow; and a reading is not wild that holds little of the energy.
TEST(ChannelFindings, BlowsAreNotWild) {
  Recording recording = made_recording(made_motion_m, spring_n);
  std::vector<double>& force_n = recording.dofs[0].of(Channel::measured_force);
  const double most_n = std::ranges::max(force_n);
  for (const std::size_t at : {2000U, 2001U, 2002U, 2003U}) force_n[at] = 80.0 * most_n;
  EXPECT_THAT(found_in(recording), testing::Not(testing::Contains(HasSubstr("times as far out"))));
  std::fill_n(force_n.begin() + 2000, 4, 0.0);
  force_n[2000] = 4.0 * most_n;
  EXPECT_THAT(found_in(recording), IsEmpty());
}

/// A blow in a force that otherwise follows nothing: it stands at no limit.
TEST(ChannelFindings, BlowIsNoLimit) {
  Recording recording = made_recording(
      made_motion_m, [](double t) { return 1e-2 * other_n(t); }, 1.0);
  std::vector<double>& force_n = recording.dofs[0].of(Channel::measured_force);
  for (std::size_t i = 0; i < 30; ++i) force_n[3000 + i] = 7e4 * std::sin(0.21 * static_cast<double>(i));
  EXPECT_THAT(found_in(recording), ElementsAre(HasSubstr("has nothing to do with measured_displacement_m")));
}

TEST(ChannelFindings, FrozenForceIsNotJudged) {
  Recording recording = made_recording(made_motion_m, spring_n);
  std::vector<double>& force_n = recording.dofs[0].of(Channel::measured_force);
  std::fill(force_n.begin() + 2000, force_n.begin() + 4000, force_n[2000]);
  EXPECT_THAT(found_in(recording), ElementsAre(HasSubstr("stands still at")));
  // A gap holds the force at nothing while the motion stays inside; so does rest.
  EXPECT_THAT(found_in(made_recording(
                  made_motion_m,
                  [](double t) { return std::max(0.0, spring_n(t) - 2e4) + std::min(0.0, spring_n(t) + 2e4); }, 0.0)),
              IsEmpty());
}

TEST(ChannelFindings, UnrelatedForceIsNotJudged) {
  EXPECT_THAT(found_with(other_n), ElementsAre(HasSubstr("! specimen: measured_force_n has nothing to do with")));
  expect_not_judged(made_recording(made_motion_m, other_n), "has nothing to do with");
}

TEST(ChannelFindings, ForceOfAnotherTimeIsNotJudged) {
  // Two sines repeat; a chirp does not.
  const auto chirp_m = [](double t) { return 0.02 * std::sin(2.0 * t + 0.6 * t * t); };
  Recording recording =
      made_recording(chirp_m, [&](double t) { return t < 0.8 ? 0.0 : kMadeStiffness_n_per_m * chirp_m(t - 0.8); });
  recording.dofs[0].of(Channel::command_displacement).clear();
  EXPECT_THAT(found_in(recording), ElementsAre(HasSubstr("follows measured_displacement_m 0.8 s too late")));
}

TEST(ChannelFindings, ReversedSignsAreSaid) {
  const Recording reversed = made_recording(made_motion_m, [](double t) { return -spring_n(t); });
  EXPECT_THAT(found_in(reversed), ElementsAre(HasSubstr("! specimen: measured_force_n has the wrong sign")));
  expect_not_judged(reversed, "has the wrong sign");
  EXPECT_THAT(found_with([](double t) { return -0.3 * spring_n(t); }), ElementsAre(HasSubstr("wrong sign")));
  EXPECT_THAT(found_with([](double t) { return made_velocity_m_per_s(t) > 0.0 ? -1e4 : 1e4; }),
              ElementsAre(HasSubstr("the force drives the motion")));
  EXPECT_THAT(found_in(made_recording([](double t) { return -made_motion_m(t); }, spring_n)),
              ElementsAre(HasSubstr("! transfer_system: measured_displacement_m has the wrong sign: it runs against "
                                    "command_displacement_m")));
}

TEST(ChannelFindings, ForcesOfEverySpecimenPass) {
  Bilinear law{{.stiffness_n_per_m = kMadeStiffness_n_per_m, .yield_force_n = 1e4, .hardening_ratio = 0.02}};
  EXPECT_THAT(found_with(spring_n), IsEmpty());
  EXPECT_THAT(found_with([](double t) { return 0.1 * spring_n(t); }), IsEmpty());
  EXPECT_THAT(found_with([](double t) { return 5e4 * made_velocity_m_per_s(t); }), IsEmpty());
  EXPECT_THAT(found_with([](double t) { return made_velocity_m_per_s(t) > 0.0 ? 1e4 : -1e4; }), IsEmpty());
  EXPECT_THAT(found_with([](double t) { return spring_n(t) + 3e4 * acceleration_m_per_s2(t); }), IsEmpty());
  EXPECT_THAT(found_with([](double t) { return 3e4 * acceleration_m_per_s2(t); }), IsEmpty())
      << "a mass without spring";
  EXPECT_THAT(found_with([](double t) { return spring_n(t - 0.03); }), IsEmpty());
  EXPECT_THAT(found_with([](double t) { return spring_n(t) + 2e4 * t; }), IsEmpty()) << "drift";
  EXPECT_THAT(found_with([&](double t) {
                const double force_n = law.trial(made_motion_m(t), 0.0);
                law.commit();
                return force_n;
              }),
              IsEmpty());
}

TEST(ChannelFindings, TwoRecordingsKeepTheUsableOne) {
  const std::vector<Recording> recordings{made_recording(made_motion_m, spring_n),
                                          made_recording(made_motion_m, other_n)};
  const std::vector<ChannelFinding> findings = check_channels(made_model(), recordings, 0);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].recording, 1U);
  std::vector<Recording> copy;
  const std::span<const Recording> usable = usable_part(recordings, 0, findings, copy);
  EXPECT_TRUE(usable[0].dofs[0].has(Channel::measured_force));
  EXPECT_FALSE(usable[1].dofs[0].has(Channel::measured_force));
}

/// Force and displacement of a site with a resonance, `samples` per cycle of it.
Recording resonance(double samples) {
  Recording recording = made_recording(made_motion_m, spring_n);
  DofRecording& dof = recording.dofs[0];
  for (std::size_t i = 0; i < recording.samples; ++i) {
    const double ring = std::sin(2.0 * std::numbers::pi * static_cast<double>(i) / samples);
    dof.of(Channel::measured_displacement)[i] += 5e-5 * ring;
    dof.of(Channel::measured_force)[i] += 2e4 * ring;
  }
  return recording;
}

TEST(ChannelFindings, SlowSamplingIsSaidWhereItMatters) {
  SiteModel with_mass = made_model();
  with_mass.effects.push_back({find_effect(EffectInterface::specimen, "inertia"), {10.0}});
  EXPECT_THAT(found_in(resonance(9.0), with_mass),
              ElementsAre(HasSubstr("  specimen: measured_force_n is sampled too slowly")));
  EXPECT_THAT(found_in(resonance(9.0)), IsEmpty()) << "no derivatives needed";
  EXPECT_THAT(found_in(resonance(30.0), with_mass), IsEmpty());
  EXPECT_THAT(found_in(resonance(3.0)), ElementsAre(HasSubstr("sampled too slowly")));
}

/// Of a model that is a spring, the causes that were found tell whether it matters.
TEST(ChannelFindings, SlowSamplingIsSaidWhereACauseNeedsDerivatives) {
  const EffectSetting mass{find_effect(EffectInterface::specimen, "inertia"), {10.0}};
  const EffectSetting friction{find_effect(EffectInterface::specimen, "coulomb_friction"), {10.0, 0.0, 1e-5, 0.0}};
  const auto said_of = [](const SiteModel& model, const EffectSetting& cause, double samples_per_cycle) {
    const std::vector<Recording> recordings{resonance(samples_per_cycle)};
    std::vector<std::string> said;
    for (const ChannelFinding& finding : check_sampling(model, {&cause, 1}, recordings, 0)) {
      EXPECT_FALSE(finding.is_unusable);
      said.push_back(finding.said.what);
    }
    return said;
  };
  EXPECT_THAT(said_of(made_model(), mass, 9.0),
              ElementsAre(testing::AllOf(HasSubstr("measured_force_n is sampled too slowly"),
                                         HasSubstr("the causes need derivatives"))));
  EXPECT_THAT(said_of(made_model(), friction, 9.0), IsEmpty());
  EXPECT_THAT(said_of(made_model(), mass, 30.0), IsEmpty());
  SiteModel with_mass = made_model();
  with_mass.effects.push_back(mass);
  EXPECT_THAT(said_of(with_mass, mass, 9.0), IsEmpty()) << "said before any fit";
}

TEST(ChannelFindings, SkewWithinASampleIsSaid) {
  EXPECT_THAT(found_with([](double t) { return spring_n(t - 0.4 * kSitePeriod_s); }),
              ElementsAre(HasSubstr("less than a sample")));
}

}  // namespace
}  // namespace hybridtest
