#include "diagnosis/identification/problem.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

#include "core/config_error.hpp"
#include "diagnosis/identification/coloured_noise.hpp"
#include "diagnosis/identification/discrepancy.hpp"
#include "diagnosis/identification/effect_fit.hpp"
#include "diagnosis/identification/noise_spectrum.hpp"
#include "diagnosis/identification/repetition.hpp"
#include "diagnosis/identification/search.hpp"
#include "diagnosis/identification/smoothing_choice.hpp"
#include "diagnosis/localisation/floor.hpp"
#include "diagnosis/localisation/gap_shares.hpp"
#include "diagnosis/signals/signals.hpp"
#include "diagnosis/tuning.hpp"
#include "plant/effects/recorded_input.hpp"

namespace hybridtest {

namespace {

double ratio_or_one(double numerator, double denominator) noexcept {
  return numerator > 0.0 && denominator > 0.0 ? numerator / denominator : 1.0;
}

}  // namespace

double SignalScales::of(ParameterScale scale) const noexcept {
  switch (scale) {
    case ParameterScale::displacement_m: return ratio_or_one(displacement_m, 1.0);
    case ParameterScale::velocity_m_per_s: return ratio_or_one(velocity_m_per_s, 1.0);
    case ParameterScale::force_n: return ratio_or_one(force_n, 1.0);
    case ParameterScale::stiffness_n_per_m: return ratio_or_one(force_n, displacement_m);
    case ParameterScale::damping_n_s_per_m: return ratio_or_one(force_n, velocity_m_per_s);
    case ParameterScale::damping_n_s2_per_m2: return ratio_or_one(force_n, velocity_m_per_s * velocity_m_per_s);
    case ParameterScale::stiffness_n_per_m3:
      return ratio_or_one(force_n, displacement_m * displacement_m * displacement_m);
    case ParameterScale::compliance_m_per_n: return ratio_or_one(displacement_m, force_n);
    case ParameterScale::energy_j: return ratio_or_one(force_n * displacement_m, 1.0);
    case ParameterScale::per_m: return ratio_or_one(1.0, displacement_m);
    case ParameterScale::s_per_m: return ratio_or_one(1.0, velocity_m_per_s);
    case ParameterScale::mass_kg: return ratio_or_one(force_n, acceleration_m_per_s2);
    case ParameterScale::duration_s: return ratio_or_one(duration_s, 1.0);
    case ParameterScale::one:
    case ParameterScale::time_s: break;
  }
  return 1.0;
}

SignalScales scales_of(std::span<const Segment> segments) {
  SignalScales scales;
  for (const Segment& segment : segments) {
    for (const Motion& motion : segment.input) {
      scales.displacement_m = std::max(scales.displacement_m, std::abs(motion.displacement_m));
      scales.velocity_m_per_s = std::max(scales.velocity_m_per_s, std::abs(motion.velocity_m_per_s));
      scales.acceleration_m_per_s2 = std::max(scales.acceleration_m_per_s2, std::abs(motion.acceleration_m_per_s2));
    }
    scales.duration_s = std::max(scales.duration_s, segment.period_s * static_cast<double>(segment.input.size()));
    if (segment.to != Channel::measured_force) continue;
    for (const double force_n : segment.measured) scales.force_n = std::max(scales.force_n, std::abs(force_n));
  }
  return scales;
}

namespace {

/// Where the effects of the model that follow this input are absent; nothing without any.
std::optional<double> reference_of(const SiteModel& model, std::string_view input) {
  for (const EffectSetting& effect : model.effects) {
    if (effect.type->input != input) continue;
    const auto reference = std::ranges::find(effect.type->parameters, kReferenceInput.name, &EffectParameter::name);
    if (reference == effect.type->parameters.end()) continue;  // a formula's force need not be absent anywhere
    return effect.values[static_cast<std::size_t>(reference - effect.type->parameters.begin())];
  }
  return {};
}

/// Marks the segments in which the input stays at its reference.
void mark_at_reference(const InputRange& input, std::vector<Segment>& segments) {
  for (Segment& segment : segments) {
    InputTable& inputs = segment.inputs;
    if (!inputs.has(input.name)) continue;
    const auto column = std::ranges::find(inputs.names, input.name) - inputs.names.begin();
    double farthest = 0.0;
    for (std::size_t i = 0; i < segment.input.size(); ++i) {
      farthest = std::max(farthest, std::abs(inputs.at(i)[column] - input.reference));
    }
    if (farthest <= tuning::kSameInput * input.span) inputs.at_reference.push_back(input.name);
  }
}

/// Moments of one input, each sample weighted by the energy of its force.
struct LoadedInput {
  double samples = 0.0;
  double energy = 0.0;
  double first = 0.0;   // of the distance from its reference
  double second = 0.0;  // of its square
};

void add_input(const Segment& segment, std::size_t column, InputRange& range, LoadedInput& loaded) {
  for (std::size_t i = 0; i < segment.measured.size(); ++i) {
    const double off = segment.inputs.at(i)[column] - range.reference;
    const double energy = segment.measured[i] * segment.measured[i];
    loaded.samples += 1.0;
    loaded.energy += energy;
    loaded.first += energy * off;
    loaded.second += energy * off * off;
    range.mean += (range.reference + off - range.mean) / loaded.samples;
    range.span = std::max(range.span, std::abs(off));
  }
}

}  // namespace

std::vector<InputRange> input_ranges_of(const SiteModel& model, std::span<const Segment> segments) {
  std::vector<InputRange> ranges;
  std::vector<LoadedInput> loaded;
  for (const Segment& segment : segments) {
    const InputTable& inputs = segment.inputs;
    for (std::size_t column = 0; column < inputs.names.size(); ++column) {
      auto range = std::ranges::find(ranges, inputs.names[column], &InputRange::name);
      if (range == ranges.end()) {
        range = ranges.insert(ranges.end(),
                              {.name = inputs.names[column],
                               .reference = reference_of(model, inputs.names[column]).value_or(inputs.values[column])});
        loaded.emplace_back();
      }
      add_input(segment, column, *range, loaded[static_cast<std::size_t>(range - ranges.begin())]);
    }
  }
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    // The cosine between what is proportional to the input and what is always there.
    const double along = loaded[i].first * loaded[i].first;
    ranges[i].varies = along < std::pow(tuning::kSameSignature, 2) * loaded[i].energy * loaded[i].second;
  }
  return ranges;
}

