// Cost of one step of a structure from matrices: the elastic force K u and the step of the integrator, over that of
// the sparse work that the method consists of, by Eigen alone: products with K and C, and solutions with
// M/dt^2 + C/2dt. Measured in one run for frames of 1 to 10 000 degrees of freedom with Rayleigh damping.
//
// The two take turns in short rounds, so that other work on the machine affects all of them alike. The result is
// the median over the rounds. Exit code 1 when an integrator takes more than 1.3 times as long at a size from 10 on.
// Below, a step takes a fraction of a microsecond, of which the sparse work is a small part.

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "coordinator/integrators/alpha_operator_splitting.hpp"
#include "coordinator/integrators/central_difference.hpp"
#include "coordinator/integrators/explicit_newmark.hpp"
#include "coordinator/integrators/generalised_alpha.hpp"
#include "coordinator/integrators/implicit_newmark.hpp"
#include "coordinator/integrators/kr_alpha.hpp"
#include "coordinator/integrators/rosenbrock_w.hpp"
#include "mechanics/structure/damping.hpp"

namespace {

using namespace hybridtest;
using SparseMatrix = Eigen::SparseMatrix<double>;

constexpr double kStep_s = 0.001;
constexpr double kRatioMax = 1.3;
constexpr int kDofsJudged = 10;
constexpr int kTurns = 400;
constexpr int kDofStepsPerTurn = 20'000;  // a turn takes as long for each size

/// Floors of `width` frames side by side: columns from floor to floor, slabs from frame to frame.
LinearStructure frame(int floors, int width) {
  constexpr double kStorey_n_per_m = 4.0e7;
  constexpr double kSlab_n_per_m = 4.0e8;
  const int size = floors * width;
  std::vector<Eigen::Triplet<double>> entries;
  const auto connect = [&](int upper, int lower, double stiffness_n_per_m) {
    entries.emplace_back(upper, upper, stiffness_n_per_m);
    if (lower < 0) return;
    entries.emplace_back(lower, lower, stiffness_n_per_m);
    entries.emplace_back(upper, lower, -stiffness_n_per_m);
    entries.emplace_back(lower, upper, -stiffness_n_per_m);
  };
  for (int dof = 0; dof < size; ++dof) {
    connect(dof, dof - width, kStorey_n_per_m);
    if (dof % width > 0) connect(dof, dof - 1, kSlab_n_per_m);
  }
  LinearStructure structure;
  structure.mass_kg = SparseMatrix(size, size);
  structure.mass_kg.setIdentity();
  structure.mass_kg *= 4.0e3;
  structure.stiffness_n_per_m = SparseMatrix(size, size);
  structure.stiffness_n_per_m.setFromTriplets(entries.begin(), entries.end());
  structure.initial_stiffness_n_per_m = structure.stiffness_n_per_m;
  structure.influence = Eigen::VectorXd::Ones(size);
  structure.damping_n_s_per_m = rayleigh_damping(structure, {.mass_per_s = 0.1, .stiffness_s = 1.0e-4});
  return structure;
}

struct StepKind {
  std::string name;
  std::function<double()> step;
  std::vector<double> us_per_step;
};

/// One step after the other under a constant load.
StepKind with_integrator(std::string name, const LinearStructure& structure, std::shared_ptr<Integrator> integrator) {
  const auto size = structure.size();
  return {std::move(name),
          [integrator, stiffness = structure.stiffness_n_per_m, restoring_n = Eigen::VectorXd{size},
           applied_n = Eigen::VectorXd::Constant(size, 4.0e3).eval()]() mutable {
            restoring_n.setZero();
            restoring_n.noalias() += stiffness * integrator->current().displacement_m;
            integrator->advance(restoring_n, applied_n);
            return integrator->current().displacement_m[0];
          },
          {}};
}

/// The sparse work of a step of the method: products with matrices of the pattern of K, the elastic force among them,
/// products with those of the pattern of C, and solutions.
struct SparseWork {
  int products_k = 1;
  int products_c = 1;
  int solutions = 1;
  int commands = 1;  // in a step of the method
};

StepKind with_eigen(const LinearStructure& structure, SparseWork work) {
  const SparseMatrix effective =
      structure.mass_kg / (kStep_s * kStep_s) + structure.damping_n_s_per_m / (2.0 * kStep_s);
  const auto factor = std::make_shared<Eigen::SimplicialLDLT<SparseMatrix>>(effective);
  return {"Eigen alone",
          [factor, work, stiffness = structure.stiffness_n_per_m, damping = structure.damping_n_s_per_m,
           force_n = Eigen::VectorXd{structure.size()}, solution_m = Eigen::VectorXd{structure.size()},
           motion = Eigen::VectorXd::Constant(structure.size(), 1.0e-3).eval()]() mutable {
            force_n.setZero();
            for (int i = 0; i < work.products_k; ++i) force_n.noalias() += stiffness * motion;
            for (int i = 0; i < work.products_c; ++i) force_n.noalias() += damping * motion;
            for (int i = 0; i < work.solutions; ++i) solution_m = factor->solve(force_n);
            return solution_m[0];
          },
          {}};
}

struct Method {
  std::string name;
  SparseWork work;
  std::function<std::shared_ptr<Integrator>(const LinearStructure&)> make;
};

template <class Integration, class... Parameters>
std::function<std::shared_ptr<Integrator>(const LinearStructure&)> maker(Parameters... parameters) {
  return [parameters...](const LinearStructure& structure) {
    return std::make_shared<Integration>(parameters..., structure, kStep_s);
  };
}

/// The products are those of the equations in the headers; products with the diagonal mass count as vector work.
const std::vector<Method>& methods() {
  static const std::vector<Method> table{
      {"central_difference", {1, 1}, maker<CentralDifference>()},
      {"explicit_newmark", {1, 1}, maker<ExplicitNewmark>()},
      {"cr", {1, 2}, maker<KrAlpha>(KrAlpha::Parameters{.rho_inf = 1.0})},
      {"kr_alpha", {2, 2}, maker<KrAlpha>(KrAlpha::Parameters{})},
      {"alpha_operator_splitting", {1, 1}, maker<AlphaOperatorSplitting>(AlphaOperatorSplitting::Parameters{})},
      {"generalised_alpha", {8, 3, 4, 3}, maker<GeneralisedAlpha>(GeneralisedAlpha::Parameters{})},
      // Linear and under a constant load it needs one trial.
      {"implicit_newmark", {2, 3, 3, 2}, maker<ImplicitNewmark>(ImplicitNewmark::Parameters{})},
      {"rosenbrock_w", {4, 2, 2, 2}, maker<RosenbrockW>()},
  };
  return table;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void take_turn(StepKind& kind, int steps, double& sink) {
  const auto begin = std::chrono::steady_clock::now();
  for (int step = 0; step < steps; ++step) sink += kind.step();
  const std::chrono::duration<double, std::micro> spent = std::chrono::steady_clock::now() - begin;
  kind.us_per_step.push_back(spent.count() / steps);
}

}  // namespace

int main() {
  double sink = 0.0;
  double worst = 0.0;
  std::printf("%8s  %-26s %12s %12s %8s\n", "dofs", "", "us a step", "Eigen alone", "ratio");
  for (const auto& [floors, width] : {std::pair{1, 1}, {2, 1}, {5, 1}, {5, 2}, {10, 10}, {40, 25}, {100, 100}}) {
    const LinearStructure structure = frame(floors, width);
    const int steps = std::max(1, kDofStepsPerTurn / (floors * width));
    for (const Method& method : methods()) {
      StepKind bare = with_eigen(structure, method.work);
      StepKind ours = with_integrator(method.name, structure, method.make(structure));
      for (int turn = 0; turn < kTurns; ++turn) {
        take_turn(bare, std::max(1, steps / method.work.commands), sink);
        take_turn(ours, steps, sink);
      }
      const double bare_us = median(bare.us_per_step) / method.work.commands;
      const double us = median(ours.us_per_step);
      std::printf("%8d  %-26s %12.3f %12.3f %8.2f\n", floors * width, ours.name.c_str(), us, bare_us, us / bare_us);
      if (floors * width >= kDofsJudged) worst = std::max(worst, us / bare_us);
    }
  }
  std::printf("largest ratio from %d on %.2f, at most %.1f is asked (checksum %.6g)\n", kDofsJudged, worst, kRatioMax,
              sink);
  return worst <= kRatioMax && std::isfinite(sink) ? 0 : 1;
}
