#pragma once

#include <Eigen/Core>
#include <vector>

#include "diagnosis/identification/search.hpp"

namespace hybridtest {

/// The linearisation at the optimum from which fitted and held-out residuals are computed.
struct Linearisation {
  Eigen::MatrixXd columns;        // change of the prediction per searched, linear, nuisance parameter
  std::vector<std::size_t> free;  // of them, those not held at a bound
  // Positions in `columns` of the parameters that can be fitted without a block; an instant lies in one block only.
  std::vector<Eigen::Index> held_out_with;
};

/// By numeric derivatives of the searched parameters.
[[nodiscard]] Linearisation linearise(const VariableProjection& projection, const Eigen::VectorXd& places,
                                      const Projected& solution);

/// Normal equations that can be solved where columns are multiples of each other.
[[nodiscard]] Eigen::MatrixXd regularised(Eigen::MatrixXd normal);

}  // namespace hybridtest