namespace {

using enum EffectInterface;

/// Longest time between two upward crossings of the mean; a held-out block must be longer.
double longest_cycle_s(const Segment& segment) {
  double mean_m = 0.0;
  for (const Motion& motion : segment.input) mean_m += motion.displacement_m;
  mean_m /= static_cast<double>(segment.input.size());
  std::size_t crossings = 0;
  for (std::size_t i = 1; i < segment.input.size(); ++i) {
    if (segment.input[i - 1].displacement_m < mean_m && segment.input[i].displacement_m >= mean_m) ++crossings;
  }
  return segment.period_s * static_cast<double>(segment.input.size()) / static_cast<double>(crossings + 1);
}

std::vector<Eigen::Index> blocks_of(const FitSegment& fit) {
  const double duration_s = fit.segment.period_s * static_cast<double>(fit.segment.input.size());
  const double blocks =
      std::clamp(std::floor(duration_s / longest_cycle_s(fit.segment)), tuning::kBlocksMin, tuning::kBlocksMax);
  std::vector<Eigen::Index> begins;
  for (double block = 0.0; block <= blocks; ++block) {
    begins.push_back(static_cast<Eigen::Index>(std::round(static_cast<double>(fit.measured.size()) * block / blocks)));
  }
  return begins;
}

double root_mean_square(const Eigen::VectorXd& values) {
  return std::sqrt(values.squaredNorm() / static_cast<double>(std::max<Eigen::Index>(1, values.size())));
}

void add_nuisance(FitSegment& fit, EffectInterface interface, ModelNumber number, const Eigen::VectorXd& column) {
  const EffectType* const type = find_effect(interface, number);
  if (type == nullptr || column.squaredNorm() == 0.0) return;
  fit.nuisance.conservativeResize(fit.measured.size(), fit.nuisance.cols() + 1);
  fit.nuisance.col(fit.nuisance.cols() - 1) = column;
  fit.nuisance_types.push_back(type);
}

/// Change of the prediction per unit of a wrong stiffness: of a spring beside another, or of the ratio of a law's.
Eigen::VectorXd stiffness_slope(const SiteModel& model, bool is_ratio, const FitSegment& fit,
                                const EffectType& stiffness) {
  const double step = is_ratio ? tuning::kResolution : 1.0;  // the latter's change is proportional to it
  const EffectSetting setting{.type = &stiffness, .values = {is_ratio ? step : 0.0, is_ratio ? 0.0 : step}};
  return (fit.average(predict(model, fit.segment, std::span{&setting, 1})) - fit.baseline) / step;
}

void add_nuisances(const SiteModel& model, bool law_has_strength, FitSegment& fit) {
  fit.nuisance.resize(fit.measured.size(), 0);
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(fit.measured.size());
  if (fit.segment.to == Channel::measured_force) {
    add_nuisance(fit, specimen, ModelNumber::stiffness,
                 stiffness_slope(model, law_has_strength, fit, *find_effect(specimen, ModelNumber::stiffness)));
    add_nuisance(fit, force_sensor, ModelNumber::offset, ones);
    return;
  }
  if (fit.segment.to != Channel::measured_displacement) return;
  const double period_s = fit.segment.period_s * static_cast<double>(fit.averaged);
  const Eigen::Index last = fit.baseline.size() - 1;
  Eigen::VectorXd later = Eigen::VectorXd::Zero(fit.baseline.size());
  for (Eigen::Index i = 1; i < last; ++i) later[i] = (fit.baseline[i - 1] - fit.baseline[i + 1]) / (2.0 * period_s);
  add_nuisance(fit, transfer_system, ModelNumber::gain, fit.baseline);
  add_nuisance(fit, transfer_system, ModelNumber::delay, later);
  add_nuisance(fit, displacement_sensor, ModelNumber::offset, ones);
}

void add_number_slope(const SiteModel& model, const EffectType* type, double step, FitSegment& fit) {
  if (type == nullptr || !fit.segment.touched_by(*type)) return;
  const EffectSetting setting{.type = type, .values = {step}};
  fit.number_slopes.conservativeResize(fit.measured.size(), fit.number_slopes.cols() + 1);
  fit.number_slopes.rightCols(1) =
      (fit.average(predict(model, fit.segment, std::span{&setting, 1})) - fit.baseline) / step;
  fit.number_types.push_back(type);
}

void add_number_slopes(const SiteModel& model, FitSegment& fit) {
  fit.number_slopes = fit.nuisance;
  fit.number_types = fit.nuisance_types;
  if (!fit.segment.is_quasi_static) add_number_slope(model, find_effect(specimen, ModelNumber::damping), 1.0, fit);
  if (model.has_bandwidth) {
    add_number_slope(model, find_effect(transfer_system, ModelNumber::bandwidth), tuning::kResolution, fit);
  }
}

/// The model with one of the effects that were found before moved; as it is where the effect would not accept that.
Eigen::VectorXd predict_with_moved(const SiteModel& model, const FitSegment& fit, std::size_t position,
                                   const Eigen::VectorXd& step) try {
  SiteModel moved = model;
  std::vector<double>& values = moved.effects[position].values;
  for (std::size_t i = 0; i < values.size(); ++i) values[i] += step[static_cast<Eigen::Index>(i)];
  return fit.average(predict(moved, fit.segment));
} catch (const ConfigError&) {
  return fit.baseline;
}

void add_found_changes(const SiteModel& model, std::span<const FoundEffect> found, FitSegment& fit) {
  Eigen::Index count = 0;
  for (const FoundEffect& one : found) count += one.covariance.cols();
  fit.found_changes = Eigen::MatrixXd::Zero(fit.measured.size(), count);
  Eigen::Index column = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Eigen::Index own = found[i].covariance.cols();
    if (fit.segment.touched_by(*found[i].effect.type)) {
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> parts{found[i].covariance};
      const Eigen::MatrixXd root = parts.eigenvectors() * parts.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
      for (Eigen::Index j = 0; j < own; ++j) {
        const Eigen::VectorXd step = tuning::kCoefficientStep * root.col(j);
        fit.found_changes.col(column + j) =
            (predict_with_moved(model, fit, model.effects.size() - found.size() + i, step) - fit.baseline) /
            tuning::kCoefficientStep;
      }
    }
    column += own;
  }
}

