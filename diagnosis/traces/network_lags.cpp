#include "diagnosis/traces/network_lags.hpp"

#include <algorithm>
#include <cmath>
#include <map>

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

int lag_at(std::span<const double> sent_m, double received_m, std::size_t i, std::size_t latest) {
  for (std::size_t lag = 0; lag <= std::min(i, latest); ++lag) {
    if (received_m == sent_m[i - lag]) return static_cast<int>(lag);
  }
  return -1;
}

/// Mean square of what was received less what was sent, over that of what was received.
double gap_share(std::span<const double> sent_m, std::span<const double> received_m) {
  double gap = 0.0;
  double all = 0.0;
  for (std::size_t i = 0; i < received_m.size(); ++i) {
    gap += std::pow(received_m[i] - sent_m[i], 2);
    all += std::pow(received_m[i], 2);
  }
  return all > 0.0 ? gap / all : 0.0;
}

}  // namespace

bool NetworkLags::fluctuate() const noexcept { return found >= kMostFound && shrinking >= kFluctuates; }

NetworkLags lags_between(std::span<const double> sent_m, std::span<const double> received_m, double period_s) {
  NetworkLags lags;
  const auto latest = static_cast<std::size_t>(kLatest_s / period_s);
  lags.lag.assign(received_m.size(), -1);
  std::map<int, double> fresh;
  double moving = 0.0;
  double found = 0.0;
  double shrinking = 0.0;
  double fresh_count = 0.0;
  int before = -1;
  for (std::size_t i = 1; i < received_m.size(); ++i) {
    if (sent_m[i] == sent_m[i - 1]) {
      before = -1;
      continue;
    }
    const int lag = lags.lag[i] = lag_at(sent_m, received_m[i], i, latest);
    moving += 1.0;
    const bool is_held = received_m[i] == received_m[i - 1];
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

std::optional<Trace> trace_of_network(std::span<const double> sent_m, std::span<const double> received_m,
                                      double period_s) {
  const NetworkLags lags = lags_between(sent_m, received_m, period_s);
  if (!lags.fluctuate()) return {};
  const bool is_loss = lags.fresh_at_usual > kEquallyLate;
  const EffectType* const type =
      find_effect(EffectInterface::network, is_loss ? DigitTrace::loss : DigitTrace::lateness);
  if (type == nullptr) return {};
  // Even lateness up to J is J / 2 on average.
  const double value = is_loss ? lags.held : 2.0 * lags.mean * period_s;
  Trace trace{.effect = {.type = type, .values = {}}, .in = Channel::target_displacement};
  for (const EffectParameter& parameter : type->parameters) {
    trace.effect.values.push_back(std::isnan(parameter.fallback) ? value : parameter.fallback);
  }
  trace.gap_share = gap_share(sent_m, received_m);
  return trace;
}

}  // namespace hybridtest
