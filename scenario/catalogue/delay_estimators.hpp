#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "compensation/delay_adaptive.hpp"
#include "compensation/delay_estimator.hpp"
#include "compensation/delay_estimators/fixed_delay.hpp"
#include "scenario/catalogue/part.hpp"

namespace hybridtest {

using EstimatorMaker = std::function<std::unique_ptr<DelayEstimator>(double control_period_s)>;

/// Of an estimate.
enum class EstimateBound { smallest, largest };

/// An estimator that stays at a bound of another one, as far as the compensator can follow.
/// @param compensator   a Compensator or ForceCompensator that is also DelayAdaptive.
template <class AnyCompensator>
[[nodiscard]] std::unique_ptr<DelayEstimator> estimate_at(const DelayEstimator& estimator, EstimateBound bound,
                                                          const AnyCompensator* compensator, double control_period_s) {
  const DelayLimits& limits = estimator.limits();
  DelayLimits fixed = limits;
  fixed.initial_delay_s = bound == EstimateBound::smallest ? limits.delay_s_min : limits.delay_s_max;
  if (const auto* adaptive = dynamic_cast<const DelayAdaptive*>(compensator); adaptive != nullptr) {
    fixed.initial_delay_s = std::min(fixed.initial_delay_s, adaptive->delay_s_max());
  }
  return std::make_unique<FixedDelay>(FixedDelay::Parameters{fixed}, control_period_s);
}

/// Every delay estimator that a file can name.
[[nodiscard]] const std::vector<PartType<EstimatorMaker>>& delay_estimators();

/// The optional section `estimator` of a compensator, which drives its delay while the test runs.
[[nodiscard]] std::optional<EstimatorMaker> read_optional_estimator(config::Section& section);

}  // namespace hybridtest
