#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/random.hpp"
#include "diagnosis/traces/traces.hpp"
#include "diagnosis/verdict/causes.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"
#include "tests/unit/diagnosis/made_signals.hpp"

/// Effects that show in the digits of a recording.
namespace hybridtest {
namespace {

constexpr double kPeriod_s = 0.001;
constexpr std::size_t kSamples = 12000;

std::vector<double> motion_m() {
  std::vector<double> values;
  for (std::size_t i = 0; i < kSamples; ++i) values.push_back(made_motion_m(kPeriod_s * static_cast<double>(i)));
  return values;
}

std::vector<double> with_noise(std::vector<double> values, double deviation, std::uint64_t seed = 7) {
  Random random{seed};
  for (double& value : values) value += deviation * random.normal();
  return values;
}

double span_of(const std::vector<double>& values) {
  const auto [low, high] = std::ranges::minmax_element(values);
  return *high - *low;
}

TEST(ReadingSteps, FoundWithNoiseBeforeOrAfterConverter) {
  const double step = span_of(motion_m()) / 73.4;
  for (const double noise : {0.0, 0.02, 0.1}) {
    const ReadingSteps behind = steps_of_readings(with_noise(in_steps(motion_m(), step), noise * step));
    // A hundredth of a step over the whole span.
    EXPECT_NEAR(behind.step, step, 0.01 * step / 73.4) << noise;
    // The characteristic function of the noise at 1 / q; 5 standard deviations of a mean over the samples.
    EXPECT_NEAR(behind.coherence, std::exp(-2.0 * std::pow(std::numbers::pi * noise, 2)), 5.0 / std::sqrt(kSamples))
        << noise;
  }
  EXPECT_NEAR(steps_of_readings(in_steps(with_noise(motion_m(), 0.3 * step), step)).step, step, 0.01 * step / 73.4);
}

TEST(ReadingSteps, FoundDespiteConverterOffset) {
  const double step = span_of(motion_m()) / 40.0;
  std::vector<double> values = in_steps(motion_m(), step);
  for (double& value : values) value += 0.37 * step;
  EXPECT_NEAR(steps_of_readings(values).step, step, 0.01 * step / 40.0);
}

TEST(ReadingSteps, FoundThoughOnlyAFewAreInTheSpan) {
  for (const double steps : {4.1, 5.3}) {
    const double step = span_of(motion_m()) / steps;
    const std::vector<double> values = with_noise(in_steps(motion_m(), step), 0.01 * step);
    // Five standard deviations of the noise over the span of the levels.
    EXPECT_NEAR(steps_of_readings(values).step, step, 0.05 * step / std::floor(steps)) << steps;
  }
}

TEST(ReadingSteps, NotFoundInSmoothSignal) {
  const double span = span_of(motion_m());
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    EXPECT_EQ(steps_of_readings(with_noise(motion_m(), 1e-4 * span, seed)).step, 0.0) << seed;
  }
  EXPECT_EQ(steps_of_readings(motion_m()).step, 0.0);
  // Half of it at rest, where every value is the same; and cycles that turn at the same place.
  std::vector<double> resting = motion_m();
  for (std::size_t i = kSamples / 2; i < kSamples; ++i) resting[i] = resting[kSamples / 2];
  EXPECT_EQ(steps_of_readings(with_noise(resting, 1e-4 * span)).step, 0.0);
  std::vector<double> cycles;
  for (std::size_t i = 0; i < kSamples; ++i) cycles.push_back(std::sin(0.0063 * static_cast<double>(i)));
  EXPECT_EQ(steps_of_readings(with_noise(cycles, 1e-4)).step, 0.0);
  EXPECT_EQ(steps_of_readings(std::vector<double>(kSamples, 0.25)).step, 0.0);
}

TEST(ReadingSteps, NotFoundInAFewSpikes) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random{seed};
    std::vector<double> spikes(kSamples, 0.0);
    for (int i = 0; i < 12; ++i) spikes[random.below(kSamples)] = 1.0 + random.uniform();
    EXPECT_EQ(steps_of_readings(with_noise(spikes, 1e-4, seed)).step, 0.0) << seed;
  }
}

