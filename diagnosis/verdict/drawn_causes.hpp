#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/random.hpp"
#include "plant/site_model.hpp"

namespace hybridtest {

/// A draw from a normal distribution about zero, of each covariance after the other.
/// @param covariances   see Diagnosis::doubts; their units may differ by many orders of magnitude.
[[nodiscard]] Eigen::VectorXd drawn_deviation(std::span<const Eigen::MatrixXd> covariances, Random& random);

/// The causes with their parameters moved, each within what its effect accepts.
/// @param deviation   one per parameter, effect by effect; parameters beyond its end stay as they are.
[[nodiscard]] std::vector<EffectSetting> moved_causes(std::span<const EffectSetting> causes,
                                                      const Eigen::VectorXd& deviation);

}  // namespace hybridtest