std::vector<double> predict_remembering(const SiteModel& model, FitSegment& fit) {
  if (!model.make_law || fit.segment.to != Channel::measured_force) return predict(model, fit.segment);
  const auto memory = std::make_shared<LawMemory>();
  SiteModel remembered = model;
  remembered.make_law = [&] { return remembering(model.make_law(), *memory); };
  std::vector<double> predicted = predict(remembered, fit.segment);
  fit.law = memory;
  return predicted;
}

/// The displacements that it starts from, averaged.
Eigen::VectorXd places_m(const FitSegment& fit) {
  std::vector<double> displacement(fit.segment.input.size());
  std::ranges::transform(fit.segment.input, displacement.begin(), &Motion::displacement_m);
  return fit.average(displacement);
}

/// Median of the mean squares of groups of samples, corrected for what the median of so few draws lies below the mean
/// (Wilson and Hilferty, 1931).
double median_energy(const Eigen::VectorXd& values, const std::vector<std::size_t>& group, std::size_t groups,
                     double independent) {
  std::vector<double> squares(groups, 0.0);
  std::vector<double> counts(groups, 0.0);
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    const std::size_t at = group[static_cast<std::size_t>(i)];
    squares[at] += values[i] * values[i];
    counts[at] += 1.0;
  }
  std::vector<double> means;
  for (std::size_t i = 0; i < groups; ++i) {
    if (counts[i] > 0.0) means.push_back(squares[i] / counts[i]);
  }
  if (means.empty()) return 0.0;
  std::ranges::sort(means);
  const double median = 0.5 * (means[(means.size() - 1) / 2] + means[means.size() / 2]);
  const double draws = std::max(1.0, independent / static_cast<double>(means.size()));
  return median / std::pow(1.0 - 2.0 / (9.0 * draws), 3);
}