/// A motion that sticks and jumps between places a whole step apart, and at last comes to rest between two of them:
/// what it passes on its way is all at multiples of the step, and where it is half of the time is not.
TEST(ReadingSteps, NotFoundInMotionThatSticksAndJumps) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random{seed};
    std::vector<double> values;
    double place = 0.0;
    while (values.size() < kSamples / 2) {
      place = random.uniform() < 0.5 ? std::min(place + 1.0, 4.0) : std::max(place - 1.0, -4.0);
      values.insert(values.end(), 100, place);
    }
    values.resize(kSamples, place + 0.4);
    EXPECT_EQ(steps_of_readings(with_noise(values, 1e-3, seed)).step, 0.0) << seed;
  }
}

TEST(ReadingSteps, NotFoundWhenHiddenByNoise) {
  const double step = span_of(motion_m()) / 50.0;
  EXPECT_EQ(steps_of_readings(with_noise(in_steps(motion_m(), step), 0.3 * step)).step, 0.0);
}

std::vector<double> received(std::span<const int> lags) {
  const std::vector<double> sent = motion_m();
  std::vector<double> values(sent.size());
  for (std::size_t i = 0; i < sent.size(); ++i) {
    const auto lag = std::min(i, static_cast<std::size_t>(lags[i]));
    values[i] = sent[i - lag];
  }
  return values;
}

/// The newest message that has come, of messages that are late by `latency` and up to `jitter` more, evenly spread [all
/// in samples].
std::vector<int> ages(double jitter, int latency, std::uint64_t seed) {
  Random random{seed};
  std::vector<double> lateness(kSamples);
  for (double& late : lateness) late = latency + jitter * random.uniform();
  std::vector<int> newest(kSamples);
  for (std::size_t i = 0; i < kSamples; ++i) {
    std::size_t age = 0;
    while (age < i && lateness[i - age] > static_cast<double>(age)) ++age;
    newest[i] = static_cast<int>(age);
  }
  return newest;
}

/// Loses a share of the messages, independently of each other: the one before is played again. How many are lost.
std::size_t lose(std::vector<int>& lags, double share, std::uint64_t seed) {
  Random random{seed};
  std::size_t lost = 0;
  for (std::size_t i = 1; i < lags.size(); ++i) {
    if (random.uniform() >= share) continue;
    lags[i] = lags[i - 1] + 1;
    ++lost;
  }
  return lost;
}

TEST(NetworkTrace, SeparatesLossJitterAndDelay) {
  std::vector<int> lost(kSamples, 4);
  const std::size_t held = lose(lost, 0.05, 3);
  const std::vector<Trace> loss = traces_of_network(motion_m(), received(lost), kPeriod_s);
  ASSERT_EQ(loss.size(), 2U);
  EXPECT_EQ(loss[0].effect.type->name, "loss");
  // Those that repeat the one before, and the first four, before anything has arrived.
  EXPECT_NEAR(loss[0].effect.values[0], static_cast<double>(held + 4) / kSamples, 1.0 / kSamples);
  EXPECT_EQ(loss[1].effect.type->name, "latency");
  EXPECT_DOUBLE_EQ(loss[1].effect.values[0], 4.0 * kPeriod_s);

  const std::vector<int> late(kSamples, 5);
  EXPECT_TRUE(traces_of_network(motion_m(), received(late), kPeriod_s).empty());
  EXPECT_TRUE(traces_of_network(motion_m(), with_noise(motion_m(), 1e-6), kPeriod_s).empty()) << "not what was sent";
}

TEST(NetworkTrace, JitterAndTheLatencyBesideItAreToldApart) {
  constexpr int kDraws = 20;
  for (const double jitter : {1.4, 2.5, 6.0, 20.0}) {
    for (const int latency : {0, 3}) {
      double sum = 0.0;
      double shares = 0.0;
      for (std::uint64_t seed = 1; seed <= kDraws; ++seed) {
        const std::vector<Trace> traces =
            traces_of_network(motion_m(), received(ages(jitter, latency, seed)), kPeriod_s);
        ASSERT_EQ(traces.size(), latency == 0 ? 1U : 2U) << jitter << ' ' << latency << ' ' << seed;
        EXPECT_EQ(traces[0].effect.type->name, "jitter");
        sum += traces[0].effect.values[0];
        shares += traces[0].gap_share;
        if (latency == 0) continue;
        EXPECT_EQ(traces[1].effect.type->name, "latency");
        EXPECT_DOUBLE_EQ(traces[1].effect.values[0], latency * kPeriod_s);
        EXPECT_GT(traces[1].gap_share, 0.0);
      }
      // Ages that follow each other are alike: of some hundred that are not, the mean is known to 1 % and the jitter,
      // as its square, to 2 %; of 20 draws to a quarter of that.
      EXPECT_NEAR(sum / kDraws, jitter * kPeriod_s, 0.01 * jitter * kPeriod_s) << jitter << ' ' << latency;
      EXPECT_GT(shares, 0.0);
    }
  }
}

