#include "scenario/catalogue/compensators.hpp"

#include <algorithm>
#include <utility>

#include "compensation/adaptive_inverse.hpp"
#include "compensation/adaptive_model_inverse.hpp"
#include "compensation/adaptive_time_series.hpp"
#include "compensation/conditional_adaptive_time_series.hpp"
#include "compensation/estimated_delay_compensation.hpp"
#include "compensation/feedforward_lqg.hpp"
#include "compensation/inverse_compensation.hpp"
#include "compensation/linear_acceleration.hpp"
#include "compensation/newmark_kinematics.hpp"
#include "compensation/no_compensation.hpp"
#include "compensation/polynomial_displacement.hpp"
#include "compensation/two_stage_adaptive.hpp"
#include "compensation/upper_bound_delay.hpp"
#include "scenario/catalogue/delay_estimators.hpp"

namespace hybridtest {
namespace {

using config::Section;

/// A compensator without a setting that an effect could change.
/// @param delay_s   of its parameters: what it makes up for.
template <class Part, class Delay>
PartType<CompensatorReading> compensator(std::string name, Delay delay_s) {
  const auto read = [delay_s](Section& section) {
    const auto parameters = read_parameters<Part>(section);
    return CompensatorReading{
        .make = [parameters](double period_s, double) { return std::make_unique<Part>(parameters, period_s); },
        .delay_s = std::invoke(delay_s, parameters)};
  };
  return {std::move(name), read, describe<Part>};
}

/// The largest setting of a delay.
template <class Parameters>
double setting_s_max(const Parameters& parameters) {
  // Where the points stay where they are: eight spacings, of which the rounding to control periods may take a third.
  if constexpr (requires { parameters.point_spacing_s; }) {
    if (parameters.point_spacing_s > 0.0) return 5.0 * parameters.point_spacing_s;
  }
  return 1.0;
}

/// A compensator whose `delay_s` is a setting.
template <class Part>
PartType<CompensatorReading> compensator_set_to_delay(std::string name) {
  const auto read = [](Section& section) {
    const auto parameters = read_parameters<Part>(section);
    return CompensatorReading{
        .make =
            [parameters](double period_s, double delay_change_s) {
              auto changed = parameters;
              changed.delay_s += delay_change_s;
              return std::make_unique<Part>(changed, period_s);
            },
        .delay_s = parameters.delay_s,
        .setting = {.set_s = parameters.delay_s, .most_s = std::max(parameters.delay_s, setting_s_max(parameters))}};
  };
  return {std::move(name), read, describe<Part>};
}

/// One that learns the delay during the test.
PartType<CompensatorReading> learning(PartType<CompensatorReading> type) {
  type.read = [read = std::move(type.read)](Section& section) {
    CompensatorReading reading = read(section);
    reading.learns_delay = true;
    return reading;
  };
  return type;
}

/// Where the scenario has no compensator, the real setting is not known; it is taken for the usual polynomial.
CompensatorReading read_none(Section&) {
  return {.make = [](double period_s, double delay_change_s) -> std::unique_ptr<Compensator> {
            if (delay_change_s <= 0.0) return std::make_unique<NoCompensation>();
            return std::make_unique<PolynomialDisplacement>(
                PolynomialDisplacement::Parameters{.delay_s = delay_change_s}, period_s);
          },
          .setting = {.set_s = 0.0, .most_s = 1.0}};
}

template <class Parameters>
double plant_delay_s(const Parameters& parameters) {
  return parameters.model.low_frequency_delay_s();
}

}  // namespace

const std::vector<PartType<CompensatorReading>>& compensators() {
  static const std::vector<PartType<CompensatorReading>> table{
      {"none", read_none},
      compensator_set_to_delay<PolynomialDisplacement>("polynomial_displacement"),
      compensator_set_to_delay<NewmarkKinematics>("newmark_kinematics"),
      compensator_set_to_delay<LinearAcceleration>("linear_acceleration"),
      compensator_set_to_delay<InverseCompensation>("inverse_compensation"),
      learning(compensator_set_to_delay<AdaptiveInverse>("adaptive_inverse")),
      learning(compensator<AdaptiveTimeSeries>("adaptive_time_series", &TimeSeriesParameters::a1_s)),
      learning(
          compensator<ConditionalAdaptiveTimeSeries>("conditional_adaptive_time_series", &TimeSeriesParameters::a1_s)),
      compensator<FeedforwardLqg>("feedforward_lqg", plant_delay_s<FeedforwardLqg::Parameters>),
      learning(compensator<TwoStageAdaptive>("two_stage_adaptive", &TwoStageAdaptive::Parameters::coarse_delay_s)),
      compensator<UpperBoundDelay>("upper_bound_delay", &UpperBoundDelay::Parameters::delay_upper_bound_s),
      learning(
          compensator<AdaptiveModelInverse>("adaptive_model_inverse", plant_delay_s<AdaptiveModelInverse::Parameters>)),
  };
  return table;
}

CompensatorReading read_compensator(Section section) {
  const auto estimator_maker = read_optional_estimator(section);
  CompensatorReading reading = read_type(section, compensators(), "none");
  if (estimator_maker) {
    const auto make = reading.make;
    reading.make = [make, make_estimator = *estimator_maker](double period_s, double) {
      return std::make_unique<EstimatedDelayCompensation>(make(period_s, 0.0), make_estimator(period_s));
    };
    reading.make_at = [make, make_estimator = *estimator_maker](double period_s, EstimateBound bound) {
      auto compensator = make(period_s, 0.0);
      auto estimator = estimate_at(*make_estimator(period_s), bound, compensator.get(), period_s);
      return std::make_unique<EstimatedDelayCompensation>(std::move(compensator), std::move(estimator));
    };
    reading.setting = {};
    reading.learns_delay = true;
  }
  return reading;
}

}  // namespace hybridtest
