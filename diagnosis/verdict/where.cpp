#include "diagnosis/verdict/where.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "core/random.hpp"
#include "diagnosis/tuning.hpp"

namespace hybridtest {
namespace {

constexpr std::size_t kInterfaces = 7;
constexpr int kShareResamples = 200;
using Shares = std::array<double, kInterfaces>;

/// The interface that a segment's gap is put down to.
EffectInterface blamed(const Segment& segment, const FitOutcome& chosen) {
  for (const EffectSetting& effect : chosen.effects) {
    if (segment.touched_by(*effect.type)) return effect.type->interface;
  }
  return segment.interface;
}

/// Energy above the floor of the blocks that `pick` draws, relative to the output's; suspect segments alone.
template <class Pick>
Shares shares_of(const IdentificationProblem& problem, const FitOutcome& baseline, const FitOutcome& chosen,
                 Pick&& pick) {
  Shares shares{};
  double sum = 0.0;
  for (std::size_t i = 0; i < problem.segments.size(); ++i) {
    const FitSegment& fit = problem.segments[i];
    const double output = fit.measured.squaredNorm() / static_cast<double>(fit.measured.size());
    if (output <= 0.0 || !fit.is_suspect) continue;
    const std::vector<double>& squares = baseline.segments[i].held_out_squares;
    double energy = 0.0;
    double samples = 0.0;
    for (std::size_t b = 0; b < squares.size(); ++b) {
      const std::size_t drawn = pick(b, squares.size());
      energy += squares[drawn];
      samples += static_cast<double>(fit.block_begins[drawn + 1] - fit.block_begins[drawn]);
    }
    const double excess = std::max(0.0, energy / samples - fit.floor * fit.floor) / output;
    shares[static_cast<std::size_t>(blamed(fit.segment, chosen))] += excess;
    sum += excess;
  }
  if (sum > 0.0) {
    for (double& share : shares) share /= sum;
  }
  return shares;
}

/// 95 % of what resampled blocks give.
std::array<report::Interval, kInterfaces> intervals(const IdentificationProblem& problem, const FitOutcome& baseline,
                                                    const FitOutcome& chosen, std::uint64_t seed) {
  Random random{seed};
  std::array<std::vector<double>, kInterfaces> drawn;
  for (int i = 0; i < kShareResamples; ++i) {
    const Shares shares =
        shares_of(problem, baseline, chosen, [&](std::size_t, std::size_t blocks) { return random.below(blocks); });
    for (std::size_t k = 0; k < kInterfaces; ++k) drawn[k].push_back(shares[k]);
  }
  std::array<report::Interval, kInterfaces> result;
  for (std::size_t k = 0; k < kInterfaces; ++k) {
    std::ranges::sort(drawn[k]);
    result[k] = {drawn[k][kShareResamples / 40], drawn[k][kShareResamples - 1 - kShareResamples / 40]};
  }
  return result;
}

}  // namespace

std::vector<report::InterfaceGap> locate(const IdentificationProblem& problem, const FitOutcome& baseline,
                                         const FitOutcome& chosen, std::uint64_t seed) {
  const Shares shares = shares_of(problem, baseline, chosen, [](std::size_t block, std::size_t) { return block; });
  const std::array<report::Interval, kInterfaces> ci95 = intervals(problem, baseline, chosen, seed);
  std::array<report::InterfaceGap, kInterfaces> gaps;
  std::array<double, kInterfaces> squares{};
  std::array<double, kInterfaces> floors{};
  std::array<double, kInterfaces> judged{};
  const auto add = [&](EffectInterface interface, const FitSegment& fit, const std::vector<double>& predicted) {
    const auto k = static_cast<std::size_t>(interface);
    const auto size = static_cast<Eigen::Index>(fit.segment.measured.size());
    const Eigen::Map<const Eigen::VectorXd> measured{fit.segment.measured.data(), size};
    const Eigen::Map<const Eigen::VectorXd> model{predicted.data(), size};
    const double output = measured.squaredNorm();
    if (output <= 0.0) return;
    squares[k] += (measured - model).squaredNorm() / output;
    floors[k] += fit.sample_floor * fit.sample_floor * static_cast<double>(size) / output;
    judged[k] += 1.0;
  };
  for (const FitSegment& fit : problem.segments) {
    const EffectInterface at = blamed(fit.segment, chosen);
    add(at, fit, predict(problem.model, fit.segment));
    // The stage itself is judged with what was found of its neighbour.
    if (at != fit.segment.interface)
      add(fit.segment.interface, fit, predict(problem.model, fit.segment, chosen.effects));
  }
  std::vector<report::InterfaceGap> where;
  for (std::size_t k = 0; k < kInterfaces; ++k) {
    if (judged[k] == 0.0) continue;
    report::InterfaceGap gap;
    gap.interface = name_of(static_cast<EffectInterface>(k));
    gap.is_judged = true;
    gap.share = shares[k];
    gap.share_ci95 = ci95[k];
    gap.nrmse = std::sqrt(squares[k] / judged[k]);
    gap.floor_nrmse = std::sqrt(floors[k] / judged[k]);
    gap.is_at_fault = gap.nrmse > tuning::kFaultOverFloor * gap.floor_nrmse + tuning::kModelAllowance;
    where.push_back(std::move(gap));
  }
  std::ranges::stable_sort(where, std::greater{}, &report::InterfaceGap::share);
  return where;
}

}  // namespace hybridtest
