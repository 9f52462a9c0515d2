#include "diagnosis/verdict/drawn_causes.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>

namespace hybridtest {

namespace {

/// Of each parameter's own deviation, so that newtons and metres weigh alike in the roots.
Eigen::VectorXd drawn_of_one(const Eigen::MatrixXd& covariance, Random& random) {
  const Eigen::VectorXd deviation = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  const Eigen::VectorXd inverse = (deviation.array() > 0.0).select(deviation.array().inverse(), 0.0).matrix();
  const Eigen::MatrixXd correlation = inverse.asDiagonal() * covariance * inverse.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> parts{correlation};
  Eigen::VectorXd drawn(deviation.size());
  for (double& value : drawn) value = random.normal();
  drawn.array() *= parts.eigenvalues().array().max(0.0).sqrt();
  return deviation.cwiseProduct(parts.eigenvectors() * drawn);
}

}  // namespace

Eigen::VectorXd drawn_deviation(std::span<const Eigen::MatrixXd> covariances, Random& random) {
  Eigen::VectorXd all;
  for (const Eigen::MatrixXd& covariance : covariances) {
    if (covariance.size() == 0) continue;
    all.conservativeResize(all.size() + covariance.rows());
    all.tail(covariance.rows()) = drawn_of_one(covariance, random);
  }
  return all;
}

std::vector<EffectSetting> moved_causes(std::span<const EffectSetting> causes, const Eigen::VectorXd& deviation) {
  std::vector<EffectSetting> moved(causes.begin(), causes.end());
  Eigen::Index next = 0;
  for (EffectSetting& cause : moved) {
    for (std::size_t i = 0; i < cause.values.size() && next < deviation.size(); ++i, ++next) {
      const EffectParameter& parameter = cause.type->parameters[i];
      cause.values[i] = std::clamp(cause.values[i] + deviation[next], parameter.low, parameter.high);
    }
  }
  return moved;
}

}  // namespace hybridtest