/// A remainder as the gap at an input, which outlives the signals.
GapSignals signals_of(const FitSegment& fit, const Eigen::VectorXd& input_m, const Eigen::VectorXd& remainder) {
  const auto span_of = [](const Eigen::VectorXd& values) {
    return std::span{values.data(), static_cast<std::size_t>(values.size())};
  };
  const double period_s = fit.segment.period_s * static_cast<double>(fit.averaged);
  return {period_s, span_of(input_m), span_of(fit.measured), span_of(remainder)};
}

/// Noise by the spectrum; of smoothed signals at the rate up to which smoothing leaves them: above it hardly any noise
/// is left.
std::optional<double> noise_by_spectrum_of(const FitSegment& fit, const GapSignals& signals) {
  const auto stride =
      static_cast<std::size_t>(std::ceil(2.0 * fit.segment.smoothed_by / static_cast<double>(fit.averaged)));
  if (stride < 2) return noise_by_spectrum(signals.measured, signals.residual, signals.period_s);
  return noise_by_spectrum(every_nth(signals.measured, stride), every_nth(signals.residual, stride),
                           signals.period_s * static_cast<double>(stride));
}

/// Root mean square of the noise in a remainder. Noise is as large in every phase of the motion and all the time; a
/// part of the specimen that the features do not hold is not. So the typical group of samples counts: by place and
/// direction of the motion, and by time.
/// @param place_m   see places_m().
double noise_level(const FitSegment& fit, const Eigen::VectorXd& place_m, const Eigen::VectorXd& remainder,
                   double independent) {
  constexpr std::size_t kGroups = tuning::kNoiseGroups;
  const auto size = static_cast<std::size_t>(remainder.size());
  std::vector<std::size_t> order(size);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return place_m[static_cast<Eigen::Index>(i)]; });
  std::vector<std::size_t> phase(size);
  for (std::size_t rank = 0; rank < size; ++rank) {
    const auto i = static_cast<Eigen::Index>(order[rank]);
    const bool rises = place_m[std::min(i + 1, place_m.size() - 1)] > place_m[std::max<Eigen::Index>(i - 1, 0)];
    phase[order[rank]] = rank * (kGroups / 2) / size + (rises ? kGroups / 2 : 0);
  }
  std::vector<std::size_t> time(size);
  for (std::size_t i = 0; i < size; ++i) time[i] = i * kGroups / size;
  const double typical = std::min(median_energy(remainder, phase, kGroups, independent),
                                  median_energy(remainder, time, kGroups, independent));
  double level = std::min(
      {root_mean_square(remainder), std::sqrt(typical), tuning::kNoiseShareMax * root_mean_square(fit.measured)});
  // Where cycles repeat, what does not repeat is seen.
  const GapSignals signals = signals_of(fit, place_m, remainder);
  if (const auto cycles = floor_of_cycles(signals)) level = std::min(level, cycles->rms);
  if (const auto fast = noise_by_spectrum_of(fit, signals)) level = std::min(level, *fast);
  // Noise is there at rest as well. Jumps of a friction that passes from place to place look like noise, and are not.
  const Eigen::VectorXd& told_m = fit.command_m.size() > 0 ? fit.command_m : place_m;
  if (const auto rest = floor_at_rest(signals_of(fit, told_m, remainder))) {
    level = std::min(level, tuning::kNearFloor * rest->rms);
  }
  return level;
}

/// Share of a remainder of the displacement that the force goes with [variance, a lower limit]: that much is a motion
/// that does not follow from the command, and the specimen answers it; noise of the readings it does not. By the
/// coherence, so a spring, a damper and a mass answer alike. Hum that both channels have in common counts as motion.
double share_answered(const Eigen::VectorXd& displacement, const Eigen::VectorXd& force, double period_s) {
  const auto size = static_cast<std::size_t>(displacement.size());
  if (force.size() != displacement.size() || size < tuning::kSamplesMin) return 0.0;
  const Spectra spectra = welch({displacement.data(), size}, {force.data(), size}, period_s, welch_segment(size));
  const double by_chance = 1.0 / static_cast<double>(spectra.averages);
  double answered = 0.0;
  double all = 0.0;
  for (std::size_t i = 0; i < spectra.input.size(); ++i) {
    answered += spectra.input[i] * (spectra.coherence(i) - by_chance) / (1.0 - by_chance);
    all += spectra.input[i];
  }
  return all > 0.0 && by_chance < 1.0 ? std::clamp(answered / all, 0.0, 1.0) : 0.0;
}

/// Without the straight line in time that makes up most of it, if one does: the zero of a transducer and its drift are
/// no noise, and nothing would seem independent beside them.
Eigen::VectorXd without_zero(const Eigen::VectorXd& values) {
  Eigen::MatrixX2d line{values.size(), 2};
  line.col(0).setOnes();
  line.col(1).setLinSpaced(-1.0, 1.0);
  Eigen::VectorXd rest = values - line * line.colPivHouseholderQr().solve(values);
  return rest.squaredNorm() < (1.0 - tuning::kMainShare) * values.squaredNorm() ? rest : values;
}

