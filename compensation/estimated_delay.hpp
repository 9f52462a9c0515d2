#pragma once

#include "compensation/delay_adaptive.hpp"
#include "compensation/delay_estimator.hpp"

namespace hybridtest {

/// Can the estimator drive the compensator?
/// @throws ConfigError where either is null, the compensator having no delay to set, or where the
///   compensator cannot make up for the delay that the estimator begins with.
void check_estimated_delay(const DelayAdaptive* compensator, const DelayEstimator* estimator);

}  // namespace hybridtest
