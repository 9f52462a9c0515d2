#include "diagnosis/verdict/shrink.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include "core/random.hpp"
#include "diagnosis/identification/search.hpp"
#include "diagnosis/signals/signals.hpp"
#include "diagnosis/traces/traces.hpp"
#include "diagnosis/tuning.hpp"

namespace hybridtest {

namespace {

/// Energies of one block, relative to the output's mean energy per sample of its segment.
struct BlockEnergy {
  double before = 0.0;
  double after = 0.0;
  double changed = 0.0;
  double floor = 0.0;
  double samples = 0.0;

  BlockEnergy& operator+=(const BlockEnergy& other) {
    before += other.before;
    after += other.after;
    changed += other.changed;
    floor += other.floor;
    samples += other.samples;
    return *this;
  }
};

/// The sum over the causes of an effect of the network [its unit].
double sum_of(std::span<const EffectSetting> causes, std::string_view network_effect) {
  const EffectType* const type = find_effect(EffectInterface::network, network_effect);
  double sum = 0.0;
  for (const EffectSetting& cause : causes) sum += cause.type == type ? cause.values.front() : 0.0;
  return sum;
}

/// What a site receives, which plays messages at the next whole sample, where the causes say so. Random faults cannot
/// be repeated by a seed: for them the lags that were found show sample by sample what they explain.
void play_messages(std::span<const EffectSetting> causes, const Segment& segment, std::vector<double>& predicted) {
  const bool is_random = std::ranges::any_of(causes, [&](const EffectSetting& cause) {
    return segment.touched_by(*cause.type) && shows_in_digits(*cause.type);
  });
  const double drift = sum_of(causes, "clock_drift");
  if (!is_random && !(drift > 0.0)) return;
  std::vector<double> sent_m(segment.input.size());
  std::ranges::transform(segment.input, sent_m.begin(), &Motion::displacement_m);
  const NetworkLags lags = lags_between(sent_m, segment.measured, segment.period_s);
  if (is_random) {
    for (std::size_t i = 0; i < predicted.size(); ++i) {
      if (lags.lag[i] >= 0) predicted[i] = segment.measured[i];
    }
  } else if (lags.are_messages()) {
    const double late_s = sum_of(causes, "latency") + sum_of(causes, "clock_offset");
    predicted = made_late(sent_m, static_cast<int>(std::ceil(late_s / segment.period_s)), {.per_sample = drift});
  }
}

/// The prediction with the causes.
std::vector<double> predicted_with(const SiteModel& model, std::span<const EffectSetting> causes,
                                   const Segment& segment) {
  std::vector<double> predicted = predict(model, segment, causes);
  if (segment.to == Channel::target_displacement) play_messages(causes, segment, predicted);
  return predicted;
}

/// Beside numbers of the model alone, whose form is right, what repeats in no function of the motion is noise. The form
/// of an effect or of a law is never quite that of the specimen: beside one, what it misses would pass for noise,
/// unless it is there as well where the motion hardly moves.
double settled_floor(std::span<const EffectSetting> causes, const FitSegment& fit) {
  return are_numbers(causes) ? fit.sample_floor : fit.still_floor;
}

/// Residual that a correct model leaves [standard deviation]. Coloured noise and hum of the force show only in a
/// residual, so that they are taken from the fitted segments; those of the motion where the actuator's channel tells
/// them. What noise does by what the specimen went through, as cycles that it adds, is none.
double floor_of(const SiteModel& model, std::span<const EffectSetting> causes, const Segment& segment,
                std::span<const FitSegment> fitted) {
  double energy = 0.0;
  double alike = 0.0;
  for (const FitSegment& fit : fitted) {
    if (fit.segment.from != segment.from || fit.segment.to != segment.to) continue;
    energy += std::pow(settled_floor(causes, fit), 2);
    alike += 1.0;
  }
  double of_channels = noise_floor(segment, input_errors(model, segment));
  if (take_place_in(model, causes)) {
    of_channels = std::min(of_channels, noise_floor(segment, input_errors(model, segment, causes)));
  }
  const double floor = std::max(of_channels, alike > 0.0 ? std::sqrt(energy / alike) : 0.0);
  if (segment.told_noise.empty()) return floor;
  std::vector<EffectSetting> acting{causes.begin(), causes.end()};
  std::erase_if(acting, [](const EffectSetting& effect) { return degrades(*effect.type); });
  std::vector<double> without = predict(model, with_noise(segment, segment.told_noise, -1.0), acting);
  const std::vector<double> with = predict(model, segment, acting);
  for (std::size_t i = 0; i < without.size(); ++i) without[i] -= with[i];
  return std::max(floor, std::hypot(segment.measured_noise, std::sqrt(mean_square(without))));
}

void add_blocks(const SiteModel& model, std::span<const EffectSetting> causes, const Segment& segment,
                std::span<const FitSegment> fitted, std::vector<BlockEnergy>& blocks) {
  const std::vector<double> before = predict(model, segment);
  const std::vector<double> after = predicted_with(model, causes, segment);
  const std::size_t n = segment.measured.size();
  const double floor = floor_of(model, causes, segment, fitted);
  double output = 0.0;
  for (const double value : segment.measured) output += value * value / static_cast<double>(n);
  if (output <= 0.0) return;
  for (std::size_t b = 0; b < tuning::kShrinkBlocks; ++b) {
    BlockEnergy block;
    for (std::size_t i = n * b / tuning::kShrinkBlocks; i < n * (b + 1) / tuning::kShrinkBlocks; ++i) {
      block.before += std::pow(segment.measured[i] - before[i], 2) / output;
      block.after += std::pow(segment.measured[i] - after[i], 2) / output;
      block.changed += std::pow(after[i] - before[i], 2) / output;
      block.floor += floor * floor / output;
      block.samples += 1.0;
    }
    blocks.push_back(block);
  }
}

double removed(const BlockEnergy& sum) { return sum.before > 0.0 ? 1.0 - sum.after / sum.before : 0.0; }

report::Interval interval_of(const std::vector<BlockEnergy>& blocks, std::uint64_t seed) {
  Random random{seed};
  std::vector<double> drawn;
  for (std::size_t i = 0; i < tuning::kResamples; ++i) {
    BlockEnergy sum;
    for (std::size_t b = 0; b < blocks.size(); ++b) sum += blocks[random.below(blocks.size())];
    drawn.push_back(removed(sum));
  }
  std::ranges::sort(drawn);
  return {drawn[tuning::kResamples / 40], drawn[tuning::kResamples - 1 - tuning::kResamples / 40]};
}

}  // namespace

report::Shrink shrink_on(const SiteModel& model, std::span<const EffectSetting> causes,
                         std::span<const Segment> held_out, std::uint64_t seed, std::span<const FitSegment> fitted) {
  std::vector<BlockEnergy> blocks;
  for (const Segment& segment : held_out) {
    if (segment.touched_by(causes)) add_blocks(model, causes, segment, fitted, blocks);
  }
  report::Shrink shrink;
  if (blocks.empty()) return shrink;
  BlockEnergy sum;
  for (const BlockEnergy& block : blocks) sum += block;
  shrink.nrmse_before = std::sqrt(sum.before / sum.samples);
  shrink.nrmse_after = std::sqrt(sum.after / sum.samples);
  shrink.floor_nrmse = std::sqrt(sum.floor / sum.samples);
  shrink.changed_nrmse = std::sqrt(sum.changed / sum.samples);
  shrink.variance_removed = removed(sum);
  shrink.ci95 = interval_of(blocks, seed);
  if (sum.before > sum.floor)
    shrink.explainable_fraction = std::min(1.0, (sum.before - sum.after) / (sum.before - sum.floor));
  if (sum.before > 0.0) shrink.unknown_share = std::max(0.0, sum.after - sum.floor) / sum.before;
  return shrink;
}

using report::Shrink;
using report::Verdict;

bool is_worse(const Shrink& held_out) {
  return held_out.nrmse_after > std::hypot(held_out.nrmse_before, held_out.floor_nrmse);
}

bool acts(const Shrink& held_out) { return held_out.changed_nrmse > tuning::kCauseActs * held_out.floor_nrmse; }

namespace {

/// Of the gap, what the causes of a part have to remove at least; nothing where they do not act.
double least_removed(const Shrink& held_out, const VerdictPolicy& policy) {
  if (!acts(held_out)) return 0.0;
  const double explainable = std::max(0.0, 1.0 - std::pow(held_out.floor_nrmse / held_out.nrmse_before, 2));
  return (1.0 - policy.partial_leaves) * explainable;
}

/// Whether the causes act, but certainly leave more of what can be explained of the gap than is accepted; or make it
/// larger, however uncertain the gap is.
bool contradicts(const Shrink& held_out, const VerdictPolicy& policy) {
  if (is_worse(held_out)) return true;
  return held_out.ci95 && held_out.ci95->high < least_removed(held_out, policy);
}

/// What was found in part only has to remove as much as a part does, as far as is known.
bool contradicts_a_part(const Shrink& held_out, const VerdictPolicy& policy) {
  return is_worse(held_out) || held_out.variance_removed < least_removed(held_out, policy);
}

}  // namespace

bool leave_a_part(std::span<const Shrink> held_out, const VerdictPolicy& policy) {
  return std::ranges::any_of(held_out, [&](const Shrink& one) {
    const double over_floor = one.nrmse_after / std::hypot(one.floor_nrmse, tuning::kModelAllowance);
    return !policy.names(one.unknown_share, over_floor);
  });
}

Verdict verdict_carried_over(Verdict verdict, std::span<const Shrink> held_out, const VerdictPolicy& policy) {
  if (!report::names_a_cause(verdict) || held_out.empty()) return verdict;
  if (verdict == Verdict::named && leave_a_part(held_out, policy)) verdict = Verdict::partial;
  const auto is_against = [&](const Shrink& one) {
    return verdict == Verdict::partial ? contradicts_a_part(one, policy) : contradicts(one, policy);
  };
  if (!std::ranges::all_of(held_out, is_against)) return verdict;
  const bool is_clear = std::ranges::any_of(
      held_out, [](const Shrink& one) { return one.nrmse_before > tuning::kNearFloor * one.floor_nrmse; });
  return is_clear ? Verdict::unknown : Verdict::none;
}

}  // namespace hybridtest
