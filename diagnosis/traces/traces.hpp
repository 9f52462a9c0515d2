#pragma once

#include <optional>
#include <span>
#include <vector>

#include "diagnosis/recording.hpp"
#include "plant/site_model.hpp"

namespace hybridtest {

/// An effect found directly in the recorded values; it needs no fit, and no fit could follow it sample by sample.
struct Trace {
  EffectSetting effect;
  Channel in{};              // the channel whose gap it causes
  double gap_share = 0.0;    // mean square of that gap over the channel's own, summed over recordings
  double probability = 1.0;  // less where another effect leaves the same
};

/// Whether find_traces() searches this kind of effect: a random one with a seed, or a coarse converter.
[[nodiscard]] bool shows_in_digits(const EffectType& effect) noexcept;

/// What the recordings of the role fit show of lost and late packets and of coarse converters, beyond what the model
/// has already. An effect in several recordings is listed once, with the values of the first one.
[[nodiscard]] std::vector<Trace> find_traces(const SiteModel& model, std::span<const Recording> recordings,
                                             std::size_t dof);

/// How late a clock that drifts makes each message, which is played at the next whole sample.
struct Lateness {
  double per_sample = 0.0;  // 0: no drift
  double at_start = 0.0;    // up to half [samples]

  [[nodiscard]] int at(double sample) const noexcept;
};

/// Delay of each target that a site received, in samples. With only the network in between, every received target
/// equals one that was sent.
struct NetworkLags {
  std::vector<int> lag;     // per sample; -1: not found, or at rest
  double found = 0.0;       // share of moving samples
  double shrinking = 0.0;   // share of found ones that follow a longer lag
  double unlike = 0.0;      // share of fresh targets with another lag than those before and behind, beside the drift
  double held = 0.0;        // share of moving samples that repeat the target before, without those of the drift
  double held_again = 0.0;  // and of those that repeat one that was a repetition already
  Lateness drift;           // of fresh targets; none that is not certainly more than one sample in all
  // What is left of the lags beside the drift.
  double mean = 0.0;  // samples
  int usual = 0;      // most frequent one of fresh targets [samples]
  int shortest = 0;   // that fresh targets have more than by chance; 0: none has [samples]

  /// Whether the received targets are the ones that were sent.
  [[nodiscard]] bool are_messages() const noexcept;
  /// Whether the lags go up and down; those of a delay or a drift do not.
  [[nodiscard]] bool fluctuate() const noexcept;
};

/// @param sent_m, received_m   of one length.
[[nodiscard]] NetworkLags lags_between(std::span<const double> sent_m, std::span<const double> received_m,
                                       double period_s);

/// The targets that a latency and a clock that drifts make late.
[[nodiscard]] std::vector<double> made_late(std::span<const double> sent_m, int latency, const Lateness& drift);

/// `jitter` or `loss`, if the lags fluctuate, and what all targets have besides: the `clock_drift` by which they come
/// later and later, and the `latency`, if it is a sample or more. Without jitter or loss, a drift whose lags
/// follow a straight line to within a sample, and become longer twice or more; a latency alone is left to a fit. With
/// loss, new targets are as late as the ones before and behind; with jitter they are not. A jitter of little more than
/// a sample period leaves most of them alike, too: messages that come too late look lost. But then the one behind a
/// late message is seldom late as well without showing the late one, so that two repetitions in a row are rare, and of
/// messages that are lost independently of each other they are not.
///
/// Of a jitter J, evenly spread, the newest message that has come is l samples old or less with the chance
/// 1 - (1 - T/J)(1 - 2T/J)...(1 - lT/J): J is the one with the recorded mean.
[[nodiscard]] std::vector<Trace> traces_of_network(std::span<const double> sent_m, std::span<const double> received_m,
                                                   double period_s);

/// The steps of a coarse converter in readings.
struct ReadingSteps {
  double step = 0.0;       // q; 0: none found
  double coherence = 0.0;  // 0 to 1; 1: all readings are multiples of the step plus an offset
};

/// The characteristic function of quantized readings repeats at 1 / q (Widrow and Kollar, Quantization Noise, 2008,
/// chapter 4): along the way of the signal, |mean exp(2 pi i y / q)| is exp(-2 (pi s / q)^2) for noise s that was added
/// behind the converter, and about q per way between reversals without one.
///
/// Steps between a sixth of the span and twice the white noise of the readings are looked for; of several that divide
/// each other the largest is meant. The readings have to be at multiples of the step along the way, and each for
/// itself.
/// @param values   finite.
[[nodiscard]] ReadingSteps steps_of_readings(std::span<const double> values);

/// The same of a test without time. It moves in equal steps by itself, and the force of a spring with it: they are the
/// converter's only where most successive readings are less than half a step apart.
[[nodiscard]] ReadingSteps steps_of_slow_readings(std::span<const double> values);

}  // namespace hybridtest