ChannelFloor channel_floor(const FitSegment& fit, const InputErrors& errors) {
  const double independent = std::max(1.0, static_cast<double>(fit.averaged) / fit.segment.noise_span);
  const double of_input =
      input_floor(errors, [&](std::span<const double> values) { return root_mean_square(fit.average(values)); });
  return {.of_means = noise_floor_of_means(fit.segment, of_input, independent),
          .per_sample = noise_floor(fit.segment, errors),
          .of_smoothing = fit.segment.smoothing_error};
}

/// Beside what takes the place of something in the model, which may have made more of the noise of its input, or have
/// had corners that smoothing cuts off.
ChannelFloor channel_floor_beside(const SiteModel& model, std::span<const EffectSetting> effects,
                                  const FitSegment& fit) {
  if (!take_place_in(model, effects) || !fit.segment.touched_by(effects)) return fit.channels;
  const ChannelFloor beside = channel_floor(fit, input_errors(model, fit.segment, effects));
  const double of_smoothing = smoothing_error_beside(model, effects, fit.segment);
  const auto least = [&](double own, double others) {
    const double less = std::pow(others, 2) + std::pow(of_smoothing, 2) - std::pow(beside.of_smoothing, 2);
    return std::min(own, std::sqrt(std::max(0.0, less)));
  };
  return {.of_means = least(fit.channels.of_means, beside.of_means),
          .per_sample = least(fit.channels.per_sample, beside.per_sample),
          .of_smoothing = std::min(fit.channels.of_smoothing, of_smoothing)};
}

/// Takes floor, weight and number of independent samples from what no function of the motion explains of a residual.
/// @param place_m         see places_m().
/// @param form_is_right   of the model that leaves it, with what was found.
/// @param repetition      see repetition_floors().
void take_noise(FitSegment& fit, const ChannelFloor& channels, const Eigen::VectorXd& left,
                const Eigen::VectorXd& place_m, bool form_is_right, double repetition) {
  const Eigen::VectorXd residual = without_zero(left);
  const ResidualParts parts = fit.discrepancy->parts(residual);
  // Beside a gap that repeats, the remainder may be a part of it that the features do not hold.
  // Points of a test without time have the noise of readings that follow each other. What a law leaves of them beside
  // that is the specimen's history, which features of the motion hold badly, and no noise.
  const bool is_noise = !fit.segment.is_quasi_static && parts.repeatable < parts.total - parts.repeatable;
  const double independent = independent_samples(parts.remainder);
  const double period_s = fit.segment.period_s * static_cast<double>(fit.averaged);
  double deviation = 0.0;
  std::optional<double> still;
  if (is_noise) {
    deviation = noise_level(fit, place_m, parts.remainder, independent);
    still = noise_while_still(signals_of(fit, place_m, parts.remainder));
  } else if (fit.segment.is_quasi_static) {
    still = noise_of_neighbours(parts.remainder);
    deviation = still.value_or(0.0);
  }
  // Noise does not wait for the motion, as what a form misses does; of slow noise a short stretch shows a part.
  if (!form_is_right && still) deviation = std::min(deviation, tuning::kNearFloor * *still);
  deviation *= std::sqrt(1.0 - share_answered(parts.remainder, fit.answering_force, period_s));
  // What a repetition of the test does otherwise is no gap, though it follows the motion in each.
  deviation = std::max(deviation, repetition);
  const double averaged_away = std::max(0.0, std::pow(channels.per_sample, 2) - std::pow(channels.of_means, 2));
  const auto floor_with = [&](double noise) {
    // What smoothing does to the prediction is no noise and comes on top.
    const double told = std::max(channels.of_means, std::hypot(noise, channels.of_smoothing));
    // All noise is left: where less is, the model makes less of the noise of its input than the one at hand would.
    return std::min(told, root_mean_square(residual));
  };
  fit.floor = floor_with(deviation);
  fit.sample_floor = std::sqrt(std::pow(fit.floor, 2) + averaged_away);
  fit.still_floor = still ? fit.sample_floor : std::sqrt(std::pow(floor_with(repetition), 2) + averaged_away);
  const double allowance = tuning::kModelAllowance * root_mean_square(fit.measured);
  fit.weight = 1.0 / std::max(std::hypot(fit.floor, allowance), std::numeric_limits<double>::min());
  fit.independent = independent;
}

/// What is left is that of the effects found.
/// @param channels_of   the floor of a segment that its channels show.
template <class ChannelsOf>
void take_noise(IdentificationProblem& problem, std::span<const EffectSetting> found,
                const std::vector<Eigen::VectorXd>& left, ChannelsOf&& channels_of) {
  std::vector<FitSegment>& fits = problem.segments;
  std::vector<Eigen::VectorXd> places;
  for (const FitSegment& fit : fits) places.push_back(places_m(fit));
  std::vector<GapSignals> signals;
  for (std::size_t i = 0; i < fits.size(); ++i) signals.push_back(signals_of(fits[i], places[i], left[i]));
  const std::vector<double> repetition = repetition_floors(fits, signals);
  problem.workers.for_each(fits.size(), [&](std::size_t i) {
    take_noise(fits[i], channels_of(fits[i]), left[i], places[i], are_numbers(found), repetition[i]);
  });
}

