// The compensators, compensators on forces and delay estimators that a scenario can name. Ranges
// are checked by their constructors, once the control period is known.

#include <algorithm>
#include <utility>

#include "compensation/adaptive_inverse.hpp"
#include "compensation/adaptive_model_inverse.hpp"
#include "compensation/adaptive_time_series.hpp"
#include "compensation/conditional_adaptive_time_series.hpp"
#include "compensation/delay_estimators/cross_correlation.hpp"
#include "compensation/delay_estimators/fixed_delay.hpp"
#include "compensation/delay_estimators/frequency_evaluation_index.hpp"
#include "compensation/delay_estimators/recursive_least_squares.hpp"
#include "compensation/delay_estimators/zero_crossing_slope.hpp"
#include "compensation/estimated_delay_compensation.hpp"
#include "compensation/estimated_delay_force_compensation.hpp"
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
#include "scenario/catalogue/compose.hpp"
#include "scenario/catalogue/named_type.hpp"

namespace hybridtest {
namespace {

using config::Section;

/// Reads a parameter whose default stands in `value`.
void take(Section& section, std::string_view key, double& value) { value = section.number(key, kAnyNumber, value); }
void take(Section& section, std::string_view key, bool& value) { value = section.boolean(key, value); }
void take(Section& section, std::string_view key, int& value) {
  value = static_cast<int>(section.integer(key, 0, 1'000'000, value));
}

/// The delay that is made up for has no sensible default: whoever compensates has to say it.
double required_delay(Section& section, std::string_view key) { return section.number(key, {.low = 0.0, .high = 1.0}); }

template <class Part>
CompensatorReading compensator(const typename Part::Parameters& parameters, double delay_s) {
  return {.make = [parameters](double period_s, double) { return std::make_unique<Part>(parameters, period_s); },
          .delay_s = delay_s};
}

/// One whose delay is a setting.
/// @param most_s   that the setting may be.
template <class Part>
CompensatorReading compensator_set_to(const typename Part::Parameters& parameters, double Part::Parameters::*delay_s,
                                      double most_s = 1.0) {
  const double set_s = parameters.*delay_s;
  return {.make =
              [parameters, delay_s](double period_s, double delay_change_s) {
                typename Part::Parameters changed = parameters;
                changed.*delay_s += delay_change_s;
                return std::make_unique<Part>(changed, period_s);
              },
          .delay_s = set_s,
          .setting = {.set_s = set_s, .most_s = std::max(set_s, most_s)}};
}

/// The most that a compensator makes up for whose points stay where they are: eight spacings, of which the rounding to
/// control periods may take a third.
double most_ahead_s(double point_spacing_s) { return point_spacing_s > 0.0 ? 5.0 * point_spacing_s : 1.0; }

template <class Part>
ForceCompensatorMaker force_compensator(const typename Part::Parameters& parameters) {
  return [parameters](double period_s) { return std::make_unique<Part>(parameters, period_s); };
}

template <class Part>
typename Part::Parameters polynomial_parameters(Section& section) {
  typename Part::Parameters parameters;
  take(section, "order", parameters.order);
  parameters.delay_s = required_delay(section, "delay_s");
  take(section, "point_spacing_s", parameters.point_spacing_s);
  return parameters;
}

/// What is set where nothing was said to be is not known; it is taken for the usual polynomial.
CompensatorReading read_none(Section&) {
  return {.make = [](double period_s, double delay_change_s) -> std::unique_ptr<Compensator> {
            if (delay_change_s <= 0.0) return std::make_unique<NoCompensation>();
            return std::make_unique<PolynomialDisplacement>(
                PolynomialDisplacement::Parameters{.delay_s = delay_change_s}, period_s);
          },
          .setting = {.set_s = 0.0, .most_s = 1.0}};
}

CompensatorReading read_polynomial_displacement(Section& section) {
  const auto parameters = polynomial_parameters<PolynomialDisplacement>(section);
  return compensator_set_to<PolynomialDisplacement>(parameters, &PolynomialDisplacement::Parameters::delay_s,
                                                    most_ahead_s(parameters.point_spacing_s));
}

CompensatorReading read_newmark_kinematics(Section& section) {
  NewmarkKinematics::Parameters parameters;
  parameters.delay_s = required_delay(section, "delay_s");
  take(section, "step_s", parameters.step_s);
  return compensator_set_to<NewmarkKinematics>(parameters, &NewmarkKinematics::Parameters::delay_s);
}

CompensatorReading read_linear_acceleration(Section& section) {
  LinearAcceleration::Parameters parameters;
  parameters.delay_s = required_delay(section, "delay_s");
  take(section, "point_spacing_s", parameters.point_spacing_s);
  return compensator_set_to<LinearAcceleration>(parameters, &LinearAcceleration::Parameters::delay_s,
                                                most_ahead_s(parameters.point_spacing_s));
}

CompensatorReading read_inverse_compensation(Section& section) {
  InverseCompensation::Parameters parameters;
  parameters.delay_s = required_delay(section, "delay_s");
  return compensator_set_to<InverseCompensation>(parameters, &InverseCompensation::Parameters::delay_s);
}

CompensatorReading read_adaptive_inverse(Section& section) {
  AdaptiveInverse::Parameters parameters;
  parameters.delay_s = required_delay(section, "delay_s");
  take(section, "proportional_gain_per_m2", parameters.proportional_gain_per_m2);
  take(section, "integral_gain_per_m2_s", parameters.integral_gain_per_m2_s);
  take(section, "delay_correction_s_max", parameters.delay_correction_s_max);
  return compensator_set_to<AdaptiveInverse>(parameters, &AdaptiveInverse::Parameters::delay_s);
}

template <class Part>
CompensatorReading read_time_series(Section& section) {
  TimeSeriesParameters parameters;
  take(section, "a0", parameters.a0);
  take(section, "a1_s", parameters.a1_s);
  take(section, "a2_s2", parameters.a2_s2);
  take(section, "window_s", parameters.window_s);
  take(section, "filter_hz", parameters.filter_hz);
  take(section, "motion_m_min", parameters.motion_m_min);
  take(section, "a0_min", parameters.a0_min);
  take(section, "a0_max", parameters.a0_max);
  take(section, "a1_s_min", parameters.a1_s_min);
  take(section, "a1_s_max", parameters.a1_s_max);
  take(section, "a2_s2_min", parameters.a2_s2_min);
  take(section, "a2_s2_max", parameters.a2_s2_max);
  take(section, "a0_rate_max", parameters.a0_rate_max);
  take(section, "a1_rate_s_max", parameters.a1_rate_s_max);
  take(section, "a2_rate_s2_max", parameters.a2_rate_s2_max);
  return compensator<Part>(parameters, parameters.a1_s);
}

/// The plant of a model-based compensator; the defaults are those of the virtual RTHS benchmark.
TransferSystemModel read_plant(Section section) {
  TransferSystemModel model;
  take(section, "gain", model.gain);
  take(section, "a1beta0_n_per_m_s3", model.a1beta0_n_per_m_s3);
  take(section, "a2_n_per_m", model.a2_n_per_m);
  take(section, "a3_per_s", model.a3_per_s);
  take(section, "beta1_per_s", model.beta1_per_s);
  take(section, "beta2_per_s2", model.beta2_per_s2);
  take(section, "mass_kg", model.mass_kg);
  take(section, "damping_n_s_per_m", model.damping_n_s_per_m);
  take(section, "stiffness_n_per_m", model.stiffness_n_per_m);
  section.finish();
  return model;
}

/// How late the plant is for slow motion: the slope of its phase at zero frequency.
double low_frequency_delay_s(const TransferSystemModel& plant) {
  const double forward = plant.a1beta0_n_per_m_s3;
  const double open = plant.beta2_per_s2 * plant.a3_per_s * plant.stiffness_n_per_m;
  const double slope =
      plant.beta1_per_s * plant.a3_per_s * plant.stiffness_n_per_m +
      plant.beta2_per_s2 * (plant.stiffness_n_per_m + plant.a2_n_per_m + plant.a3_per_s * plant.damping_n_s_per_m);
  return slope / (forward + open);
}

CompensatorReading read_feedforward_lqg(Section& section) {
  FeedforwardLqg::Parameters parameters;
  parameters.model = read_plant(section.section("plant"));
  take(section, "has_feedback", parameters.has_feedback);
  take(section, "regulator_weight", parameters.regulator_weight);
  take(section, "input_noise_m", parameters.input_noise_m);
  take(section, "displacement_noise_m", parameters.displacement_noise_m);
  take(section, "jerk_difference_s", parameters.jerk_difference_s);
  return compensator<FeedforwardLqg>(parameters, low_frequency_delay_s(parameters.model));
}

CompensatorReading read_two_stage_adaptive(Section& section) {
  TwoStageAdaptive::Parameters parameters;
  parameters.coarse_delay_s = required_delay(section, "coarse_delay_s");
  take(section, "term_spacing_s", parameters.term_spacing_s);
  take(section, "memory_s", parameters.memory_s);
  take(section, "filter_hz", parameters.filter_hz);
  take(section, "equation_error_m", parameters.equation_error_m);
  take(section, "theta_deviation", parameters.theta_deviation);
  take(section, "theta_max", parameters.theta_max);
  return compensator<TwoStageAdaptive>(parameters, parameters.coarse_delay_s);
}

CompensatorReading read_upper_bound_delay(Section& section) {
  UpperBoundDelay::Parameters parameters;
  parameters.delay_upper_bound_s = required_delay(section, "delay_upper_bound_s");
  take(section, "order", parameters.order);
  take(section, "point_spacing_s", parameters.point_spacing_s);
  return compensator<UpperBoundDelay>(parameters, parameters.delay_upper_bound_s);
}

CompensatorReading read_adaptive_model_inverse(Section& section) {
  AdaptiveModelInverse::Parameters parameters;
  parameters.model = read_plant(section.section("plant"));
  take(section, "advance_s", parameters.advance_s);
  take(section, "stiffness_deviation_n_per_m", parameters.stiffness_deviation_n_per_m);
  take(section, "beta2_deviation_per_s2", parameters.beta2_deviation_per_s2);
  take(section, "a3_deviation_per_s", parameters.a3_deviation_per_s);
  take(section, "beta1_deviation_per_s", parameters.beta1_deviation_per_s);
  take(section, "parameter_memory_s", parameters.parameter_memory_s);
  take(section, "displacement_noise_m", parameters.displacement_noise_m);
  take(section, "force_noise_n", parameters.force_noise_n);
  take(section, "command_noise_m", parameters.command_noise_m);
  take(section, "disturbance_walk_m", parameters.disturbance_walk_m);
  take(section, "regulator_weight", parameters.regulator_weight);
  take(section, "jerk_filter_hz", parameters.jerk_filter_hz);
  take(section, "parameter_bound", parameters.parameter_bound);
  take(section, "innovation_bound", parameters.innovation_bound);
  take(section, "adapts", parameters.adapts);
  return compensator<AdaptiveModelInverse>(parameters, low_frequency_delay_s(parameters.model));
}

ForceCompensatorMaker read_no_force_compensation(Section&) {
  return [](double) { return std::make_unique<NoForceCompensation>(); };
}

ForceCompensatorMaker read_polynomial_force(Section& section) {
  return force_compensator<PolynomialForce>(polynomial_parameters<PolynomialForce>(section));
}

ForceCompensatorMaker read_force_correction(Section& section) {
  ForceCorrection::Parameters parameters;
  take(section, "window_s", parameters.window_s);
  take(section, "horizon_s", parameters.horizon_s);
  take(section, "root_rate_s_per_s_max", parameters.root_rate_s_per_s_max);
  take(section, "stiffness_n_per_m", parameters.stiffness_n_per_m);
  take(section, "stiffness_memory_s", parameters.stiffness_memory_s);
  take(section, "prior_motion_m", parameters.prior_motion_m);
  return force_compensator<ForceCorrection>(parameters);
}

ForceCompensatorMaker read_force_correction_quadratic(Section& section) {
  ForceCorrectionQuadratic::Parameters parameters;
  take(section, "points", parameters.points);
  take(section, "point_spacing_s", parameters.point_spacing_s);
  return force_compensator<ForceCorrectionQuadratic>(parameters);
}

ForceCompensatorMaker read_optimal_pick(Section& section) {
  OptimalPick::Parameters parameters;
  take(section, "window_s", parameters.window_s);
  return force_compensator<OptimalPick>(parameters);
}

using EstimatorMaker = std::function<std::unique_ptr<DelayEstimator>(double period_s)>;

template <class Part>
EstimatorMaker estimator(Section& section, typename Part::Parameters parameters) {
  parameters.limits.initial_delay_s = required_delay(section, "initial_delay_s");
  take(section, "delay_s_min", parameters.limits.delay_s_min);
  take(section, "delay_s_max", parameters.limits.delay_s_max);
  take(section, "rate_s_per_s_max", parameters.limits.rate_s_per_s_max);
  return [parameters](double period_s) { return std::make_unique<Part>(parameters, period_s); };
}

EstimatorMaker read_fixed(Section& section) { return estimator<FixedDelay>(section, {}); }

EstimatorMaker read_zero_crossing_slope(Section& section) {
  ZeroCrossingSlope::Parameters parameters;
  take(section, "average_s", parameters.average_s);
  take(section, "slope_m_per_s_min", parameters.slope_m_per_s_min);
  take(section, "motion_m_min", parameters.motion_m_min);
  take(section, "crossing_weight", parameters.crossing_weight);
  return estimator<ZeroCrossingSlope>(section, parameters);
}

EstimatorMaker read_cross_correlation(Section& section) {
  CrossCorrelation::Parameters parameters;
  take(section, "memory_s", parameters.memory_s);
  take(section, "parabola_half_s", parameters.parabola_half_s);
  take(section, "comparison_period_s", parameters.comparison_period_s);
  take(section, "motion_m_min", parameters.motion_m_min);
  return estimator<CrossCorrelation>(section, parameters);
}

EstimatorMaker read_frequency_evaluation_index(Section& section) {
  FrequencyEvaluationIndex::Parameters parameters;
  take(section, "window_s", parameters.window_s);
  take(section, "frequency_hz_min", parameters.frequency_hz_min);
  take(section, "frequency_hz_max", parameters.frequency_hz_max);
  take(section, "motion_m_min", parameters.motion_m_min);
  return estimator<FrequencyEvaluationIndex>(section, parameters);
}

EstimatorMaker read_recursive_least_squares(Section& section) {
  RecursiveLeastSquares::Parameters parameters;
  take(section, "memory_s", parameters.memory_s);
  take(section, "motion_m_min", parameters.motion_m_min);
  return estimator<RecursiveLeastSquares>(section, parameters);
}

EstimatorMaker read_estimator(Section section) {
  return read_type<EstimatorMaker>(section, {{"fixed", read_fixed},
                                             {"zero_crossing_slope", read_zero_crossing_slope},
                                             {"cross_correlation", read_cross_correlation},
                                             {"frequency_evaluation_index", read_frequency_evaluation_index},
                                             {"recursive_least_squares", read_recursive_least_squares}});
}

/// The `estimator` beside the type, which drives the delay of the compensator online.
std::optional<EstimatorMaker> read_optional_estimator(Section& section) {
  if (!section.has("estimator")) return std::nullopt;
  return read_estimator(section.section("estimator"));
}

}  // namespace

CompensatorReading read_compensator(Section section) {
  const auto estimator_maker = read_optional_estimator(section);
  CompensatorReading reading = read_type<CompensatorReading>(
      section,
      {{"none", read_none},
       {"polynomial_displacement", read_polynomial_displacement},
       {"newmark_kinematics", read_newmark_kinematics},
       {"linear_acceleration", read_linear_acceleration},
       {"inverse_compensation", read_inverse_compensation},
       {"adaptive_inverse", read_adaptive_inverse},
       {"adaptive_time_series", read_time_series<AdaptiveTimeSeries>},
       {"conditional_adaptive_time_series", read_time_series<ConditionalAdaptiveTimeSeries>},
       {"feedforward_lqg", read_feedforward_lqg},
       {"two_stage_adaptive", read_two_stage_adaptive},
       {"upper_bound_delay", read_upper_bound_delay},
       {"adaptive_model_inverse", read_adaptive_model_inverse}},
      "none");
  if (estimator_maker) {
    reading.make = [make = reading.make, make_estimator = *estimator_maker](double period_s, double) {
      return std::make_unique<EstimatedDelayCompensation>(make(period_s, 0.0), make_estimator(period_s));
    };
    reading.setting = {};
  }
  return reading;
}

ForceCompensatorMaker read_force_compensator(Section section) {
  const auto estimator_maker = read_optional_estimator(section);
  ForceCompensatorMaker maker =
      read_type<ForceCompensatorMaker>(section,
                                       {{"none", read_no_force_compensation},
                                        {"polynomial_force", read_polynomial_force},
                                        {"force_correction", read_force_correction},
                                        {"force_correction_quadratic", read_force_correction_quadratic},
                                        {"optimal_pick", read_optimal_pick}},
                                       "none");
  if (!estimator_maker) return maker;
  return [maker, make_estimator = *estimator_maker](double period_s) {
    return std::make_unique<EstimatedDelayForceCompensation>(maker(period_s), make_estimator(period_s));
  };
}

}  // namespace hybridtest
