#include "diagnosis/traces/traces.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <unsupported/Eigen/FFT>
#include <vector>

#include "diagnosis/signals/signals.hpp"
#include "diagnosis/tuning.hpp"

namespace hybridtest {

namespace {

int lag_at(std::span<const double> sent_m, double received_m, std::size_t i, std::size_t latest) {
  for (std::size_t lag = 0; lag <= std::min(i, latest); ++lag) {
    if (received_m == sent_m[i - lag]) return static_cast<int>(lag);
  }
  return -1;
}

/// Mean square of received minus sent values, over that of the received values.
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

bool NetworkLags::are_messages() const noexcept { return found >= tuning::kLagsFoundMin; }

bool NetworkLags::fluctuate() const noexcept { return are_messages() && shrinking >= tuning::kLagsShrinkingMin; }

namespace {

/// A target that has not been received before.
struct Fresh {
  double sample = 0.0;
  int lag = 0;
  bool is_only_one = true;  // the one sent before it is another one
};

/// Share of those that are not as late as the one before.
double share_of_changes(std::span<const Fresh> fresh) {
  double changes = 0.0;
  for (std::size_t i = 1; i < fresh.size(); ++i) changes += fresh[i].lag != fresh[i - 1].lag ? 1.0 : 0.0;
  return changes / static_cast<double>(fresh.size());
}

/// How late they come, as a straight line.
struct Line {
  double slope = 0.0;                                               // samples per sample
  double at_zero = 0.0;                                             // samples
  double span = 0.0;                                                // samples
  double standard_error = std::numeric_limits<double>::infinity();  // of the slope

