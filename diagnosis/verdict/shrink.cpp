#include "diagnosis/verdict/shrink.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/random.hpp"
#include "diagnosis/traces/network_lags.hpp"

namespace hybridtest {
namespace {

constexpr std::size_t kBlocks = 12;  // per segment
constexpr std::size_t kResamples = 200;

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

/// The prediction with the causes. What arrives at random no seed repeats: there the lags found say what of it they
/// explain, sample by sample.
std::vector<double> predicted_with(const SiteModel& model, std::span<const EffectSetting> causes,
                                   const Segment& segment) {
  std::vector<double> predicted = predict(model, segment, causes);
  const bool is_random =
      segment.to == Channel::target_displacement && std::ranges::any_of(causes, [&](const EffectSetting& cause) {
        return segment.touched_by(*cause.type) && shows_in_digits(*cause.type);
      });
  if (!is_random) return predicted;
  std::vector<double> sent_m(segment.input.size());
  std::ranges::transform(segment.input, sent_m.begin(), &Motion::displacement_m);
  const NetworkLags lags = lags_between(sent_m, segment.measured, segment.period_s);
  for (std::size_t i = 0; i < predicted.size(); ++i) {
    if (lags.lag[i] >= 0) predicted[i] = segment.measured[i];
  }
  return predicted;
}

void add_blocks(const SiteModel& model, std::span<const EffectSetting> causes, const Segment& segment,
                std::vector<BlockEnergy>& blocks) {
  const std::vector<double> before = predict(model, segment);
  const std::vector<double> after = predicted_with(model, causes, segment);
  const std::size_t n = segment.measured.size();
  const double floor = noise_floor(model, segment);
  double output = 0.0;
  for (const double value : segment.measured) output += value * value / static_cast<double>(n);
  if (output <= 0.0) return;
  for (std::size_t b = 0; b < kBlocks; ++b) {
    BlockEnergy block;
    for (std::size_t i = n * b / kBlocks; i < n * (b + 1) / kBlocks; ++i) {
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
  for (std::size_t i = 0; i < kResamples; ++i) {
    BlockEnergy sum;
    for (std::size_t b = 0; b < blocks.size(); ++b) sum += blocks[random.below(blocks.size())];
    drawn.push_back(removed(sum));
  }
  std::ranges::sort(drawn);
  return {drawn[kResamples / 40], drawn[kResamples - 1 - kResamples / 40]};
}

}  // namespace

report::Shrink shrink_on(const SiteModel& model, std::span<const EffectSetting> causes,
                         std::span<const Segment> held_out, std::uint64_t seed) {
  std::vector<BlockEnergy> blocks;
  for (const Segment& segment : held_out) {
    const bool touched =
        std::ranges::any_of(causes, [&](const EffectSetting& cause) { return segment.touched_by(*cause.type); });
    if (touched) add_blocks(model, causes, segment, blocks);
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
  if (sum.before > sum.floor) shrink.explainable_fraction = (sum.before - sum.after) / (sum.before - sum.floor);
  if (sum.before > 0.0) shrink.unknown_share = std::max(0.0, sum.after - sum.floor) / sum.before;
  return shrink;
}

}  // namespace hybridtest