ChannelFloor as_in_model(const FitSegment& fit) { return fit.channels; }

/// The model that makes a force of the noise of its input. A spring that is far off makes as much more or less of it
/// than the specimen does, so it is as stiff as the recording shows.
SiteModel model_of_noise(const IdentificationProblem& problem, const FitSegment& fit) {
  SiteModel model = problem.model;
  if (!problem.law_is_spring || fit.segment.to != Channel::measured_force) return model;
  const Eigen::VectorXd by_model = fit.baseline.array() - fit.baseline.mean();
  const double ratio = by_model.dot(fit.measured) / by_model.squaredNorm();
  if (!(ratio > 0.0) || !std::isfinite(ratio) || std::abs(1.0 / ratio - 1.0) <= tuning::kSlightlyWrong) return model;
  const EffectType* const stiffness = find_effect(EffectInterface::specimen, ModelNumber::stiffness);
  EffectSetting as_recorded = absent(*stiffness);
  as_recorded.values.front() = ratio - 1.0;
  add_effect(model, as_recorded);
  return model;
}

FitSegment prepare(const IdentificationProblem& problem, Segment segment, std::span<const FoundEffect> found) {
  const SiteModel& model = problem.model;
  FitSegment fit;
  fit.segment = std::move(segment);
  fit.averaged = std::max<std::size_t>(
      1, static_cast<std::size_t>(std::floor(1.0 / (tuning::kFitRate_hz * fit.segment.period_s))));
  fit.measured = fit.average(fit.segment.measured);
  fit.baseline = fit.average(predict_remembering(model, fit));
  const InputErrors errors = input_errors(model_of_noise(problem, fit), fit.segment);
  fit.channels = channel_floor(fit, errors);
  std::vector<std::vector<double>> wrong{errors.of_noise, errors.of_window, fit.segment.smoothing_errors};
  if (!problem.law_is_spring) wrong.push_back(change_by_smoothing(model, fit.segment));
  for (const std::vector<double>& values : wrong) {
    if (!values.empty()) fit.input_errors.push_back(fit.average(values));
  }
  // What a coarse converter has wrong follows from the motion, and has no other sign.
  if (!errors.of_noise.empty() && !(fit.segment.input_step > 0.0)) {
    // A draw is another noise than that in the recording; what is told is that itself, and is taken off.
    const std::vector<Motion>& told = fit.segment.told_noise;
    fit.noisy = std::make_shared<const NoisySegments>(
        told.empty() ? NoisySegments{with_noise(fit.segment, fit.segment.noise, 0.5),
                                     with_noise(fit.segment, fit.segment.noise, -0.5)}
                     : NoisySegments{fit.segment, with_noise(fit.segment, told, -1.0)});
    fit.noise_of_input = noise_of_input(problem, fit, {});
  }
  fit.block_begins = blocks_of(fit);
  add_nuisances(model, problem.law_has_strength, fit);
  add_number_slopes(model, fit);
  add_found_changes(model, found, fit);
  fit.discrepancy = std::make_shared<Discrepancy>(fit);
  return fit;
}

/// A floor is an estimate: a small excess does not count as a gap beside a clear one.
bool is_clear(const FitSegment& fit) {
  return root_mean_square(fit.measured - fit.baseline) > tuning::kNearFloor / fit.weight;
}

/// Beside a measured displacement the force that answers it; what of it follows from the command is taken off.
/// Beside a measured force the displacement that was commanded.
void relate_channels(const std::vector<FitSegment>& segments, FitSegment& fit) {
  if (fit.segment.is_quasi_static) return;
  const bool is_force = fit.segment.to == Channel::measured_force;
  if (!is_force && fit.segment.to != Channel::measured_displacement) return;
  const Channel its = is_force ? Channel::measured_displacement : Channel::measured_force;
  const auto other = std::ranges::find_if(segments, [&](const FitSegment& one) {
    return one.segment.recording == fit.segment.recording && one.segment.to == its &&
           one.measured.size() == fit.measured.size();
  });
  if (other == segments.end()) return;
  if (is_force) {
    fit.command_m = places_m(*other);
  } else {
    fit.answering_force = fit.discrepancy->parts(other->measured).remainder;
  }
}

void mark_suspects(std::vector<FitSegment>& segments) {
  if (std::ranges::none_of(segments, is_clear)) return;
  for (FitSegment& fit : segments) fit.is_suspect = is_clear(fit);
}

}  // namespace

Eigen::VectorXd FitSegment::average(std::span<const double> values) const {
  const auto size = static_cast<Eigen::Index>(values.size() / averaged);
  const Eigen::Map<const Eigen::MatrixXd> columns{values.data(), static_cast<Eigen::Index>(averaged), size};
  return columns.colwise().mean().transpose();
}

