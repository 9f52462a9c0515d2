#include "diagnosis/scoring/random_network.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "diagnosis/scoring/score.hpp"

namespace hybridtest {
namespace {

/// Latest arrival that is looked for.
constexpr double kLatest_s = 0.5;
/// Share of moving samples whose lag is found, above which the targets are those that were sent.
constexpr double kMostFound = 0.9;
/// Share of steps in which a lag shrinks, above which it fluctuates: a drift never goes back.
constexpr double kFluctuates = 0.002;
/// Share of fresh targets that are equally late when nothing but loss is at work.
constexpr double kEquallyLate = 0.97;

struct Lags {
  std::vector<int> lag;         // per sample; -1: not found, or at rest
  Eigen::VectorXd residual;     // of the lags, the baseline's where none was found
  double found = 0.0;           // share of moving samples
  double shrinking = 0.0;       // share of found ones that follow a longer lag
  double fresh_at_usual = 0.0;  // share of fresh targets with the most frequent lag
  double held = 0.0;            // share of moving samples that repeat the target before
  double mean = 0.0;            // samples
};

int lag_at(const Segment& segment, std::size_t i, std::size_t latest) {
  for (std::size_t lag = 0; lag <= std::min(i, latest); ++lag) {
    if (segment.measured[i] == segment.input[i - lag].displacement_m) return static_cast<int>(lag);
  }
  return -1;
}

Lags lags_of(const Segment& segment) {
  Lags lags;
  const auto latest = static_cast<std::size_t>(kLatest_s / segment.period_s);
  lags.residual = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(segment.measured.size()));
  std::map<int, double> fresh;
  double moving = 0.0;
  double found = 0.0;
  double shrinking = 0.0;
  double fresh_count = 0.0;
  int before = -1;
  for (std::size_t i = 1; i < segment.measured.size(); ++i) {
    const bool moves = segment.input[i].displacement_m != segment.input[i - 1].displacement_m;
    const int lag = moves ? lag_at(segment, i, latest) : -1;
    lags.lag.push_back(lag);
    if (lag < 0) lags.residual[static_cast<Eigen::Index>(i)] = segment.measured[i] - segment.input[i].displacement_m;
    if (!moves) continue;
    moving += 1.0;
    const bool is_held = segment.measured[i] == segment.measured[i - 1];
    lags.held += is_held ? 1.0 : 0.0;
    if (lag >= 0) {
      found += 1.0;
      lags.mean += lag;
      if (before >= 0 && lag < before) shrinking += 1.0;
      if (!is_held) {
        fresh[lag] += 1.0;
        fresh_count += 1.0;
      }
    }
    before = lag;
  }
  if (moving == 0.0 || found == 0.0 || fresh_count == 0.0) return lags;
  lags.found = found / moving;
  lags.shrinking = shrinking / found;
  lags.held /= moving;
  lags.mean /= found;
  for (const auto& [lag, count] : fresh) lags.fresh_at_usual = std::max(lags.fresh_at_usual, count / fresh_count);
  return lags;
}

void put_residual(const FitSegment& fit, const Lags& lags, SegmentResult& result) {
  const Eigen::VectorXd residual = fit.average({lags.residual.data(), static_cast<std::size_t>(lags.residual.size())});
  result.touched = true;
  result.mean_square = residual.squaredNorm() / static_cast<double>(residual.size());
  result.change = fit.measured - fit.baseline - residual;
  for (std::size_t b = 0; b + 1 < fit.block_begins.size(); ++b) {
    result.held_out_squares[b] =
        residual.segment(fit.block_begins[b], fit.block_begins[b + 1] - fit.block_begins[b]).squaredNorm();
  }
}

}  // namespace

bool is_random(const EffectType& effect) {
  return std::ranges::any_of(effect.parameters,
                             [](const EffectParameter& parameter) { return parameter.name == "seed"; });
}

std::optional<Candidate> fit_random_network(const IdentificationProblem& problem, const FitOutcome& baseline) {
  std::optional<Candidate> candidate;
  for (std::size_t i = 0; i < problem.segments.size(); ++i) {
    const FitSegment& fit = problem.segments[i];
    if (fit.segment.from != Channel::sent_displacement || fit.segment.to != Channel::target_displacement) continue;
    const Lags lags = lags_of(fit.segment);
    if (lags.found < kMostFound || lags.shrinking < kFluctuates) continue;
    if (!candidate) {
      const bool is_loss = lags.fresh_at_usual > kEquallyLate;
      const EffectType* const type = find_effect(EffectInterface::network, is_loss ? "loss" : "jitter");
      if (type == nullptr) return {};
      // Even lateness up to J is J / 2 on average.
      const double value = is_loss ? lags.held : 2.0 * lags.mean * fit.segment.period_s;
      EffectSetting setting{.type = type, .values = {}};
      for (const EffectParameter& parameter : type->parameters) {
        setting.values.push_back(parameter.name == "seed" ? parameter.fallback : value);
      }
      candidate = Candidate{.type = type, .fit = baseline};
      candidate->fit.effects = {setting};
      candidate->fit.parameters.emplace_back();
      for (const double number : setting.values) candidate->fit.parameters.back().push_back({.value = number});
    }
    put_residual(fit, lags, candidate->fit.segments[i]);
  }
  if (candidate) candidate->score = held_out_score(problem, candidate->fit);
  return candidate;
}

}  // namespace hybridtest
