#include "scenario/catalogue/delay_estimators.hpp"

#include <utility>

#include "compensation/delay_estimators/cross_correlation.hpp"
#include "compensation/delay_estimators/frequency_evaluation_index.hpp"
#include "compensation/delay_estimators/recursive_least_squares.hpp"
#include "compensation/delay_estimators/zero_crossing_slope.hpp"

namespace hybridtest {
namespace {

template <class Part>
PartType<EstimatorMaker> estimator(std::string name) {
  const auto read = [](config::Section& section) -> EstimatorMaker {
    return [parameters = read_parameters<Part>(section)](double period_s) {
      return std::make_unique<Part>(parameters, period_s);
    };
  };
  return {std::move(name), read, describe<Part>};
}

}  // namespace

const std::vector<PartType<EstimatorMaker>>& delay_estimators() {
  static const std::vector<PartType<EstimatorMaker>> table{
      estimator<FixedDelay>("fixed"),
      estimator<ZeroCrossingSlope>("zero_crossing_slope"),
      estimator<CrossCorrelation>("cross_correlation"),
      estimator<FrequencyEvaluationIndex>("frequency_evaluation_index"),
      estimator<RecursiveLeastSquares>("recursive_least_squares"),
  };
  return table;
}

std::optional<EstimatorMaker> read_optional_estimator(config::Section& section) {
  if (!section.has("estimator")) return std::nullopt;
  config::Section part = section.section("estimator");
  return read_type(part, delay_estimators());
}

}  // namespace hybridtest
