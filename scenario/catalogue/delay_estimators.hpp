#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "compensation/delay_estimator.hpp"
#include "scenario/catalogue/part.hpp"

namespace hybridtest {

using EstimatorMaker = std::function<std::unique_ptr<DelayEstimator>(double control_period_s)>;

/// Every delay estimator that a file can name.
[[nodiscard]] const std::vector<PartType<EstimatorMaker>>& delay_estimators();

/// The optional section `estimator` of a compensator, which drives its delay while the test runs.
[[nodiscard]] std::optional<EstimatorMaker> read_optional_estimator(config::Section& section);

}  // namespace hybridtest
