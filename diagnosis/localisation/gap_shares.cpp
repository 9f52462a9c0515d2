#include "diagnosis/localisation/gap_shares.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <unsupported/Eigen/FFT>

#include "core/assert.hpp"
#include "diagnosis/tuning.hpp"

namespace hybridtest {

std::vector<TimeWindow> gap_over_time(const GapSignals& signals, std::size_t count) {
  const std::size_t size = signals.size();
  const double whole = mean_square(signals.residual) * static_cast<double>(size);
  const double output = mean_square(signals.measured);
  std::vector<TimeWindow> windows;
  for (std::size_t i = 0; i < std::min(count, size); ++i) {
    const std::size_t begin = i * size / std::min(count, size);
    const std::size_t end = (i + 1) * size / std::min(count, size);
    const double here = mean_square(signals.residual.subspan(begin, end - begin));
    TimeWindow window;
    window.begin_s = static_cast<double>(begin) * signals.period_s;
    window.end_s = static_cast<double>(end) * signals.period_s;
    window.share = whole > 0.0 ? here * static_cast<double>(end - begin) / whole : 0.0;
    window.nrmse = output > 0.0 ? std::sqrt(here / output) : 0.0;
    windows.push_back(window);
  }
  return windows;
}

std::vector<TimeWindow> windows_holding(const std::vector<TimeWindow>& windows, double share) {
  std::vector<std::size_t> order(windows.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::stable_sort(order, std::ranges::greater{}, [&](std::size_t i) { return windows[i].share; });
  double held = 0.0;
  std::size_t kept = 0;
  while (kept < order.size() && held < share && windows[order[kept]].share > 0.0) held += windows[order[kept++]].share;
  order.resize(kept);
  std::ranges::sort(order);
  std::vector<TimeWindow> joined;
  for (const std::size_t i : order) {
    const TimeWindow& next = windows[i];
    if (joined.empty() || joined.back().end_s != next.begin_s) {
      joined.push_back(next);
      continue;
    }
    TimeWindow& last = joined.back();
    const double last_s = last.end_s - last.begin_s;
    const double next_s = next.end_s - next.begin_s;
    last.nrmse = std::sqrt((last.nrmse * last.nrmse * last_s + next.nrmse * next.nrmse * next_s) / (last_s + next_s));
    last.end_s = next.end_s;
    last.share += next.share;
  }
  return joined;
}

namespace {

std::vector<double> hann(std::size_t size) {
  std::vector<double> window(size);
  for (std::size_t i = 0; i < size; ++i) {
    const double phase = 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(size);
    window[i] = 0.5 * (1.0 - std::cos(phase));
  }
  return window;
}

std::vector<std::complex<double>> transformed(std::span<const double> values, const std::vector<double>& window,
                                              Eigen::FFT<double>& transform) {
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  std::vector<double> weighted(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) weighted[i] = (values[i] - mean) * window[i];
  std::vector<std::complex<double>> result;
  transform.fwd(result, weighted);
  return result;
}

}  // namespace

double Spectra::coherence(std::size_t i) const noexcept {
  const double product = input[i] * output[i];
  return product > 0.0 ? std::norm(cross[i]) / product : 0.0;
}

Spectra welch(std::span<const double> input, std::span<const double> output, double period_s, std::size_t segment) {
  HYBRIDTEST_ASSERT(input.size() == output.size() && segment >= tuning::kSpectrumSegmentMin && segment <= input.size());
  const std::vector<double> window = hann(segment);
  const double window_power = std::inner_product(window.begin(), window.end(), window.begin(), 0.0);
  Eigen::FFT<double> transform;
  transform.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  const std::size_t size = segment / 2 + 1;
  Spectra spectra{.resolution_hz = 1.0 / (static_cast<double>(segment) * period_s),
                  .averages = 0,
                  .input = std::vector<double>(size, 0.0),
                  .output = std::vector<double>(size, 0.0),
                  .cross = std::vector<std::complex<double>>(size)};
  for (std::size_t begin = 0; begin + segment <= input.size(); begin += segment / 2) {
    const auto x = transformed(input.subspan(begin, segment), window, transform);
    const auto y = transformed(output.subspan(begin, segment), window, transform);
    for (std::size_t i = 0; i < size; ++i) {
      spectra.input[i] += std::norm(x[i]);
      spectra.output[i] += std::norm(y[i]);
      spectra.cross[i] += y[i] * std::conj(x[i]);
    }
    ++spectra.averages;
  }
  for (std::size_t i = 0; i < size; ++i) {
    // Both sides of the spectrum, but for its ends.
    const double sides = i == 0 || i + 1 == size ? 1.0 : 2.0;
    const double scale = sides * period_s / (window_power * static_cast<double>(spectra.averages));
    spectra.input[i] *= scale;
    spectra.output[i] *= scale;
    spectra.cross[i] *= scale;
  }
  return spectra;
}

std::size_t welch_segment(std::size_t samples) noexcept {
  std::size_t segment = tuning::kSpectrumSegmentMin;
  // So many averages with half overlap take (averages + 1) / 2 segments.
  while (segment < tuning::kSpectrumSegmentMax && 2 * segment * (tuning::kSpectrumAverages + 1) / 2 <= samples)
    segment *= 2;
  return segment;
}

namespace {

void accumulate(BandShare& band, const Spectra& spectra, std::size_t line, double& coherent) {
  const double power = spectra.output[line] * spectra.resolution_hz;
  band.share += power;
  coherent += power * spectra.coherence(line);
}

}  // namespace

std::vector<BandShare> gap_over_frequency(const GapSignals& signals, const Spectra& spectra) {
  const double whole = std::accumulate(spectra.output.begin(), spectra.output.end(), 0.0) * spectra.resolution_hz;
  const double output = mean_square(signals.measured);
  const double half_rate_hz = spectra.frequency_hz(spectra.output.size() - 1);
  std::vector<BandShare> bands;
  double low_hz = 0.0;
  double high_hz = tuning::kFirstBandLines * spectra.resolution_hz;
  std::size_t line = 0;
  while (line < spectra.output.size()) {
    BandShare band{.low_hz = low_hz, .high_hz = std::min(high_hz, half_rate_hz)};
    double coherent = 0.0;
    for (; line < spectra.output.size() && (spectra.frequency_hz(line) < high_hz || high_hz >= half_rate_hz); ++line) {
      accumulate(band, spectra, line, coherent);
    }
    band.coherence = band.share > 0.0 ? coherent / band.share : 0.0;
    band.nrmse = output > 0.0 ? std::sqrt(band.share / output) : 0.0;
    band.share = whole > 0.0 ? band.share / whole : 0.0;
    bands.push_back(band);
    low_hz = high_hz;
    high_hz *= std::numbers::sqrt2;
  }
  return bands;
}

std::vector<BandShare> bands_holding(const std::vector<BandShare>& bands, double share) {
  std::vector<std::size_t> order(bands.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::ranges::greater{}, [&](std::size_t i) { return bands[i].share; });
  double held = 0.0;
  std::size_t kept = 0;
  while (kept < order.size() && held < share && bands[order[kept]].share > 0.0) held += bands[order[kept++]].share;
  order.resize(kept);
  std::ranges::sort(order);
  std::vector<BandShare> joined;
  for (const std::size_t i : order) {
    const BandShare& next = bands[i];
    if (joined.empty() || joined.back().high_hz != next.low_hz) {
      joined.push_back(next);
      continue;
    }
    BandShare& last = joined.back();
    last.coherence = (last.coherence * last.share + next.coherence * next.share) / (last.share + next.share);
    last.nrmse = std::hypot(last.nrmse, next.nrmse);
    last.high_hz = next.high_hz;
    last.share += next.share;
  }
  return joined;
}

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
  const std::vector<double> velocity = velocity_of(signals.input_m, signals.period_s, tuning::kVelocityReach_s);
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
