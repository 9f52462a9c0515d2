#include "diagnosis/localisation/floor.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "diagnosis/signals/signals.hpp"
#include "diagnosis/tuning.hpp"

namespace hybridtest {
namespace {

/// Variance of the difference of two stretches of one signal, `lag` apart.
double difference_variance(std::span<const double> values, std::size_t lag) {
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t i = lag; i < values.size(); ++i) {
    const double difference = values[i] - values[i - lag];
    sum += difference * difference;
    ++count;
  }
  return count > 0 ? sum / static_cast<double>(count) : 0.0;
}

/// Samples whose input, and its neighbourhood, was the same `lag` samples before.
std::vector<std::size_t> repeated(std::span<const double> input_m, std::size_t lag, double tolerance_m) {
  std::vector<std::size_t> samples;
  for (std::size_t i = lag; i < input_m.size(); ++i) {
    if (std::abs(input_m[i] - input_m[i - lag]) <= tolerance_m) samples.push_back(i);
  }
  return samples;
}

/// Mean square of what a line over the input leaves, of as many degrees of freedom.
double variance_beside_line(std::span<const double> input_m, std::span<const double> residual) {
  const auto count = static_cast<double>(residual.size());
  const double mean_m = std::accumulate(input_m.begin(), input_m.end(), 0.0) / count;
  double product = 0.0;
  for (std::size_t i = 0; i < residual.size(); ++i) product += (input_m[i] - mean_m) * residual[i] / count;
  const double spread = variance(input_m);
  const double by_line = spread > 0.0 ? product * product / spread : 0.0;
  return (variance(residual) - by_line) * count / (count - 2.0);
}

/// The lag of whole cycles at which the input repeats best; 0 if there are no cycles.
std::size_t best_lag(std::span<const double> input_m) {
  const std::vector<Reversal> turns = reversals_of(input_m, tuning::kCycleThreshold * reversal_threshold_m(input_m));
  if (turns.size() < tuning::kCycleReversalsMin) return 0;
  const double cycles = 0.5 * static_cast<double>(turns.size() - 1);
  const auto rough = static_cast<double>(turns.back().sample - turns.front().sample) / cycles;
  const auto from = static_cast<std::size_t>(std::max(2.0, (1.0 - tuning::kCycleSpread) * rough));
  const auto to = static_cast<std::size_t>((1.0 + tuning::kCycleSpread) * rough) + 1;
  std::size_t best = 0;
  double least = 0.0;
  for (std::size_t lag = from; lag <= to && 2 * lag < input_m.size(); ++lag) {
    const double here = difference_variance(input_m, lag);
    if (best == 0 || here < least) {
      best = lag;
      least = here;
    }
  }
  return best;
}

}  // namespace

std::string_view name_of(FloorSource source) noexcept {
  switch (source) {
    case FloorSource::repeated_recordings: return "repeated recordings";
    case FloorSource::repeated_cycles: return "repeated cycles";
    case FloorSource::rest: return "rest";
    case FloorSource::high_frequencies: return "high frequencies";
  }
  return "";
}

std::optional<RepeatabilityFloor> floor_of_repetition(const GapSignals& first, const GapSignals& second) {
  const std::size_t size = std::min(first.size(), second.size());
  if (size == 0 || first.period_s != second.period_s) return {};
  std::vector<double> inputs(size);
  std::vector<double> residuals(size);
  for (std::size_t i = 0; i < size; ++i) {
    inputs[i] = first.input_m[i] - second.input_m[i];
    residuals[i] = first.residual[i] - second.residual[i];
  }
  const double span = variance(first.input_m.first(size));
  if (!(span > 0.0) || variance(inputs) > tuning::kSameInput * tuning::kSameInput * span) return {};
  return RepeatabilityFloor{std::sqrt(0.5 * mean_square(residuals)), FloorSource::repeated_recordings};
}

std::optional<RepeatabilityFloor> floor_of_cycles(const GapSignals& signals) {
  const std::size_t lag = best_lag(signals.input_m);
  if (lag == 0) return {};
  const auto same = repeated(signals.input_m, lag, tuning::kSameCycle * 0.5 * span_of(signals.input_m));
  if (2 * same.size() < signals.size()) return {};
  double sum = 0.0;
  for (const std::size_t i : same) {
    const double difference = signals.residual[i] - signals.residual[i - lag];
    sum += difference * difference;
  }
  return RepeatabilityFloor{std::sqrt(0.5 * sum / static_cast<double>(same.size())), FloorSource::repeated_cycles};
}

std::optional<RepeatabilityFloor> floor_at_rest(const GapSignals& signals) {
  double squares = 0.0;
  std::size_t count = 0;
  const std::vector<RestStretch> stretches = rest_stretches(signals.input_m, signals.period_s);
  for (std::size_t i = 0; i < stretches.size();) {
    // Those that follow each other are one: slow noise moves little in a short one.
    RestStretch rest = stretches[i];
    while (++i < stretches.size() && stretches[i].begin == rest.begin + rest.count) rest.count += stretches[i].count;
    squares += variance(signals.residual.subspan(rest.begin, rest.count)) * static_cast<double>(rest.count);
    count += rest.count - 1;
  }
  if (count == 0) return {};
  return RepeatabilityFloor{std::sqrt(squares / static_cast<double>(count)), FloorSource::rest};
}

std::optional<double> noise_while_still(const GapSignals& signals) {
  std::vector<double> variances;
  for (const RestStretch& still : rest_stretches(signals.input_m, signals.period_s, std::sqrt(tuning::kHardlyLeft))) {
    if (still.count <= 2) return {};
    variances.push_back(variance_beside_line(signals.input_m.subspan(still.begin, still.count),
                                             signals.residual.subspan(still.begin, still.count)));
  }
  if (variances.size() < tuning::kSpectrumAverages) return {};
  return std::sqrt(upper_median(std::move(variances)));
}

RepeatabilityFloor floor_of_high_frequencies(const GapSignals& signals) {
  double sum = 0.0;
  for (std::size_t i = 2; i < signals.size(); ++i) {
    const double second = signals.residual[i] - 2.0 * signals.residual[i - 1] + signals.residual[i - 2];
    sum += second * second;
  }
  // White noise of variance s has second differences of variance 6 s.
  const auto count =
      static_cast<double>(std::max<std::size_t>(1, signals.size() - std::min<std::size_t>(2, signals.size())));
  return {std::sqrt(sum / (6.0 * count)), FloorSource::high_frequencies};
}

RepeatabilityFloor repeatability_floor(const GapSignals& signals) {
  if (const auto cycles = floor_of_cycles(signals)) return *cycles;
  const RepeatabilityFloor fast = floor_of_high_frequencies(signals);
  const auto rest = floor_at_rest(signals);
  return rest && rest->rms > fast.rms ? *rest : fast;
}

}  // namespace hybridtest
