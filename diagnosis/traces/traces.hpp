#pragma once

#include <optional>
#include <span>
#include <vector>

#include "diagnosis/recording.hpp"
#include "plant/site_model.hpp"

namespace hybridtest {

/// An effect that shows in the digits of a recording: no fit can follow it, sample by sample, and none is needed.
struct Trace {
  EffectSetting effect;
  Channel in{};            // whose gap it makes
  double gap_share = 0.0;  // mean square of that gap over the channel's own, summed over recordings
};

/// Of a kind that find_traces() looks for: it draws its course from a seed, or coarsens readings.
[[nodiscard]] bool shows_in_digits(const EffectType& effect) noexcept;

/// What the recordings of the role fit show of lost and late packets and of coarse converters, beyond what the model
/// has already. An effect that several show is listed once, as the first one shows it.
[[nodiscard]] std::vector<Trace> find_traces(const SiteModel& model, std::span<const Recording> recordings,
                                             std::size_t dof);

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

/// What a coarse converter left in readings.
struct ReadingSteps {
  double step = 0.0;       // q; 0: none found
  double coherence = 0.0;  // 0 to 1: how far readings keep to multiples of it, up to an offset; 1: all do
};

/// The characteristic function of quantized readings repeats at 1 / q (Widrow and Kollar, Quantization Noise, 2008,
/// chapter 4): along the way of the signal, |mean exp(2 pi i y / q)| is exp(-2 (pi s / q)^2) for noise s that was added
/// behind the converter, and about q per way between reversals without one.
///
/// Steps between a sixth of the span and twice the white noise of the readings are looked for; of several that divide
/// each other the largest is meant.
/// @param values   finite.
[[nodiscard]] ReadingSteps steps_of_readings(std::span<const double> values);

}  // namespace hybridtest
