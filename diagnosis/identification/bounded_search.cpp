#include "diagnosis/identification/bounded_search.hpp"

#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <limits>

#include "core/config_error.hpp"
#include "diagnosis/tuning.hpp"

namespace hybridtest {
namespace {

/// Step of the numeric derivatives: what the smoothest effects need is smaller, but a clearance or a friction
/// has to move over several samples to be felt.
constexpr double kDifferenceStep = 1e-3;

/// Instants are looked for so much more densely, and then by halving steps down to that share of the record.
constexpr int kDenser = 6;
constexpr double kFirstStep = 1e-2;
constexpr double kLastStep = 1e-5;

class ProjectedResidual final : public ceres::CostFunction {
 public:
  ProjectedResidual(const VariableProjection& projection, Eigen::Index searched) : projection_{projection} {
    set_num_residuals(static_cast<int>(projection.rows()));
    mutable_parameter_block_sizes()->push_back(static_cast<std::int32_t>(searched));
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override try {
    const Eigen::Index searched = parameter_block_sizes()[0];
    const Eigen::VectorXd places = Eigen::Map<const Eigen::VectorXd>{parameters[0], searched};
    const Eigen::VectorXd residual = projection_.solve(places).residual;
    if (!residual.allFinite()) return false;
    Eigen::Map<Eigen::VectorXd>{residuals, residual.size()} = residual;
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> jacobian{
        jacobians[0], residual.size(), searched};
    if (searched == 1) {
      jacobian.col(0) = slope(places, 0, residual);
    } else {
      for (Eigen::Index i = 0; i < searched; ++i) jacobian.col(i) = slope(places, i, residual);
    }
    return jacobian.allFinite();
  } catch (const ConfigError&) {
    return false;
  }

 private:
  [[nodiscard]] Eigen::VectorXd slope(const Eigen::VectorXd& places, Eigen::Index i,
                                      const Eigen::VectorXd& residual) const {
    Eigen::VectorXd moved = places;
    const double step = places[i] < 0.5 ? kDifferenceStep : -kDifferenceStep;
    moved[i] += step;
    return (projection_.solve(moved).residual - residual) / step;
  }

  const VariableProjection& projection_;
};

struct Start {
  Eigen::VectorXd places;
  double cost = std::numeric_limits<double>::infinity();
};

double cost_at(const VariableProjection& projection, const Eigen::VectorXd& places) try {
  const double cost = projection.solve(places).residual.squaredNorm();
  return std::isfinite(cost) ? cost : std::numeric_limits<double>::infinity();
} catch (const ConfigError&) {
  return std::numeric_limits<double>::infinity();
}

Eigen::VectorXd halton(int index, Eigen::Index dimensions) {
  constexpr std::array<int, 8> kPrimes{2, 3, 5, 7, 11, 13, 17, 19};
  Eigen::VectorXd point(dimensions);
  for (Eigen::Index i = 0; i < dimensions; ++i) {
    const int base = kPrimes[static_cast<std::size_t>(i) % kPrimes.size()];
    double value = 0.0;
    double share = 1.0;
    for (int rest = index + 1; rest > 0; rest /= base) {
      share /= base;
      value += share * (rest % base);
    }
    point[i] = value;
  }
  return point;
}

Start refine(const VariableProjection& projection, const Start& start) {
  Eigen::VectorXd places = start.places;
  ceres::Problem problem;
  problem.AddResidualBlock(new ProjectedResidual{projection, places.size()}, nullptr, places.data());  // NOLINT: owned
  for (int i = 0; i < static_cast<int>(places.size()); ++i) {
    problem.SetParameterLowerBound(places.data(), i, 0.0);
    problem.SetParameterUpperBound(places.data(), i, 1.0);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.max_num_iterations = tuning::kSearchIterations;
  options.function_tolerance = tuning::kSearchTolerance;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  const double cost = cost_at(projection, places);
  return cost < start.cost ? Start{places, cost} : start;
}

/// The nearer an instant is to the right one, the less of the record it gets wrong.
Start settle_instants(const VariableProjection& projection, Start best) {
  const std::vector<SearchedParameter>& searched = projection.plan().searched;
  const auto improves = [&](Eigen::Index i, double step) {
    Start moved = best;
    moved.places[i] = std::clamp(moved.places[i] + step, 0.0, 1.0);
    moved.cost = cost_at(projection, moved.places);
    if (!(moved.cost < best.cost)) return false;
    best = std::move(moved);
    return true;
  };
  for (Eigen::Index i = 0; i < best.places.size(); ++i) {
    if (!searched[static_cast<std::size_t>(i)].is_instant) continue;
    for (double step = kFirstStep; step > kLastStep; step *= 0.5) {
      if (!improves(i, step)) improves(i, -step);
    }
  }
  return best;
}

}  // namespace

int starts_for(Eigen::Index searched) noexcept {
  constexpr std::array<int, 4> kStarts{0, 7, 12, 18};
  return kStarts[static_cast<std::size_t>(std::min<Eigen::Index>(searched, 3))];
}

Eigen::VectorXd search_best(const VariableProjection& projection, const Eigen::VectorXd& first, int starts) {
  const auto searched = static_cast<Eigen::Index>(projection.plan().searched.size());
  if (searched == 0) return Eigen::VectorXd{};
  const bool has_instant = std::ranges::any_of(projection.plan().searched, &SearchedParameter::is_instant);
  if (has_instant) starts *= kDenser;
  std::vector<Start> tried;
  if (first.size() == searched) tried.push_back({first, cost_at(projection, first)});
  for (int i = 0; i < starts; ++i) {
    const Eigen::VectorXd places = halton(i, searched);
    tried.push_back({places, cost_at(projection, places)});
  }
  std::ranges::stable_sort(tried, {}, &Start::cost);
  Start best = tried.front();
  const std::size_t refined = std::min<std::size_t>(tried.size(), tuning::kRefinedStarts);
  for (std::size_t i = 0; i < refined; ++i) {
    const Start found = settle_instants(projection, refine(projection, settle_instants(projection, tried[i])));
    if (found.cost < best.cost) best = found;
  }
  return best.places;
}

}  // namespace hybridtest
