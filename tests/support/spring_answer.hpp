#pragma once

#include <Eigen/Core>

#include "coordinator/preflight/coupled_loop.hpp"

namespace hybridtest::test {

inline Eigen::MatrixXd one_by_one(double value) { return Eigen::MatrixXd::Constant(1, 1, value); }

/// A specimen whose force is that of the command, at once, and another one than the integrator knows.
inline SiteAnswer spring_answer(const Eigen::MatrixXd& known_n_per_m, const Eigen::MatrixXd& met_n_per_m) {
  SiteAnswer answer;
  answer.stiffness_n_per_m = known_n_per_m;
  answer.force_n = Eigen::MatrixXd::Zero(1, IntegratorResponse::kChannels * met_n_per_m.size());
  answer.force_n.leftCols(met_n_per_m.size()) = met_n_per_m.reshaped().transpose();
  return answer;
}

}  // namespace hybridtest::test
