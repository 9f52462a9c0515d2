// Cost of one call of every compensator and delay estimator, as a ratio to that of `none`, measured in one run.
//
// The kinds take turns in short rounds, so that other work on the machine affects all of them alike. The result is
// the median over the rounds. A call includes virtual dispatch, arithmetic and memory access, with a warm cache.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <numbers>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "compensation/adaptive_inverse.hpp"
#include "compensation/adaptive_model_inverse.hpp"
#include "compensation/adaptive_time_series.hpp"
#include "compensation/conditional_adaptive_time_series.hpp"
#include "compensation/delay_estimators/cross_correlation.hpp"
#include "compensation/delay_estimators/fixed_delay.hpp"
#include "compensation/delay_estimators/frequency_evaluation_index.hpp"
#include "compensation/delay_estimators/recursive_least_squares.hpp"
#include "compensation/delay_estimators/zero_crossing_slope.hpp"
#include "compensation/feedforward_lqg.hpp"
#include "compensation/force_correction.hpp"
#include "compensation/force_correction_quadratic.hpp"
#include "compensation/inverse_compensation.hpp"
#include "compensation/linear_acceleration.hpp"
#include "compensation/newmark_kinematics.hpp"
#include "compensation/no_compensation.hpp"
#include "compensation/no_force_compensation.hpp"
#include "compensation/optimal_pick.hpp"
#include "compensation/polynomial_displacement.hpp"
#include "compensation/polynomial_force.hpp"
#include "compensation/two_stage_adaptive.hpp"
#include "compensation/upper_bound_delay.hpp"

namespace {

using namespace hybridtest;

constexpr double kControlRate_hz = 4096.0;
constexpr double kPeriod_s = 1.0 / kControlRate_hz;
constexpr std::size_t kSamplesPerTurn = 256;
constexpr int kSeconds = 50;

struct Sample {
  CompensatorInput input;
  ForceSample force;
  DelaySample delay;
};

/// One second of motion of a structure, periodic.
std::vector<Sample> one_second() {
  std::vector<Sample> samples;
  for (int i = 0; i < static_cast<int>(kControlRate_hz); ++i) {
    const double angle = 2.0 * std::numbers::pi * 3.0 * i * kPeriod_s;
    Sample sample;
    sample.input = {4e-3 * std::sin(angle), 0.075 * std::cos(angle), -1.42 * std::sin(angle),
                    4e-3 * std::sin(angle - 0.4), 4.8e3 * std::sin(angle - 0.4)};
    sample.force = {sample.input.target_m, sample.input.measured_displacement_m, sample.input.measured_force_n};
    sample.delay = {sample.input.target_m, sample.input.measured_displacement_m};
    samples.push_back(sample);
  }
  return samples;
}

struct Subject {
  std::string name;
  std::function<double(std::span<const Sample>)> run;  // each sample once
  std::vector<double> ns_per_call;
};

template <class Call>
Subject subject(std::string name, Call call) {
  return {std::move(name),
          [call](std::span<const Sample> samples) mutable {
            double sum = 0.0;
            for (const Sample& sample : samples) sum += call(sample);
            return sum;
          },
          {}};
}

Subject on_commands(std::string name, std::shared_ptr<Compensator> compensator) {
  return subject(std::move(name), [compensator](const Sample& sample) { return compensator->command(sample.input); });
}
Subject on_forces(std::string name, std::shared_ptr<ForceCompensator> compensator) {
  return subject(std::move(name),
                 [compensator](const Sample& sample) { return compensator->corrected_force(sample.force); });
}
Subject on_delays(std::string name, std::shared_ptr<DelayEstimator> estimator) {
  return subject(std::move(name), [estimator](const Sample& sample) { return estimator->estimate(sample.delay); });
}

template <class Type>
std::shared_ptr<Type> with_defaults() {
  return std::make_shared<Type>(typename Type::Parameters{}, kPeriod_s);
}

std::vector<Subject> all_subjects() {
  return {on_commands("none", std::make_shared<NoCompensation>()),
          on_commands("polynomial_displacement", with_defaults<PolynomialDisplacement>()),
          on_commands("newmark_kinematics", with_defaults<NewmarkKinematics>()),
          on_commands("linear_acceleration", with_defaults<LinearAcceleration>()),
          on_commands("inverse_compensation", with_defaults<InverseCompensation>()),
          on_commands("adaptive_inverse", with_defaults<AdaptiveInverse>()),
          on_commands("adaptive_time_series", with_defaults<AdaptiveTimeSeries>()),
          on_commands("conditional_adaptive_time_series", with_defaults<ConditionalAdaptiveTimeSeries>()),
          on_commands("feedforward_lqg", with_defaults<FeedforwardLqg>()),
          on_commands("two_stage_adaptive", with_defaults<TwoStageAdaptive>()),
          on_commands("upper_bound_delay", with_defaults<UpperBoundDelay>()),
          on_commands("adaptive_model_inverse", with_defaults<AdaptiveModelInverse>()),
          on_forces("none (forces)", std::make_shared<NoForceCompensation>()),
          on_forces("polynomial_force", with_defaults<PolynomialForce>()),
          on_forces("force_correction_quadratic", with_defaults<ForceCorrectionQuadratic>()),
          on_forces("force_correction", with_defaults<ForceCorrection>()),
          on_forces("optimal_pick", with_defaults<OptimalPick>()),
          on_delays("fixed", with_defaults<FixedDelay>()),
          on_delays("zero_crossing_slope", with_defaults<ZeroCrossingSlope>()),
          on_delays("cross_correlation", with_defaults<CrossCorrelation>()),
          on_delays("frequency_evaluation_index", with_defaults<FrequencyEvaluationIndex>()),
          on_delays("recursive_least_squares", with_defaults<RecursiveLeastSquares>())};
}

double measured_ns_per_call(Subject& subject, std::span<const Sample> samples, double& sink) {
  const auto begin = std::chrono::steady_clock::now();
  sink += subject.run(samples);
  const std::chrono::duration<double, std::nano> spent = std::chrono::steady_clock::now() - begin;
  return spent.count() / static_cast<double>(samples.size());
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

int main() {
  const std::vector<Sample> samples = one_second();
  std::vector<Subject> subjects = all_subjects();
  double sink = 0.0;
  for (int second = 0; second < kSeconds; ++second) {
    for (std::size_t begin = 0; begin + kSamplesPerTurn <= samples.size(); begin += kSamplesPerTurn) {
      const std::span<const Sample> turn{samples.data() + begin, kSamplesPerTurn};
      for (Subject& each : subjects) each.ns_per_call.push_back(measured_ns_per_call(each, turn, sink));
    }
  }
  const double none_ns = median(subjects.front().ns_per_call);
  std::printf("Cost of a call at %.0f Hz, default parameters; medians of %zu turns of %zu calls (checksum %.6g).\n",
              kControlRate_hz, subjects.front().ns_per_call.size(), kSamplesPerTurn, sink);
  std::printf("%-34s %10s %12s %18s\n", "", "ns", "ratio", "of the period, %");
  for (const Subject& each : subjects) {
    const double ns = median(each.ns_per_call);
    std::printf("%-34s %10.1f %12.1f %18.4f\n", each.name.c_str(), ns, ns / none_ns, 100.0 * ns * 1e-9 / kPeriod_s);
  }
  return std::isfinite(sink) ? 0 : 1;
}
