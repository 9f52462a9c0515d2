#pragma once

#include <optional>
#include <span>
#include <vector>

#include "diagnosis/traces/trace.hpp"

namespace hybridtest {

/// How late each target was that a site received, in samples: where nothing but the network lies between, every one
/// equals one that was sent.
struct NetworkLags {
  std::vector<int> lag;         // per sample; -1: not found, or at rest
  double found = 0.0;           // share of moving samples
  double shrinking = 0.0;       // share of found ones that follow a longer lag
  double fresh_at_usual = 0.0;  // share of fresh targets with the most frequent lag
  double held = 0.0;            // share of moving samples that repeat the target before
  double mean = 0.0;            // samples

  /// They go up and down, which a delay or a drift does not.
  [[nodiscard]] bool fluctuate() const noexcept;
};

/// @param sent_m, received_m   of one length.
[[nodiscard]] NetworkLags lags_between(std::span<const double> sent_m, std::span<const double> received_m,
                                       double period_s);

/// `jitter` or `loss`, where the lags fluctuate. With loss, what arrives fresh is always equally late; with jitter it
/// is not.
[[nodiscard]] std::optional<Trace> trace_of_network(std::span<const double> sent_m, std::span<const double> received_m,
                                                    double period_s);

}  // namespace hybridtest