/// A clock that is slow plays each target at the next whole sample.
std::vector<int> drifting(double drift_ratio, int latency) {
  std::vector<int> lags(kSamples);
  for (std::size_t i = 0; i < kSamples; ++i) {
    lags[i] = latency + static_cast<int>(std::ceil(drift_ratio * static_cast<double>(i)));
  }
  return lags;
}

TEST(NetworkTrace, ClockThatDriftsIsToldByTheInstantsAtWhichTargetsComeLater) {
  for (const double drift_ratio : {3e-4, 5e-4, 3e-3}) {
    for (const int latency : {0, 4}) {
      const std::vector<Trace> traces =
          traces_of_network(motion_m(), received(drifting(drift_ratio, latency)), kPeriod_s);
      ASSERT_EQ(traces.size(), latency == 0 ? 1U : 2U) << drift_ratio << ' ' << latency;
      EXPECT_EQ(traces.back().effect.type->name, "clock_drift");
      // Each instant is known to a sample: of the time between the first and the last of them, two samples at most.
      const double steps = std::floor(drift_ratio * kSamples) - 1.0;
      EXPECT_NEAR(traces.back().effect.values[0], drift_ratio, drift_ratio * drift_ratio * 2.0 / steps);
      EXPECT_GT(traces.back().gap_share, 0.0);
      EXPECT_EQ(traces.back().probability, 1.0);
      if (latency == 0) continue;
      EXPECT_EQ(traces.front().effect.type->name, "latency");
      EXPECT_DOUBLE_EQ(traces.front().effect.values[0], latency * kPeriod_s);
    }
  }
}

/// A clock that is ahead by nearly a sample at the start: the first thousand targets are not late at all.
TEST(NetworkTrace, ClockThatDriftsMayBeAheadAtTheStart) {
  std::vector<int> ahead(kSamples);
  for (std::size_t i = 0; i < kSamples; ++i) ahead[i] = static_cast<int>(i / 1000);
  const std::vector<Trace> traces = traces_of_network(motion_m(), received(ahead), kPeriod_s);
  ASSERT_EQ(traces.size(), 1U);
  EXPECT_EQ(traces[0].effect.type->name, "clock_drift");
  EXPECT_NEAR(traces[0].effect.values[0], 1e-3, 1e-6 * 2.0 / 10.0);
}

/// A quartz that warms and cools.
TEST(NetworkTrace, ClockWhoseRateWandersByATenthDrifts) {
  constexpr double kDriftRatio = 1e-3;
  std::vector<int> lags(kSamples);
  double late = 0.0;
  for (std::size_t i = 0; i < kSamples; ++i) {
    lags[i] = static_cast<int>(std::ceil(late));
    late += kDriftRatio * (1.0 + 0.1 * std::sin(2e-3 * static_cast<double>(i)));
  }
  const std::vector<Trace> traces = traces_of_network(motion_m(), received(lags), kPeriod_s);
  ASSERT_EQ(traces.size(), 1U);
  EXPECT_EQ(traces[0].effect.type->name, "clock_drift");
  // The line through instants that come and go by 0.1 / 2e-3 samples: as much over half of all of them.
  EXPECT_NEAR(traces[0].effect.values[0], kDriftRatio, kDriftRatio * 50.0 / (0.5 * kSamples));
}

/// Two longer ways, one after the other, are no straight line; nor is one that is longer once.
TEST(NetworkTrace, LongerWaysAreNoClockThatDrifts) {
  std::vector<int> lags(kSamples, 1);
  std::fill(lags.begin() + kSamples / 2, lags.end(), 2);
  EXPECT_TRUE(traces_of_network(motion_m(), received(lags), kPeriod_s).empty());
  std::fill(lags.begin() + kSamples * 6 / 10, lags.end(), 3);
  EXPECT_TRUE(traces_of_network(motion_m(), received(lags), kPeriod_s).empty());
}

