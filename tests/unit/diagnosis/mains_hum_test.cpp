#include "diagnosis/sanity/mains_hum.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "diagnosis/diagnose.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

namespace hybridtest {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kHum_m = 2e-5;

double hum_m(double time_s, double frequency_hz = 50.0) {
  return kHum_m * std::sin(2.0 * std::numbers::pi * frequency_hz * time_s + 1.0);
}

double spring_n(double displacement_m) { return kMadeStiffness_n_per_m * displacement_m; }

/// Root mean square of what the readings of a displacement have beside the motion of made recordings.
double beside_motion_m(const Recording& recording) {
  const std::vector<double>& readings = recording.dofs[0].of(Channel::measured_displacement);
  double sum = 0.0;
  for (std::size_t i = 0; i < readings.size(); ++i) {
    sum += std::pow(readings[i] - made_motion_m(kSitePeriod_s * static_cast<double>(i)), 2);
  }
  return std::sqrt(sum / static_cast<double>(readings.size()));
}

struct Cleaned {
  explicit Cleaned(const Recording& recording) : Cleaned{std::vector{recording}} {}
  explicit Cleaned(std::vector<Recording> all) : given{std::move(all)} {
    recordings = without_mains_hum(given, 0, copy, notes);
  }
  std::vector<Recording> given;
  std::vector<Recording> copy;
  std::vector<std::string> notes;
  std::span<const Recording> recordings;
};

TEST(MainsHum, IsTakenOffTheReading) {
  // The grid of a laboratory with its own generator is 0.6 % off.
  for (const double frequency_hz : {50.0, 49.9, 60.0, 60.35}) {
    const Recording recording = made_recording([&](double t) { return made_motion_m(t) + hum_m(t, frequency_hz); },
                                               [](double t) { return spring_n(made_motion_m(t)); });
    const Cleaned cleaned{recording};
    // The noise is 1 um, and the frequency is found to a sixteenth of what 12 s resolve: 4 % of the hum.
    EXPECT_LT(beside_motion_m(cleaned.recordings[0]), 1e-6 + 0.04 * kHum_m) << frequency_hz;
    EXPECT_GT(beside_motion_m(recording), 0.7 * kHum_m) << "control: no hum";
    ASSERT_EQ(cleaned.notes.size(), 1U);
    EXPECT_THAT(cleaned.notes[0], HasSubstr("0.02 mm"));
  }
}

TEST(MainsHum, MotionThatTheForceFollowsStays) {
  const auto vibration_m = [](double t) { return made_motion_m(t) + hum_m(t); };
  const Cleaned cleaned{made_recording(vibration_m, [&](double t) { return spring_n(vibration_m(t)); })};
  EXPECT_EQ(cleaned.recordings.data(), cleaned.given.data());
  EXPECT_THAT(cleaned.notes, IsEmpty());
}

TEST(MainsHum, IsTakenOffWhereTheForceHasOneOfItsOwn) {
  const auto with_hum_of_force = [](double hum_n) {
    return made_recording(
        [](double t) { return made_motion_m(t) + hum_m(t); },
        [=](double t) { return spring_n(made_motion_m(t)) + hum_n * std::cos(2.0 * std::numbers::pi * 50.0 * t); });
  };
  const double as_of_spring_n = 0.8 * spring_n(kHum_m);
  const Cleaned both{std::vector{with_hum_of_force(as_of_spring_n), with_hum_of_force(0.0)}};
  ASSERT_EQ(both.notes.size(), 2U);
  EXPECT_THAT(both.notes[0], HasSubstr("In another recording the force does not follow it."));
  EXPECT_LT(beside_motion_m(both.recordings[0]), 1e-6 + 0.04 * kHum_m);
  EXPECT_THAT(Cleaned{with_hum_of_force(as_of_spring_n)}.notes, IsEmpty()) << "control: it alone";
}

TEST(MainsHum, IsSeenInNoiseAsOftenAsAsked) {
  int seen = 0;
  constexpr int kDraws = 200;
  for (std::uint64_t seed = 1; seed <= kDraws; ++seed) {
    const Cleaned cleaned{made_recording(
        &made_motion_m, [](double t) { return spring_n(made_motion_m(t)); }, 20.0, seed)};
    seen += cleaned.notes.empty() ? 0 : 1;
  }
  // 10 of 200 are asked, on a grid that is finer than what is independent; 22 is the 99.9 % point of a binomial.
  EXPECT_LE(seen, 22);
}

TEST(MainsHum, StepsOfACoarseConverterAreNotLost) {
  Recording recording = made_recording([](double t) { return made_motion_m(t) + hum_m(t); },
                                       [](double t) { return spring_n(made_motion_m(t)); });
  for (double& reading : recording.dofs[0].of(Channel::measured_displacement)) {
    reading = 5e-5 * std::round(reading / 5e-5);
  }
  EXPECT_THAT(Cleaned{recording}.notes, IsEmpty());
}

TEST(MainsHum, IsNotAskedOfRecordingsOverWhichTheMainsWander) {
  const auto notes_after = [](double duration_s) {
    Recording recording = made_recording(&made_motion_m, [](double t) { return spring_n(made_motion_m(t)); });
    recording.samples = static_cast<std::size_t>(std::lround(duration_s / kSitePeriod_s));
    for (const Channel channel : {Channel::measured_displacement, Channel::measured_force}) {
      std::vector<double>& samples = recording.dofs[0].of(channel);
      samples.resize(recording.samples);
      for (std::size_t i = 0; i < samples.size(); ++i) {
        const double t = kSitePeriod_s * static_cast<double>(i);
        const bool is_force = channel == Channel::measured_force;
        samples[i] = is_force ? spring_n(made_motion_m(t)) : made_motion_m(t) + hum_m(t);
      }
    }
    return Cleaned{recording}.notes.size();
  };
  EXPECT_EQ(notes_after(108.0), 1U);
  EXPECT_EQ(notes_after(132.0), 0U);
}

TEST(MainsHum, IsNotAskedWithoutTimeOrForce) {
  Recording recording = made_recording([](double t) { return made_motion_m(t) + hum_m(t); },
                                       [](double t) { return spring_n(made_motion_m(t)); });
  EXPECT_EQ(Cleaned{recording}.notes.size(), 1U) << "control";
  Recording slow = recording;
  slow.is_quasi_static = true;
  EXPECT_THAT(Cleaned{slow}.notes, IsEmpty());
  recording.dofs[0].of(Channel::measured_force).clear();
  EXPECT_THAT(Cleaned{recording}.notes, IsEmpty());
}

// Of a planned motion whose command was not recorded, a damper of the specimen and a lag of the transducer look alike
// but for what they make of the hum: a lag whose second order cancels 50 Hz left less than the damper.
TEST(MainsHum, DoesNotDecideBetweenCauses) {
  constexpr double kDamping = 1.3e4;
  Recording recording =
      made_recording([](double t) { return made_motion_m(t) + hum_m(t); },
                     [&](double t) { return spring_n(made_motion_m(t)) + kDamping * made_velocity_m_per_s(t); });
  recording.dofs[0].of(Channel::command_displacement).clear();
  const Diagnosis diagnosis = diagnose(made_model(), std::vector{recording}, {});
  const report::RankedCause& first = diagnosis.report.ranking.at(0);
  EXPECT_EQ(first.effect, "viscous_damping");
  EXPECT_NEAR(first.parameters.at(0).value, kDamping, 0.01 * kDamping);
  EXPECT_THAT(diagnosis.report.notes, testing::Contains(HasSubstr("hum of the mains")));
}

}  // namespace
}  // namespace hybridtest
