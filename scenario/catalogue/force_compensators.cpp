#include "scenario/catalogue/force_compensators.hpp"

#include <type_traits>
#include <utility>

#include "compensation/estimated_delay_force_compensation.hpp"
#include "compensation/force_correction.hpp"
#include "compensation/force_correction_quadratic.hpp"
#include "compensation/no_force_compensation.hpp"
#include "compensation/optimal_pick.hpp"
#include "compensation/polynomial_force.hpp"
#include "scenario/catalogue/delay_estimators.hpp"

namespace hybridtest {
namespace {

struct DelayRange {
  double low_s = 0.0;
  double high_s = 0.0;
};

DelayRange made_up_for(const PolynomialForce::Parameters& parameters) {
  return {parameters.delay_s, parameters.delay_s};
}

/// It looks for the wanted displacement within its window, and ahead as far as its horizon.
DelayRange made_up_for(const ForceCorrection::Parameters& parameters) {
  return {-parameters.window_s, parameters.horizon_s};
}

/// A parabola is not trusted further ahead than its points reach back.
DelayRange made_up_for(const ForceCorrectionQuadratic::Parameters& parameters) {
  const double span_s = (parameters.points - 1) * parameters.point_spacing_s;
  return {-span_s, span_s};
}

/// It looks back only: for a displacement that comes too early.
DelayRange made_up_for(const OptimalPick::Parameters& parameters) { return {-parameters.window_s, 0.0}; }

template <class Part>
PartType<ForceCompensatorReading> force_compensator(std::string name) {
  const auto read = [](config::Section& section) {
    const auto parameters = read_parameters<Part>(section);
    const DelayRange range = made_up_for(parameters);
    return ForceCompensatorReading{
        .make = [parameters](double period_s) { return std::make_unique<Part>(parameters, period_s); },
        .delay_s_min = range.low_s,
        .delay_s_max = range.high_s,
        .is_linear = std::is_same_v<Part, PolynomialForce>};
  };
  return {std::move(name), read, describe<Part>};
}

ForceCompensatorReading read_no_force_compensation(config::Section&) {
  return {.make = [](double) { return std::make_unique<NoForceCompensation>(); }};
}

}  // namespace

const std::vector<PartType<ForceCompensatorReading>>& force_compensators() {
  static const std::vector<PartType<ForceCompensatorReading>> table{
      {"none", read_no_force_compensation},
      force_compensator<PolynomialForce>("polynomial_force"),
      force_compensator<ForceCorrection>("force_correction"),
      force_compensator<ForceCorrectionQuadratic>("force_correction_quadratic"),
      force_compensator<OptimalPick>("optimal_pick"),
  };
  return table;
}

ForceCompensatorReading read_force_compensator(config::Section section) {
  const auto estimator_maker = read_optional_estimator(section);
  ForceCompensatorReading reading = read_type(section, force_compensators(), "none");
  if (!estimator_maker) return reading;
  const auto make = reading.make;
  reading.make = [make, make_estimator = *estimator_maker](double period_s) {
    return std::make_unique<EstimatedDelayForceCompensation>(make(period_s), make_estimator(period_s));
  };
  reading.make_at = [make, make_estimator = *estimator_maker](double period_s, EstimateBound bound) {
    auto compensator = make(period_s);
    auto estimator = estimate_at(*make_estimator(period_s), bound, compensator.get(), period_s);
    return std::make_unique<EstimatedDelayForceCompensation>(std::move(compensator), std::move(estimator));
  };
  reading.learns_delay = true;
  return reading;
}

}  // namespace hybridtest