TEST(NetworkTrace, LossAndAClockThatDriftsAreToldTogether) {
  for (const double drift_ratio : {2e-4, 5e-4, 3e-3}) {
    for (const int latency : {0, 4}) {
      for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        std::vector<int> lags = drifting(drift_ratio, latency);
        const auto lost = static_cast<double>(lose(lags, 0.05, seed));
        const std::vector<Trace> traces = traces_of_network(motion_m(), received(lags), kPeriod_s);
        ASSERT_EQ(traces.size(), latency == 0 ? 2U : 3U) << drift_ratio << ' ' << latency << ' ' << seed;
        EXPECT_EQ(traces.front().effect.type->name, "loss");
        // Where the drift makes them a sample later, a target is repeated, too; next to one that is lost it is not,
        // which a tenth of them are.
        const double repeated = drift_ratio * kSamples;
        EXPECT_NEAR(traces.front().effect.values[0], lost / kSamples, (5.0 + latency + 0.25 * repeated) / kSamples);
        EXPECT_EQ(traces.back().effect.type->name, "clock_drift");
        // The line through whole samples: a half of one at most at either end.
        EXPECT_NEAR(traces.back().effect.values[0], drift_ratio, 1.0 / kSamples) << latency << ' ' << seed;
        EXPECT_GT(traces.back().gap_share, 0.0);
        if (latency == 0) continue;
        EXPECT_EQ(traces[1].effect.type->name, "latency");
        EXPECT_DOUBLE_EQ(traces[1].effect.values[0], latency * kPeriod_s);
      }
    }
  }
}

/// From the middle on they take another way, which is three samples longer.
TEST(NetworkTrace, LossAndAnotherWayAreNoClockThatDrifts) {
  std::vector<int> lags(kSamples, 1);
  std::fill(lags.begin() + kSamples / 2, lags.end(), 4);
  lose(lags, 0.02, 3);
  const std::vector<Trace> traces = traces_of_network(motion_m(), received(lags), kPeriod_s);
  ASSERT_FALSE(traces.empty());
  EXPECT_EQ(traces.front().effect.type->name, "loss");
  EXPECT_TRUE(std::ranges::none_of(traces, [](const Trace& t) { return t.effect.type->name == "clock_drift"; }));
}

TEST(NetworkTrace, JitterAndAClockThatDriftsAreToldTogether) {
  constexpr int kDraws = 20;
  constexpr double kDriftRatio = 3e-3;
  const std::vector<int> late = drifting(kDriftRatio, 0);
  double sum = 0.0;
  for (std::uint64_t seed = 1; seed <= kDraws; ++seed) {
    std::vector<int> lags = ages(6.0, 0, seed);
    for (std::size_t i = 0; i < kSamples; ++i) lags[i] += late[i];
    const std::vector<Trace> traces = traces_of_network(motion_m(), received(lags), kPeriod_s);
    ASSERT_EQ(traces.size(), 2U) << seed;
    EXPECT_EQ(traces[0].effect.type->name, "jitter");
    EXPECT_EQ(traces[1].effect.type->name, "clock_drift");
    EXPECT_NEAR(traces[1].effect.values[0], kDriftRatio, 1.0 / kSamples) << seed;
    sum += traces[0].effect.values[0];
  }
  // As without a drift: 2 % in a draw.
  EXPECT_NEAR(sum / kDraws, 6.0 * kPeriod_s, 0.01 * 6.0 * kPeriod_s);
}

/// Each lag is rarer than a chance hit, so that none is known to be the shortest.
TEST(NetworkTrace, LagsThatHardlyRepeatAreAJitterWithoutLatency) {
  std::vector<int> lags(kSamples);
  for (std::size_t i = 0; i < kSamples; ++i) lags[i] = static_cast<int>(i * 37 % 3001);
  const std::vector<Trace> traces = traces_of_network(motion_m(), received(lags), 0.1 * kPeriod_s);
  ASSERT_EQ(traces.size(), 1U);
  EXPECT_EQ(traces[0].effect.type->name, "jitter");
}

/// As of messages with a delay that is drawn uniformly, 1.15 periods at most: the newest that has arrived counts.
TEST(NetworkTrace, JitterOfLittleMoreThanAPeriodIsNoLoss) {
  constexpr double kJitter = 1.15;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random{seed};
    std::vector<bool> is_late(kSamples);
    for (std::size_t i = 0; i < kSamples; ++i) is_late[i] = kJitter * random.uniform() > 1.0;
    std::vector<int> lags(kSamples, 1);
    for (std::size_t i = 1; i < kSamples; ++i) lags[i] = is_late[i - 1] ? 2 : 1;
    const std::vector<Trace> jitter = traces_of_network(motion_m(), received(lags), kPeriod_s);
    ASSERT_EQ(jitter.size(), 1U);
    EXPECT_EQ(jitter[0].effect.type->name, "jitter") << seed;
    // 1 - 1/J of the messages are late. Behind a late one no repetition is seen: that makes J less by 0.02 periods.
    EXPECT_NEAR(jitter[0].effect.values[0], kJitter * kPeriod_s, 0.03 * kPeriod_s);

    // Control: as many are lost.
    std::vector<int> lost(kSamples, 1);
    for (std::size_t i = 1; i < kSamples; ++i) lost[i] = is_late[i] ? lost[i - 1] + 1 : 1;
    const std::vector<Trace> loss = traces_of_network(motion_m(), received(lost), kPeriod_s);
    ASSERT_FALSE(loss.empty());
    EXPECT_EQ(loss[0].effect.type->name, "loss") << seed;
  }
}