  [[nodiscard]] double at(double sample) const noexcept { return at_zero + slope * sample; }
  [[nodiscard]] bool rises_by_more_than(double lag) const noexcept {
    return (slope - tuning::kTwoSided95 * standard_error) * span > lag;
  }
};

/// By least squares, of two at least.
Line line_of(std::span<const Fresh> fresh) {
  const auto n = static_cast<Eigen::Index>(fresh.size());
  if (n < 2) return {};
  Eigen::ArrayXd sample(n);
  Eigen::ArrayXd lag(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    sample[i] = fresh[static_cast<std::size_t>(i)].sample;
    lag[i] = fresh[static_cast<std::size_t>(i)].lag;
  }
  Line line{.span = sample[n - 1] - sample[0]};
  const double middle = sample.mean();
  const double mean = lag.mean();
  sample -= middle;
  lag -= mean;
  const double squares = sample.square().sum();
  line.slope = (sample * lag).sum() / squares;
  line.at_zero = mean - line.slope * middle;
  if (n < 3) return line;
  line.standard_error = std::sqrt((lag - line.slope * sample).square().sum() / static_cast<double>(n - 2) / squares);
  return line;
}

/// A clock that drifts makes them later in either half of the recording. 0 where that is not certain, or where it is
/// not certainly more than a sample in all.
double slope_in_either_half(std::span<const Fresh> fresh) {
  const Line line = line_of(fresh);
  const std::size_t half = fresh.size() / 2;
  const bool is_steady =
      line_of(fresh.first(half)).rises_by_more_than(0.0) && line_of(fresh.subspan(half)).rises_by_more_than(0.0);
  return is_steady && line.rises_by_more_than(1.0) ? line.slope : 0.0;
}

/// Successive targets of the same lag.
struct Tread {
  double first = 0.0;  // samples
  double last = 0.0;
  int lag = 0;
};

/// The stairs of lags that never become shorter; none of others. A value that was sent twice is found with the shorter
/// lag.
std::vector<Tread> treads_of(std::span<const Fresh> fresh) {
  std::vector<Tread> treads;
  double shorter = 0.0;
  for (const Fresh& one : fresh) {
    if (!one.is_only_one) continue;
    if (!treads.empty() && one.lag < treads.back().lag) {
      shorter += 1.0;
      continue;
    }
    if (treads.empty() || one.lag > treads.back().lag) {
      treads.push_back({one.sample, one.sample, one.lag});
    }
    treads.back().last = one.sample;
  }
  if (shorter > tuning::kLagsShrinkingMin * static_cast<double>(fresh.size())) treads.clear();
  return treads;
}

/// The straight line through the instants at which the lags become longer, of a clock that drifts steadily. None where
/// that is less than twice, or where the line leaves the stairs by more than a sample: then another way is longer.
std::optional<Lateness> line_through(std::span<const Tread> treads) {
  if (treads.size() < 3) return std::nullopt;
  std::vector<Fresh> longer;
  for (const Tread& tread : treads.subspan(1)) longer.push_back({.sample = tread.first, .lag = tread.lag - 1});
  const Line line = line_of(longer);
  const bool is_near = std::ranges::all_of(treads, [&](const Tread& tread) {
    return line.at(tread.first) > tread.lag - 2 && line.at(tread.last) < tread.lag + 1;
  });
  if (!is_near) return std::nullopt;
  return Lateness{.per_sample = line.slope, .at_start = line.at_zero - std::max(0.0, std::round(line.at_zero))};
}

}  // namespace

int Lateness::at(double sample) const noexcept { return static_cast<int>(std::ceil(at_start + per_sample * sample)); }

NetworkLags lags_between(std::span<const double> sent_m, std::span<const double> received_m, double period_s) {
  NetworkLags lags;
  const auto latest = static_cast<std::size_t>(tuning::kArrivalLagMax_s / period_s);
  lags.lag.assign(received_m.size(), -1);
  std::vector<Fresh> fresh;
  double moving = 0.0;
  double found = 0.0;
  double shrinking = 0.0;
  int before = -1;
  bool was_held = false;
  for (std::size_t i = 1; i < received_m.size(); ++i) {
    if (sent_m[i] == sent_m[i - 1]) {
      before = -1;
      was_held = false;
      continue;
    }
    const int lag = lags.lag[i] = lag_at(sent_m, received_m[i], i, latest);
    moving += 1.0;
    const bool is_held = received_m[i] == received_m[i - 1];
    lags.held += is_held ? 1.0 : 0.0;
    lags.held_again += is_held && was_held ? 1.0 : 0.0;
    was_held = is_held;
    if (lag >= 0) {
      found += 1.0;
      if (before >= 0 && lag < before) shrinking += 1.0;
      if (!is_held) {
        const std::size_t sent = i - static_cast<std::size_t>(lag);
        fresh.push_back({static_cast<double>(i), lag, sent == 0 || sent_m[sent] != sent_m[sent - 1]});
      }
    }
    before = lag;
  }
  if (moving == 0.0 || found == 0.0 || fresh.empty()) return lags;
  lags.found = found / moving;
  lags.shrinking = shrinking / found;
  const auto line = lags.are_messages() ? line_through(treads_of(fresh)) : std::nullopt;
  if (line) {
    lags.drift = *line;
  } else if (lags.fluctuate()) {
    lags.drift.per_sample = slope_in_either_half(fresh);
  }
  lags.unlike = 0.5 * std::max(0.0, share_of_changes(fresh) - lags.drift.per_sample);
  lags.held = std::max(0.0, lags.held / moving - lags.drift.per_sample);
  lags.held_again /= moving;
  for (std::size_t i = 0; i < lags.lag.size(); ++i) {
    if (lags.lag[i] >= 0) lags.mean += (lags.lag[i] - lags.drift.at(static_cast<double>(i))) / found;
  }
  std::map<int, double> shares;
  for (const Fresh& one : fresh) {
    shares[std::max(0, one.lag - lags.drift.at(one.sample))] += 1.0 / static_cast<double>(fresh.size());
  }
  lags.usual = std::ranges::max_element(shares, {}, &std::pair<const int, double>::second)->first;
  const auto shortest =
      std::ranges::find_if(shares, [](const auto& entry) { return entry.second > tuning::kLagsShrinkingMin; });
  if (shortest != shares.end()) lags.shortest = shortest->first;
  return lags;
}

namespace {

/// Mean age of the newest message that has come, of a delay spread evenly up to `jitter` [all in samples].
double mean_age(double jitter) {
  double mean = 0.0;
  double is_older = 1.0;
  for (double age = 1.0; is_older > 0.0; age += 1.0) {
    mean += is_older;
    is_older *= std::max(0.0, 1.0 - age / jitter);
  }
  return mean;
}

/// The jitter with this mean age [samples]; halving, to a thousandth of it. One of less than a sample does not show.
double jitter_of(double mean) {
  double low = 1.0;
  double high = 2.0;
  while (mean_age(high) < mean) high *= 2.0;
  while (high - low > tuning::kResolution * high) {
    const double middle = 0.5 * (low + high);
    (mean_age(middle) < mean ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// The value of the parameter that has to be given; the others are left out.
Trace network_trace(const EffectType& type, double value) {
  Trace trace{.effect = {.type = &type, .values = {}}, .in = Channel::target_displacement};
  for (const EffectParameter& parameter : type.parameters) {
    trace.effect.values.push_back(std::isnan(parameter.fallback) ? value : parameter.fallback);
  }
  return trace;
}

}  // namespace

std::vector<double> made_late(std::span<const double> sent_m, int latency, const Lateness& drift) {
  std::vector<double> late_m;
  for (std::size_t i = 0; i < sent_m.size(); ++i) {
    const int late = std::max(0, latency + drift.at(static_cast<double>(i)));
    late_m.push_back(sent_m[i - std::min(i, static_cast<std::size_t>(late))]);
  }
  return late_m;
}

namespace {

/// What makes lags go up and down, and the latency that all targets have beside it.
struct Fluctuation {
  DigitTrace shows = DigitTrace::loss;
  double value = 0.0;
  int latency = 0;  // samples
};

Fluctuation fluctuation_of(const NetworkLags& lags, double period_s) {
  const bool are_alike = 1.0 - lags.unlike > tuning::kEquallyLateMin;
  // Two late messages in a row: the first one shows, late. Two lost ones: neither does. Nearer to which?
  const double twice = lags.held * lags.held;
  const bool is_short_jitter = lags.unlike > 0.5 * twice && lags.held_again < 0.5 * twice;
  if (are_alike && !is_short_jitter) return {.value = lags.held, .latency = lags.usual};
  // A message that is late at all shows a sample later.
  const int latency = std::max(0, lags.shortest - 1);
  const double jitter = are_alike ? 1.0 / (1.0 - lags.held) : jitter_of(lags.mean - latency);
  return {.shows = DigitTrace::lateness, .value = jitter * period_s, .latency = latency};
}

}  // namespace

std::vector<Trace> traces_of_network(std::span<const double> sent_m, std::span<const double> received_m,
                                     double period_s) {
  const NetworkLags lags = lags_between(sent_m, received_m, period_s);
  const bool drifts = lags.drift.per_sample > 0.0;
  if (!lags.fluctuate() && !drifts) return {};
  const Fluctuation fluctuation =
      lags.fluctuate() ? fluctuation_of(lags, period_s) : Fluctuation{.latency = lags.usual};
  const int latency = fluctuation.latency;
  std::vector<Trace> traces;
  double left = gap_share(sent_m, received_m);
  // Each explains a part of what those before leave.
  const auto add = [&](const EffectType& type, double value, double leaves) {
    traces.push_back(network_trace(type, value));
    traces.back().gap_share = std::max(0.0, left - leaves);
    left = std::min(left, leaves);
  };
  const auto left_by = [&](const Lateness& drift) { return gap_share(made_late(sent_m, latency, drift), received_m); };
  if (latency > 0) {
    add(*find_effect(EffectInterface::network, "latency"), latency * period_s, left_by({}));
    traces.back().probability = 0.5;  // clocks that are off shift all targets alike
  }
  if (drifts) add(*find_effect(EffectInterface::network, "clock_drift"), lags.drift.per_sample, left_by(lags.drift));
  if (lags.fluctuate()) {
    add(*find_effect(EffectInterface::network, fluctuation.shows), fluctuation.value, 0.0);
    std::rotate(traces.begin(), traces.end() - 1, traces.end());
  }
  return traces;
}

namespace {

constexpr Eigen::Index kPadded = tuning::kStepPadding * tuning::kStepBins;

/// The smoothed distance between neighbouring samples: the weight of each reading.
std::vector<double> ways_of(std::span<const double> values, double period) {
  const LocalPolynomial polynomial{widest_faithful_half_width(values), period};
  std::vector<double> ways;
  ways.reserve(values.size());
  for (const Motion& motion : polynomial.motion(values)) ways.push_back(std::abs(motion.velocity_m_per_s) * period);
  return ways;
}

struct Readings {
  std::span<const double> values;
  std::vector<double> ways;
  double first = 0.0;  // the least value
  double span = 0.0;
  double way = 0.0;  // all of them

  /// As many as would make up the way in equal parts.
  [[nodiscard]] double samples_that_count() const {
    double squares = 0.0;
    for (const double part : ways) squares += part * part;
    return way * way / squares;
  }
  [[nodiscard]] double coherence(double steps_in_span) const { return coherence_of(ways, way, steps_in_span); }
  /// Each reading counts the same.
  [[nodiscard]] double coherence_of_readings(double steps_in_span) const {
    const std::vector<double> alike(values.size(), 1.0);
    return coherence_of(alike, static_cast<double>(values.size()), steps_in_span);
  }

 private:
  [[nodiscard]] double coherence_of(const std::vector<double>& weights, double sum_of_weights,
                                    double steps_in_span) const {
    std::complex<double> sum;
    for (std::size_t i = 0; i < values.size(); ++i) sum += std::polar(weights[i], phase(i, steps_in_span));
    return std::abs(sum) / sum_of_weights;
  }
  [[nodiscard]] double phase(std::size_t reading, double steps_in_span) const {
    return 2.0 * std::numbers::pi * steps_in_span * (values[reading] - first) / span;
  }
};

/// Coherence by quarters of a step in the span.
std::vector<double> coherences(const Readings& readings) {
  Eigen::VectorXd density = Eigen::VectorXd::Zero(kPadded);
  for (std::size_t i = 0; i < readings.values.size(); ++i) {
    const double place =
        (readings.values[i] - readings.first) / readings.span * static_cast<double>(tuning::kStepBins - 1);
    density[static_cast<Eigen::Index>(std::lround(place))] += readings.ways[i] / readings.way;
  }
  Eigen::FFT<double> transform;
  transform.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  Eigen::VectorXcd spectrum;
  transform.fwd(spectrum, density);
  std::vector<double> result(static_cast<std::size_t>(spectrum.size()));
  for (Eigen::Index i = 0; i < spectrum.size(); ++i) result[static_cast<std::size_t>(i)] = std::abs(spectrum[i]);
  return result;
}

/// The number of steps in the span, near `rough`, with the largest coherence (golden section).
double refined(const Readings& readings, double rough) {
  constexpr double kGolden = std::numbers::phi - 1.0;
  double low = rough - tuning::kStepReach;
  double high = rough + tuning::kStepReach;
  for (int i = 0; i < tuning::kStepSections; ++i) {
    const double left = high - kGolden * (high - low);
    const double right = low + kGolden * (high - low);
    if (readings.coherence(left) > readings.coherence(right)) {
      high = right;
    } else {
      low = left;
    }
  }
  return 0.5 * (low + high);
}

/// A converter so coarse that only a few of its steps are in the span is found by a part of its step, as readings at
/// whole steps are at halves of them too. Two steps, that is three levels, are the fewest that show a distance twice.
double whole_steps(const Readings& readings, double steps) {
  const double enough = tuning::kStepAsCoherent * readings.coherence(steps);
  for (double parts = std::floor(0.5 * steps); parts > 1.0; parts -= 1.0) {
    if (readings.coherence(steps / parts) >= enough) return steps / parts;
  }
  return steps;
}

}  // namespace

ReadingSteps steps_of_readings(std::span<const double> values) {
  if (values.size() < tuning::kStepSamplesMin) return {};
  const auto [low, high] = std::ranges::minmax_element(values);
  Readings readings{.values = values, .ways = ways_of(values, 1.0), .first = *low, .span = *high - *low};
  for (const double way : readings.ways) readings.way += way;
  if (!(readings.span > 0.0) || !(readings.way > 0.0)) return {};
  const double noise = white_noise_level(values);
  const double finest = std::min(
      tuning::kStepsPerBinMax * static_cast<double>(tuning::kStepBins),
      noise > 0.0 ? readings.span / (tuning::kStepOverNoise * noise) : std::numeric_limits<double>::infinity());
  const std::vector<double> found = coherences(readings);
  constexpr double kPerStep = static_cast<double>(kPadded) / static_cast<double>(tuning::kStepBins - 1);
  const auto place = [&](double steps) { return static_cast<std::size_t>(std::lround(steps * kPerStep)); };
  if (finest <= tuning::kStepsInSpanMin) return {};
  const auto begin = found.begin() + static_cast<std::ptrdiff_t>(place(tuning::kStepsInSpanMin));
  const auto end = found.begin() + static_cast<std::ptrdiff_t>(place(finest));
  if (begin >= end) return {};
  const auto best = std::max_element(begin, end);
  const auto coarsest =
      std::find_if(begin, end, [best](double coherence) { return coherence >= tuning::kStepAsCoherent * *best; });
  const auto peak = std::max_element(coarsest, std::min(end, coarsest + tuning::kStepPadding));
  const double rough = static_cast<double>(peak - found.begin()) / kPerStep;
  // The path from one reversal to the next contributes at most q / pi.
  const double reversals = 1.0 + static_cast<double>(reversals_of(values, reversal_threshold_m(values)).size());
  const double by_chance = reversals * readings.span / (std::numbers::pi * rough * readings.way);
  // A path of few samples, such as a spike, fits some step by chance: the largest of many random sums.
  const double tried = static_cast<double>(end - begin);
  const double by_few = std::sqrt(std::log(tried + 2.0) / readings.samples_that_count());
  if (*peak < std::max(tuning::kStepCoherenceMin, tuning::kStepOverChance * std::max(by_chance, by_few))) return {};
  const double steps = whole_steps(readings, refined(readings, rough));
  ReadingSteps result{.step = readings.span / steps, .coherence = readings.coherence(steps)};
  // Of a motion that sticks and jumps the jumps alone are the way, and where they end and begin may be so many equal
  // steps apart. The readings at rest between them are not.
  const double least = std::min(result.coherence, readings.coherence_of_readings(steps));
  return least < tuning::kStepCoherenceMin ? ReadingSteps{} : result;
}

ReadingSteps steps_of_slow_readings(std::span<const double> values) {
  const ReadingSteps steps = steps_of_readings(values);
  std::vector<double> apart;
  for (std::size_t i = 1; i < values.size(); ++i) apart.push_back(std::abs(values[i] - values[i - 1]));
  const bool is_of_protocol = steps.step > 0.0 && upper_median(std::move(apart)) > 0.5 * steps.step;
  return is_of_protocol ? ReadingSteps{} : steps;
}

namespace {

bool has(const SiteModel& model, const EffectType* type) {
  return std::ranges::any_of(model.effects, [type](const EffectSetting& effect) { return effect.type == type; });
}

/// Coarse steps of one sensor, unless they are too small to matter for a model.
std::optional<Trace> trace_of_sensor(EffectInterface sensor, const Recording& recording, Channel channel,
                                     const std::vector<double>& values) {
  const double step = (recording.is_quasi_static ? steps_of_slow_readings(values) : steps_of_readings(values)).step;
  const EffectType* const type = find_effect(sensor, DigitTrace::rounding);
  const double variance =
      step * step / 12.0;  // Widrow and Kollar (2008): of an even error between half a step each way
  const double all = mean_square(values);
  if (type == nullptr || !(variance > tuning::kModelAllowance * tuning::kModelAllowance * all)) return {};
  return Trace{.effect = {.type = type, .values = {step}}, .in = channel, .gap_share = variance / all};
}

std::vector<Trace> traces_of(const Recording& recording, const DofRecording& dof) {
  std::vector<Trace> traces;
  const auto add = [&](std::optional<Trace> trace) {
    if (trace) traces.push_back(std::move(*trace));
  };
  if (!recording.is_quasi_static && dof.has(Channel::sent_displacement) && dof.has(Channel::target_displacement)) {
    traces = traces_of_network(dof.of(Channel::sent_displacement), dof.of(Channel::target_displacement),
                               recording.sample_period_s);
  }
  add(trace_of_sensor(EffectInterface::displacement_sensor, recording, Channel::measured_displacement,
                      dof.of(Channel::measured_displacement)));
  add(trace_of_sensor(EffectInterface::force_sensor, recording, Channel::measured_force,
                      dof.of(Channel::measured_force)));
  return traces;
}

}  // namespace

bool shows_in_digits(const EffectType& effect) noexcept { return effect.traits.digits != DigitTrace::none; }

std::vector<Trace> find_traces(const SiteModel& model, std::span<const Recording> recordings, std::size_t dof) {
  std::vector<Trace> found;
  for (const Recording& recording : recordings) {
    if (recording.role != RecordingRole::fit || recording.dofs.size() <= dof) continue;
    for (Trace& trace : traces_of(recording, recording.dofs[dof])) {
      if (has(model, trace.effect.type)) continue;
      const auto known =
          std::ranges::find_if(found, [&](const Trace& other) { return other.effect.type == trace.effect.type; });
      if (known == found.end()) {
        found.push_back(std::move(trace));
      } else {
        known->gap_share += trace.gap_share;
      }
    }
  }
  return found;
}

}  // namespace hybridtest
