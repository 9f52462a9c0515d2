#include "diagnosis/verdict/cause_shares.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

namespace hybridtest {

namespace {

/// Gap explained by the effects whose bits are set.
std::vector<double> explained_by_subset(const IdentificationProblem& problem, const std::vector<EffectSetting>& chosen,
                                        const PartProgress& progress) {
  const std::size_t subsets = std::size_t{1} << chosen.size();
  const double total = gap_energy(problem, fit_nothing(problem, false)).total;
  std::vector<double> explained(subsets, 0.0);
  fit_each(
      problem.workers, subsets - 1,
      [&](std::size_t position) {
        const std::size_t subset = position + 1;  // the first one is empty
        std::vector<EffectSetting> effects;
        for (std::size_t i = 0; i < chosen.size(); ++i) {
          if ((subset >> i & 1U) != 0) effects.push_back(chosen[i]);
        }
        explained[subset] = std::max(0.0, total - gap_energy(problem, refit_effects(problem, effects, false)).total);
      },
      [&](std::size_t done, std::size_t all) { progress.report("combinations of the causes", done, all); });
  return explained;
}

double factorial(int n) { return std::tgamma(n + 1.0); }

}  // namespace

std::vector<double> cause_shares(const IdentificationProblem& problem, const std::vector<EffectSetting>& chosen,
                                 const PartProgress& progress) {
  const auto n = static_cast<int>(chosen.size());
  std::vector<double> shares(chosen.size(), 1.0 / std::max(1, n));
  if (n < 2) return shares;
  const std::vector<double> explained = explained_by_subset(problem, chosen, progress);
  if (explained.back() <= 0.0) return shares;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    double value = 0.0;
    for (std::size_t subset = 0; subset < explained.size(); ++subset) {
      if ((subset >> i & 1U) != 0) continue;
      const int before = std::popcount(subset);
      value += factorial(before) * factorial(n - before - 1) / factorial(n) *
               (explained[subset | std::size_t{1} << i] - explained[subset]);
    }
    shares[i] = std::max(0.0, value);
  }
  const double sum = std::accumulate(shares.begin(), shares.end(), 0.0);
  for (double& share : shares) share = sum > 0.0 ? share / sum : 1.0 / n;
  return shares;
}

}  // namespace hybridtest