IdentificationProblem make_problem(const SiteModel& model, std::vector<Segment> segments,
                                   std::span<const FoundEffect> found, const Workers& workers) {
  IdentificationProblem problem;
  problem.model = model;
  problem.workers = workers;
  problem.scales = scales_of(segments);
  problem.inputs = input_ranges_of(model, segments);
  for (const InputRange& input : problem.inputs) mark_at_reference(input, segments);
  const double reached_m = problem.scales.of(ParameterScale::displacement_m);
  problem.law_is_spring = is_spring(model, reached_m);
  // Where it is not reached, a stiffness that the law does not have cannot be off by a ratio.
  problem.law_has_strength = !is_spring(model, reached_m / tuning::kResolution) &&
                             (!problem.law_is_spring || model.make_law()->initial_stiffness_n_per_m() > 0.0);
  std::vector<FitSegment>& fits = problem.segments;
  fits.resize(segments.size());
  workers.for_each(fits.size(), [&](std::size_t i) { fits[i] = prepare(problem, std::move(segments[i]), found); });
  workers.for_each(fits.size(), [&](std::size_t i) { relate_channels(fits, fits[i]); });
  std::vector<Eigen::VectorXd> residuals;
  for (const FitSegment& fit : fits) residuals.push_back(fit.measured - fit.baseline);
  take_noise(problem, {}, residuals, as_in_model);
  mark_suspects(fits);
  return problem;
}

bool are_numbers(std::span<const EffectSetting> effects) noexcept {
  return std::ranges::all_of(
      effects, [](const EffectSetting& effect) { return effect.type->traits.number != ModelNumber::none; });
}

namespace {

std::vector<Eigen::VectorXd> all_left_by(const FitOutcome& best, const IdentificationProblem& problem) {
  std::vector<Eigen::VectorXd> left;
  for (std::size_t i = 0; i < problem.segments.size(); ++i) {
    left.push_back(left_by(best.segments[i], problem.segments[i]));
  }
  return left;
}

}  // namespace

void settle_noise(IdentificationProblem& problem, const FitOutcome& best) {
  take_noise(problem, best.effects, all_left_by(best, problem), as_in_model);
}

void settle_final_noise(IdentificationProblem& problem, const FitOutcome& found) {
  take_noise(problem, found.effects, all_left_by(found, problem),
             [&](const FitSegment& fit) { return channel_floor_beside(problem.model, found.effects, fit); });
}

namespace {

/// The directions in which wrong numbers of the model move the output of a segment, and damping that it lacks.
Eigen::MatrixXd directions_of_numbers(const SiteModel& model, const FitSegment& fit) {
  Eigen::MatrixXd columns = fit.nuisance;
  const EffectType* const damping = find_effect(specimen, ModelNumber::damping);
  if (fit.segment.touched_by(*damping)) {
    const EffectSetting setting{.type = damping, .values = {1.0}};
    columns.conservativeResize(fit.measured.size(), columns.cols() + 1);
    columns.rightCols(1) = fit.average(predict(model, fit.segment, std::span{&setting, 1})) - fit.baseline;
  }
  if (columns.cols() == 0) return columns;
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> decomposed{columns};
  return decomposed.householderQ() * Eigen::MatrixXd::Identity(columns.rows(), decomposed.rank());
}

/// Leaves the numbers of the model free in a segment whose gap is not judged: every prediction is compared beside the
/// numbers that suit it best, so that no candidate earns anything by them.
void free_numbers(const SiteModel& model, FitSegment& fit) {
  fit.numbers.directions = directions_of_numbers(model, fit);
  if (fit.numbers.directions.cols() == 0) return;
  fit.numbers.slight = tuning::kNumbersWithin * fit.measured.norm();
  const double noise = std::sqrt(static_cast<double>(fit.measured.size()) / fit.independent) / fit.weight;
  fit.numbers.resolved = std::min(1.0, noise / fit.numbers.slight);
  fit.numbers.off = fit.numbers.directions.transpose() * (fit.measured - fit.baseline);
  fit.measured -= fit.numbers.directions * fit.numbers.off;
  for (Eigen::Index i = 0; i < fit.number_slopes.cols(); ++i) {
    const Eigen::VectorXd slope = fit.number_slopes.col(i);
    const Eigen::VectorXd left = slope - fit.numbers.directions * (fit.numbers.directions.transpose() * slope);
    // One that is free already leaves nothing but rounding.
    fit.number_slopes.col(i) = left.norm() > tuning::kCovarianceRidge * slope.norm() ? left : 0.0 * left;
  }
  fit.found_changes -= (fit.numbers.directions * (fit.numbers.directions.transpose() * fit.found_changes)).eval();
}

}  // namespace

