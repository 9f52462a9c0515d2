#include "validation/studies/compensation_methods.hpp"

#include "compensation/adaptive_inverse.hpp"
#include "compensation/adaptive_model_inverse.hpp"
#include "compensation/adaptive_time_series.hpp"
#include "compensation/conditional_adaptive_time_series.hpp"
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

namespace hybridtest {
namespace {

/// Margin of the upper bound over the delay: more than the uncertainty of the benchmark.
constexpr double kUpperBoundMarginS = 0.004;

/// Spacing of the points of the force lead. Its noise is 1.2 times that of the load cell; with neighbouring samples it
/// would be 7 times. Two spacings are still short compared with the motion.
constexpr double kForcePointSpacingS = 0.004;

using MakeCompensator = std::function<std::unique_ptr<Compensator>(double, double)>;
using MakeForceCompensator = std::function<std::unique_ptr<ForceCompensator>(double, double)>;

template <class Part>
auto made_with(typename Part::Parameters (*parameters)(double delay_s)) {
  return
      [parameters](double delay_s, double period_s) { return std::make_unique<Part>(parameters(delay_s), period_s); };
}

TimeSeriesParameters time_series(double delay_s) {
  TimeSeriesParameters parameters;
  parameters.a0 = 1.0;
  parameters.a1_s = delay_s;
  parameters.a2_s2 = 0.5 * delay_s * delay_s;
  return parameters;
}

AdaptiveInverse::Parameters adaptive_inverse(double delay_s) {
  AdaptiveInverse::Parameters parameters;
  parameters.delay_s = delay_s;
  return parameters;
}

TwoStageAdaptive::Parameters two_stage(double delay_s) {
  TwoStageAdaptive::Parameters parameters;
  parameters.coarse_delay_s = delay_s;
  return parameters;
}

ForceCorrection::Parameters force_correction(double /*delay_s*/) {
  ForceCorrection::Parameters parameters;
  parameters.stiffness_n_per_m = TransferSystemModel{}.stiffness_n_per_m;
  return parameters;
}

const MakeCompensator kTarget = [](double, double) { return std::make_unique<NoCompensation>(); };
const MakeForceCompensator kMeasured = [](double, double) { return std::make_unique<NoForceCompensation>(); };

CompensationMethod on_commands(std::string name, MethodGroup group, MakeCompensator make) {
  return {std::move(name), group, false, false, "", std::move(make), kMeasured};
}

CompensationMethod on_forces(std::string name, MakeForceCompensator make) {
  return {std::move(name), MethodGroup::force, false, false, "", kTarget, std::move(make)};
}

void add_extrapolations(std::vector<CompensationMethod>& methods) {
  constexpr auto kGroup = MethodGroup::extrapolation;
  methods.push_back(on_commands("none", kGroup, kTarget));
  methods.push_back(on_commands("polynomial_displacement", kGroup,
                                made_with<PolynomialDisplacement>([](double delay_s) -> PolynomialParameters {
                                  return {3, delay_s, 0.0};
                                })));
  methods.push_back(on_commands("newmark_kinematics", kGroup,
                                made_with<NewmarkKinematics>([](double delay_s) -> NewmarkKinematics::Parameters {
                                  return {delay_s, 0.0};
                                })));
  methods.push_back(on_commands("linear_acceleration", kGroup,
                                made_with<LinearAcceleration>([](double delay_s) -> LinearAcceleration::Parameters {
                                  return {delay_s, 0.0};
                                })));
  methods.push_back(on_commands(
      "inverse_compensation", kGroup,
      made_with<InverseCompensation>([](double delay_s) -> InverseCompensation::Parameters { return {delay_s}; })));
}

void add_adaptive(std::vector<CompensationMethod>& methods) {
  constexpr auto kGroup = MethodGroup::adaptive;
  methods.push_back(on_commands("adaptive_inverse", kGroup, made_with<AdaptiveInverse>(adaptive_inverse)));
  methods.push_back(on_commands("adaptive_time_series", kGroup, made_with<AdaptiveTimeSeries>(time_series)));
  methods.push_back(
      on_commands("conditional_adaptive_time_series", kGroup, made_with<ConditionalAdaptiveTimeSeries>(time_series)));
  methods.push_back(on_commands("two_stage_adaptive", kGroup, made_with<TwoStageAdaptive>(two_stage)));
  methods.push_back(on_commands("feedforward_lqg", kGroup, [](double, double period_s) {
    return std::make_unique<FeedforwardLqg>(FeedforwardLqg::Parameters{}, period_s);
  }));
  methods.back().needs_model = true;
  methods.push_back({"adaptive_model_inverse", kGroup, true, true,
                     "with polynomial_force of order 2 over the loop delay of 1.5 periods",
                     [](double, double period_s) {
                       return std::make_unique<AdaptiveModelInverse>(AdaptiveModelInverse::Parameters{}, period_s);
                     },
                     [](double, double period_s) { return make_force_lead(kLoopDelayPeriods, period_s); }});
}

void add_force_methods(std::vector<CompensationMethod>& methods) {
  methods.push_back(
      on_forces("polynomial_force", made_with<PolynomialForce>([](double delay_s) -> PolynomialParameters {
                  return {3, delay_s, 0.0};
                })));
  methods.push_back(
      on_forces("force_correction_quadratic",
                made_with<ForceCorrectionQuadratic>([](double delay_s) -> ForceCorrectionQuadratic::Parameters {
                  return {3, delay_s};
                })));
  methods.push_back(on_forces("force_correction", made_with<ForceCorrection>(force_correction)));
  methods.back().is_ours = true;
  methods.back().remark = "force_correction_quadratic without the jumps";
  methods.push_back(
      {"upper_bound_delay", MethodGroup::force, false, false, "with optimal_pick on the forces",
       made_with<UpperBoundDelay>([](double delay_s) -> UpperBoundDelay::Parameters {
         return {delay_s + kUpperBoundMarginS, 3, 0.0};
       }),
       [](double, double period_s) { return std::make_unique<OptimalPick>(OptimalPick::Parameters{}, period_s); }});
}

}  // namespace

std::vector<CompensationMethod> compensation_methods() {
  std::vector<CompensationMethod> methods;
  add_extrapolations(methods);
  add_adaptive(methods);
  add_force_methods(methods);
  return methods;
}

std::unique_ptr<ForceCompensator> make_force_lead(double periods, double period_s) {
  return std::make_unique<PolynomialForce>(PolynomialForce::Parameters{2, periods * period_s, kForcePointSpacingS},
                                           period_s);
}

}  // namespace hybridtest
