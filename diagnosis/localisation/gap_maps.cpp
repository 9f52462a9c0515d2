#include "diagnosis/localisation/gap_maps.hpp"

#include <algorithm>
#include <cmath>

#include "core/assert.hpp"

namespace hybridtest {
namespace {

/// 0 to bins - 1; the largest value belongs to the last.
std::size_t bin_of(double value, double largest, std::size_t bins) {
  if (!(largest > 0.0)) return 0;
  return std::min(bins - 1, static_cast<std::size_t>(std::max(0.0, value / largest) * static_cast<double>(bins)));
}

double largest_magnitude(std::span<const double> values) {
  double largest = 0.0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  return largest;
}

/// Turns sums of squares, kept in `share`, into shares and relative root mean squares.
void finish(std::vector<GapBin>& bins, const GapSignals& signals) {
  const double whole = mean_square(signals.residual) * static_cast<double>(signals.size());
  const double output = mean_square(signals.measured);
  for (GapBin& bin : bins) {
    const double squares = bin.share;
    bin.share = whole > 0.0 ? squares / whole : 0.0;
    bin.nrmse = bin.samples > 0 && output > 0.0 ? std::sqrt(squares / static_cast<double>(bin.samples) / output) : 0.0;
  }
}

}  // namespace

std::vector<GapBin> gap_over(const GapSignals& signals, std::span<const double> quantity, std::size_t bins) {
  HYBRIDTEST_ASSERT(quantity.size() == signals.size() && bins > 0);
  const double largest = largest_magnitude(quantity);
  std::vector<GapBin> found(bins);
  for (std::size_t i = 0; i < bins; ++i) {
    found[i].low = largest * static_cast<double>(i) / static_cast<double>(bins);
    found[i].high = largest * static_cast<double>(i + 1) / static_cast<double>(bins);
  }
  for (std::size_t i = 0; i < quantity.size(); ++i) {
    GapBin& bin = found[bin_of(quantity[i], largest, bins)];
    ++bin.samples;
    bin.share += signals.residual[i] * signals.residual[i];
  }
  finish(found, signals);
  return found;
}

MotionMap gap_over_motion(const GapSignals& signals, std::size_t displacement_bins, std::size_t velocity_bins) {
  const std::vector<double> velocity = velocity_of(signals.input_m, signals.period_s, kVelocityReach_s);
  MotionMap map{.peak_m = largest_magnitude(signals.input_m),
                .peak_m_per_s = largest_magnitude(velocity),
                .displacement_bins = displacement_bins,
                .velocity_bins = velocity_bins,
                .cells = std::vector<GapBin>(displacement_bins * velocity_bins)};
  for (std::size_t i = 0; i < signals.size(); ++i) {
    const std::size_t column = bin_of(std::abs(signals.input_m[i]), map.peak_m, displacement_bins);
    const std::size_t row = bin_of(std::abs(velocity[i]), map.peak_m_per_s, velocity_bins);
    GapBin& cell = map.cells[row * displacement_bins + column];
    ++cell.samples;
    cell.share += signals.residual[i] * signals.residual[i];
  }
  finish(map.cells, signals);
  return map;
}

std::vector<double> velocity_of(std::span<const double> displacement_m, double period_s, double reach_s) {
  const std::size_t size = displacement_m.size();
  const auto reach = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(reach_s / period_s)));
  std::vector<double> velocity(size, 0.0);
  for (std::size_t i = 0; i < size && size > 1; ++i) {
    const std::size_t from = i > reach ? i - reach : 0;
    const std::size_t to = std::min(i + reach, size - 1);
    velocity[i] = (displacement_m[to] - displacement_m[from]) / (static_cast<double>(to - from) * period_s);
  }
  return velocity;
}

}  // namespace hybridtest