IdentificationProblem judged_at(const IdentificationProblem& problem, Channel output) {
  IdentificationProblem part = problem;
  const auto is_here = [output](const FitSegment& fit) { return fit.segment.to == output; };
  const bool any_clear =
      std::ranges::any_of(part.segments, [&](const FitSegment& fit) { return is_here(fit) && is_clear(fit); });
  for (FitSegment& fit : part.segments) {
    fit.is_suspect = is_here(fit) && (!any_clear || is_clear(fit));
    fit.is_settled = fit.segment.to < output;
    if (!is_here(fit)) free_numbers(problem.model, fit);
  }
  return part;
}

bool is_model_number(const IdentificationProblem& problem, const EffectType& type) noexcept {
  // None of these is a nuisance.
  constexpr std::array kNumbers{ModelNumber::strength, ModelNumber::hardening, ModelNumber::bandwidth};
  if (std::ranges::find(kNumbers, type.traits.number) != kNumbers.end()) return true;
  if (place_of(problem.model, type) != nullptr) return true;
  return std::ranges::any_of(problem.segments, [&](const FitSegment& fit) {
    return std::ranges::find(fit.nuisance_types, &type) != fit.nuisance_types.end();
  });
}

namespace {

/// The prediction beside a law other than the model's own.
Eigen::VectorXd predict_with_law(const IdentificationProblem& problem, const FitSegment& segment,
                                 std::span<const EffectSetting> added, std::function<std::unique_ptr<Law>()> make_law) {
  SiteModel model = problem.model;
  model.make_law = std::move(make_law);
  return segment.average(predict(model, segment.segment, added));
}

Eigen::VectorXd predict_with_right_numbers(const IdentificationProblem& problem, const FitSegment& segment,
                                           std::span<const EffectSetting> added) {
  if (!segment.segment.touched_by(added)) return segment.baseline;
  if (segment.law == nullptr) return segment.average(predict(problem.model, segment.segment, added));
  return predict_with_law(problem, segment, added, [&] { return from_memory(problem.model.make_law, segment.law); });
}

/// Beside the free numbers that suit it.
Eigen::VectorXd beside_numbers(const FitSegment& segment, Eigen::VectorXd predicted) {
  const Eigen::MatrixXd& directions = segment.numbers.directions;
  if (directions.cols() > 0) predicted -= directions * (directions.transpose() * (predicted - segment.baseline));
  return predicted;
}

}  // namespace

Eigen::VectorXd predict(const IdentificationProblem& problem, const FitSegment& segment,
                        std::span<const EffectSetting> added) {
  problem.progress.alive();
  return beside_numbers(segment, predict_with_right_numbers(problem, segment, added));
}

Eigen::VectorXd predict(const IdentificationProblem& problem, const FitSegment& segment,
                        std::span<const EffectSetting> added, std::size_t position, LawMemories& memories) {
  const auto replacement = std::ranges::find_if(added, replaces_law);
  const bool is_of_use = replacement != added.end() && replacement->values[0] != 0.0 &&
                         segment.segment.touched_by(*replacement->type) &&
                         std::ranges::none_of(problem.model.effects, replaces_law);
  if (!is_of_use) return predict(problem, segment, added);
  std::vector<EffectSetting> others{added.begin(), added.end()};
  others.erase(others.begin() + (replacement - added.begin()));
  problem.progress.alive();
  const std::shared_ptr<const LawMemory> known = memories.find(*replacement, position);
  const auto made = std::make_shared<LawMemory>();
  Eigen::VectorXd predicted = predict_with_law(problem, segment, others, [&] {
    if (known != nullptr) return remembered(*replacement, known);
    *made = {};  // the law may be made more than once, to ask for its stiffness
    return remembering(*replacement, *made);
  });
  if (known == nullptr) memories.keep(*replacement, position, made);
  return beside_numbers(segment, std::move(predicted));
}

double noise_of_input(const IdentificationProblem& problem, const FitSegment& segment,
                      std::span<const EffectSetting> added) {
  if (segment.noisy == nullptr) return 0.0;
  problem.progress.alive();
  const Eigen::VectorXd noise = segment.average(predict(problem.model, segment.noisy->with, added)) -
                                segment.average(predict(problem.model, segment.noisy->without, added));
  return noise.squaredNorm() / static_cast<double>(noise.size());
}

double cost_of_numbers(const IdentificationProblem& problem, std::span<const EffectSetting> added) {
  double cost = 0.0;
  for (const FitSegment& fit : problem.segments) {
    const FreeNumbers& numbers = fit.numbers;
    if (numbers.directions.cols() == 0) continue;
    const Eigen::VectorXd change = predict_with_right_numbers(problem, fit, added) - fit.baseline;
    const Eigen::VectorXd off = (numbers.off - numbers.directions.transpose() * change) / numbers.slight;
    for (const double number : off) {
      if (std::abs(number) > tuning::kTwoSided95 * numbers.resolved) {
        cost += 0.5 * number * number - std::log(numbers.resolved);
      }
    }
  }
  return cost;
}

}  // namespace hybridtest
