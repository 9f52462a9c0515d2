#include "diagnosis/identification/linearisation.hpp"

#include <limits>

#include "diagnosis/tuning.hpp"

namespace hybridtest {

Linearisation linearise(const VariableProjection& projection, const Eigen::VectorXd& places,
                        const Projected& solution) {
  const auto searched = places.size();
  const std::vector<SearchedParameter>& parameters = projection.plan().searched;
  Linearisation result;
  result.columns.resize(projection.rows(), searched + solution.columns.cols());
  const Eigen::VectorXd& coefficients = solution.coefficients;
  const Eigen::VectorXd here = searched > 0 ? projection.predicted(places, coefficients) : Eigen::VectorXd{};
  projection.workers().for_each(static_cast<std::size_t>(searched), [&](std::size_t parameter) {
    const auto i = static_cast<Eigen::Index>(parameter);
    result.columns.col(i) = projection.slope(places, coefficients, i, here);
  });
  for (Eigen::Index i = 0; i < searched; ++i) {
    const SearchedParameter& parameter = parameters[static_cast<std::size_t>(i)];
    const bool at_bound = parameter.is_low_end(places[i]) || parameter.is_high_end(places[i]);
    if (!at_bound) result.free.push_back(static_cast<std::size_t>(i));
  }
  result.columns.rightCols(solution.columns.cols()) = solution.columns;
  const std::vector<LinearParameter>& linear = projection.plan().linear;
  for (std::size_t i = 0; i < solution.held.size(); ++i) {
    // Nothing left of what the model has is as uncertain as a little of it.
    const bool is_of_model = i < linear.size() && linear[i].is_of_model;
    if (!solution.held[i] || is_of_model) result.free.push_back(static_cast<std::size_t>(searched) + i);
  }
  for (std::size_t i = 0; i < result.free.size(); ++i) {
    const bool is_instant = result.free[i] < parameters.size() && parameters[result.free[i]].is_instant;
    if (!is_instant) result.held_out_with.push_back(static_cast<Eigen::Index>(i));
  }
  result.columns = Eigen::MatrixXd{result.columns(Eigen::all, result.free)};
  return result;
}

Eigen::MatrixXd regularised(Eigen::MatrixXd normal) {
  normal.diagonal() *= 1.0 + tuning::kCovarianceRidge;
  normal.diagonal().array() += std::numeric_limits<double>::min();
  return normal;
}

}  // namespace hybridtest
