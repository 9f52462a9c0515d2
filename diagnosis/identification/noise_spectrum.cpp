#include "diagnosis/identification/noise_spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "diagnosis/localisation/gap_shares.hpp"
#include "diagnosis/signals/signals.hpp"
#include "diagnosis/tuning.hpp"

namespace hybridtest {
namespace {

/// At least half of the output's power is the remainder's: nothing of the motion shows there.
bool is_quiet(const Spectra& spectra, std::size_t line) {
  return spectra.input[line] - spectra.output[line] <= spectra.output[line];
}

/// Power spectral density over frequency of an autoregressive process of unit innovation, beside white noise.
std::vector<double> shape_of(double correlation, double white, std::size_t lines) {
  std::vector<double> shape(lines);
  for (std::size_t i = 0; i < lines; ++i) {
    const double turn = std::numbers::pi * static_cast<double>(i) / static_cast<double>(lines - 1);
    shape[i] = 1.0 / (1.0 + correlation * correlation - 2.0 * correlation * std::cos(turn)) + white;
  }
  return shape;
}

/// Hum stands above the median of its neighbours, as many on either side as the spectrum has averages, by what stands
/// above a floor. With six independent averages white noise does so in 1 of 100 000 lines.
bool is_hum(const std::vector<double>& density, std::size_t line) {
  const std::size_t begin = line - std::min(line, tuning::kSpectrumAverages);
  const std::size_t end = std::min(density.size(), line + tuning::kSpectrumAverages + 1);
  const double near = upper_median(
      {density.begin() + static_cast<std::ptrdiff_t>(begin), density.begin() + static_cast<std::ptrdiff_t>(end)});
  return density[line] > tuning::kNearFloor * tuning::kNearFloor * near;
}

}  // namespace

std::optional<double> noise_by_spectrum(std::span<const double> measured, std::span<const double> remainder,
                                        double period_s) {
  if (measured.size() != remainder.size() || remainder.size() < tuning::kSamplesMin) return {};
  const Spectra spectra = welch(measured, remainder, period_s, welch_segment(remainder.size()));
  const std::vector<double>& density = spectra.output;
  std::size_t first = density.size();
  while (first > 1 && is_quiet(spectra, first - 1)) --first;
  if (2 * first > density.size()) return {};
  std::vector<std::size_t> lines;
  for (std::size_t i = first; i < density.size(); ++i) {
    if (density[i] > 0.0 && !is_hum(density, i)) lines.push_back(i);
  }
  if (2 * lines.size() < density.size() - first) return {};
  std::vector<double> fitted;
  double least = std::numeric_limits<double>::infinity();
  for (const double correlation : {0.0, 0.3, 0.5, 0.6, 0.7, 0.75, 0.8, 0.85, 0.9, 0.93, 0.95, 0.97, 0.98, 0.99}) {
    for (const double white : {0.0, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0}) {
      const std::vector<double> shape = shape_of(correlation, white, density.size());
      double scale = 0.0;
      double logs = 0.0;
      for (const std::size_t i : lines) {
        scale += density[i] / shape[i] / static_cast<double>(lines.size());
        logs += std::log(shape[i]) / static_cast<double>(lines.size());
      }
      const double misfit = logs + std::log(scale);  // the scale fits best
      if (misfit >= least) continue;
      least = misfit;
      fitted = shape;
      for (double& value : fitted) value *= scale;
    }
  }
  double power = 0.0;
  for (std::size_t i = 1; i < density.size(); ++i) {
    power += is_quiet(spectra, i) ? density[i] : std::min(density[i], fitted[i]);
  }
  return std::sqrt(power * spectra.resolution_hz);
}

}  // namespace hybridtest
