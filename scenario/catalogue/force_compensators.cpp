#include "scenario/catalogue/force_compensators.hpp"

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

template <class Part>
PartType<ForceCompensatorMaker> force_compensator(std::string name) {
  const auto read = [](config::Section& section) -> ForceCompensatorMaker {
    return [parameters = read_parameters<Part>(section)](double period_s) {
      return std::make_unique<Part>(parameters, period_s);
    };
  };
  return {std::move(name), read, describe<Part>};
}

ForceCompensatorMaker read_no_force_compensation(config::Section&) {
  return [](double) { return std::make_unique<NoForceCompensation>(); };
}

}  // namespace

const std::vector<PartType<ForceCompensatorMaker>>& force_compensators() {
  static const std::vector<PartType<ForceCompensatorMaker>> table{
      {"none", read_no_force_compensation},
      force_compensator<PolynomialForce>("polynomial_force"),
      force_compensator<ForceCorrection>("force_correction"),
      force_compensator<ForceCorrectionQuadratic>("force_correction_quadratic"),
      force_compensator<OptimalPick>("optimal_pick"),
  };
  return table;
}

ForceCompensatorMaker read_force_compensator(config::Section section) {
  const auto estimator_maker = read_optional_estimator(section);
  ForceCompensatorMaker maker = read_type(section, force_compensators(), "none");
  if (!estimator_maker) return maker;
  return [maker, make_estimator = *estimator_maker](double period_s) {
    return std::make_unique<EstimatedDelayForceCompensation>(maker(period_s), make_estimator(period_s));
  };
}

}  // namespace hybridtest