/// Cycles of growing size in steps of one size, each reached within a twentieth of it.
std::vector<double> slow_protocol_m(double step_m) {
  std::vector<double> values;
  double reached = 0.0;
  for (int cycle = 1; cycle <= 6; ++cycle) {
    for (const double turn : {10.0 * cycle, -10.0 * cycle, 0.0}) {
      while (std::abs(turn - reached) > 0.5) values.push_back(step_m * (reached += turn > reached ? 1.0 : -1.0));
    }
  }
  return with_noise(std::move(values), 0.05 * step_m);
}

TEST(SlowReadings, EqualStepsOfTheProtocolAreNoneOfTheConverter) {
  const std::vector<double> protocol_m = slow_protocol_m(4e-4);
  EXPECT_NEAR(steps_of_readings(protocol_m).step, 4e-4, 4e-6);  // what they would be taken for
  EXPECT_EQ(steps_of_slow_readings(protocol_m).step, 0.0);
  // A converter that is coarser than the steps of the protocol shows all the same.
  EXPECT_NEAR(steps_of_slow_readings(in_steps(protocol_m, 2e-3)).step, 2e-3, 2e-5);
  // At the rate of a controller nothing is asked of the distance of readings.
  EXPECT_NEAR(steps_of_slow_readings(in_steps(motion_m(), span_of(motion_m()) / 60.0)).step, span_of(motion_m()) / 60.0,
              1e-3 * span_of(motion_m()) / 60.0);
}

TEST(VerdictWithTraces, PartStaysAPartWhereMoreThanTheDigitsIsLeft) {
  const std::array steps{
      Trace{.effect = {.type = find_effect(EffectInterface::displacement_sensor, "quantization"), .values = {1e-4}},
            .in = Channel::measured_displacement,
            .gap_share = 1e-4}};
  using report::Verdict;
  const GapParts little_in_digits{.traced = 1e-4, .explained = 0.99, .left = 4e-3};
  EXPECT_EQ(verdict_with(steps, Verdict::partial, little_in_digits), Verdict::partial);
  EXPECT_EQ(verdict_with(steps, Verdict::unknown, {.traced = 1e-4, .left = 0.2}), Verdict::partial);
  // Nearly all of the gap is in the digits: they are its cause.
  EXPECT_EQ(verdict_with(steps, Verdict::unknown, {.traced = 1e-4, .left = 1e-7}), Verdict::named);
  EXPECT_EQ(verdict_with({}, Verdict::unknown, {.left = 0.2}), Verdict::unknown);
}

TEST(FindTraces, SumsRecordingsAndSkipsEffectsOfTheModel) {
  const double step = span_of(motion_m()) / 60.0;
  Recording recording =
      made_recording(made_motion_m, [](double t) { return kMadeStiffness_n_per_m * made_motion_m(t); });
  std::vector<double>& measured = recording.dofs[0].of(Channel::measured_displacement);
  measured = in_steps(measured, step);
  SiteModel model = made_model();
  const std::vector<Trace> traces = find_traces(model, {&recording, 1}, 0);
  ASSERT_EQ(traces.size(), 1U);
  EXPECT_EQ(traces[0].effect.type, find_effect(EffectInterface::displacement_sensor, "quantization"));
  const std::vector<Trace> of_two = find_traces(model, std::vector<Recording>{recording, recording}, 0);
  ASSERT_EQ(of_two.size(), 1U);
  EXPECT_DOUBLE_EQ(of_two[0].gap_share, 2.0 * traces[0].gap_share);
  model.effects.push_back(traces[0].effect);
  EXPECT_TRUE(find_traces(model, {&recording, 1}, 0).empty());
}

}  // namespace
}  // namespace hybridtest
