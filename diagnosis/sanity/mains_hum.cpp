#include "diagnosis/sanity/mains_hum.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "diagnosis/signals/signals.hpp"
#include "diagnosis/traces/traces.hpp"
#include "diagnosis/tuning.hpp"

namespace hybridtest {
namespace {

constexpr std::array kMains_hz{50.0, 60.0};

/// Amplitudes of the lines of a signal about its mean, under a Hann window.
class Lines {
 public:
  Lines(std::span<const double> values, double period_s)
      : weighted_(values.begin(), values.end()), period_s_{period_s} {
    const auto count = static_cast<double>(values.size());
    double mean = 0.0;
    for (const double value : values) mean += value / count;
    for (std::size_t i = 0; i < weighted_.size(); ++i) {
      const double weight = 1.0 - std::cos(2.0 * std::numbers::pi * (static_cast<double>(i) + 0.5) / count);
      weighted_[i] = 2.0 * weight / count * (weighted_[i] - mean);
    }
  }

  /// Of a sine at this frequency its amplitude, and its phase at the first sample as of a cosine.
  [[nodiscard]] std::complex<double> at(double frequency_hz) const {
    const std::complex<double> turn = std::polar(1.0, -2.0 * std::numbers::pi * frequency_hz * period_s_);
    std::complex<double> phase{1.0, 0.0};
    std::complex<double> sum{};
    for (const double value : weighted_) {
      sum += value * phase;
      phase *= turn;
    }
    return sum;
  }

 private:
  std::vector<double> weighted_;
  double period_s_;
};

struct Hum {
  double frequency_hz = 0.0;
  std::complex<double> amplitude;
  double mains_hz = 0.0;
  bool is_followed = false;  // by the force, as by that of a spring
};

/// The largest line within 1 % of a frequency of the mains, if it stands out of its neighbours.
std::optional<Hum> line_near(const Lines& lines, double mains_hz, double duration_s) {
  // Under a Hann window lines that are two resolutions apart have nothing in common.
  const double resolution_hz = 1.0 / duration_s;
  Hum hum;
  const double reach_hz = 0.01 * mains_hz;
  const int per_resolution = 16;
  const auto steps = static_cast<int>(std::ceil(per_resolution * reach_hz / resolution_hz));
  int best = 0;
  const auto look_at = [&](int step) {
    const double frequency_hz = mains_hz + reach_hz * step / steps;
    const std::complex<double> amplitude = lines.at(frequency_hz);
    if (std::norm(amplitude) <= std::norm(hum.amplitude)) return;
    hum = {.frequency_hz = frequency_hz, .amplitude = amplitude, .mains_hz = mains_hz};
    best = step;
  };
  // A line is four resolutions wide: looked for at every half of one, and then around the largest.
  const int coarse = per_resolution / 2;
  for (int step = -steps; step <= steps; step += coarse) look_at(step);
  const int largest = best;
  for (int step = largest - coarse + 1; step < largest + coarse; ++step) look_at(step);
  double neighbours = 0.0;
  const auto each_side = static_cast<double>(tuning::kSpectrumAverages);
  for (double line = 0.0; line < each_side; line += 1.0) {
    const double away_hz = reach_hz + 2.0 * (line + 1.0) * resolution_hz;
    neighbours += std::norm(lines.at(mains_hz - away_hz)) + std::norm(lines.at(mains_hz + away_hz));
  }
  neighbours /= 2.0 * each_side;
  // Of white noise F exceeds x with the probability (1 + x / 16)^-16; so many independent lines are tried.
  const double tried = static_cast<double>(kMains_hz.size()) * std::max(1.0, 2.0 * reach_hz / resolution_hz);
  const double chance = tuning::kFalseAlarms / tried;
  const double by_chance = 2.0 * each_side * (std::pow(chance, -0.5 / each_side) - 1.0);
  if (std::norm(hum.amplitude) <= by_chance * neighbours) return {};
  return hum;
}

/// The lines of the mains in a displacement, at 50 and at 60 Hz.
std::vector<Hum> lines_of(const std::vector<double>& displacement_m, const std::vector<double>& force_n,
                          double period_s) {
  const double duration_s = period_s * static_cast<double>(displacement_m.size());
  const Lines displacement{displacement_m, period_s};
  const Lines force{force_n, period_s};
  const double secant_n_per_m = std::sqrt(variance(force_n) / variance(displacement_m));
  std::vector<Hum> found;
  for (const double mains_hz : kMains_hz) {
    // All neighbours lie between rest and half of the sample rate.
    const double neighbours_hz = 0.01 * mains_hz + 2.0 * static_cast<double>(tuning::kSpectrumAverages) / duration_s;
    if (neighbours_hz >= mains_hz || mains_hz + neighbours_hz >= 0.5 / period_s) continue;
    std::optional<Hum> hum = line_near(displacement, mains_hz, duration_s);
    if (!hum) continue;
    const double followed_n = secant_n_per_m * std::abs(hum->amplitude);
    hum->is_followed = std::abs(force.at(hum->frequency_hz)) >= 0.5 * followed_n;
    found.push_back(*hum);
  }
  return found;
}

void take_off(const Hum& hum, double period_s, std::vector<double>& readings) {
  for (std::size_t i = 0; i < readings.size(); ++i) {
    const double turn = 2.0 * std::numbers::pi * hum.frequency_hz * period_s * static_cast<double>(i);
    readings[i] -= (hum.amplitude * std::polar(1.0, turn)).real();
  }
}

}  // namespace

std::span<const Recording> without_mains_hum(std::span<const Recording> recordings, std::size_t dof,
                                             std::vector<Recording>& copy, std::vector<std::string>& notes) {
  std::vector<std::vector<Hum>> lines(recordings.size());
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    const Recording& recording = recordings[i];
    if (recording.is_quasi_static || recording.dofs.size() <= dof) continue;
    const DofRecording& channels = recording.dofs[dof];
    const std::vector<double>& readings = channels.of(Channel::measured_displacement);
    if (readings.empty() || !channels.has(Channel::measured_force)) continue;
    if (static_cast<double>(readings.size()) * recording.sample_period_s > tuning::kHumDurationMax_s) continue;
    if (steps_of_readings(readings).step > 0.0) continue;
    lines[i] = lines_of(readings, channels.of(Channel::measured_force), recording.sample_period_s);
  }
  const auto is_of_reading = [&](const Hum& hum) {
    return std::ranges::any_of(lines, [&](const std::vector<Hum>& others) {
      return std::ranges::any_of(
          others, [&](const Hum& other) { return other.mains_hz == hum.mains_hz && !other.is_followed; });
    });
  };
  std::vector<std::pair<std::size_t, Hum>> found;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Hum* largest = nullptr;
    for (const Hum& hum : lines[i]) {
      const bool is_larger = largest == nullptr || std::norm(hum.amplitude) > std::norm(largest->amplitude);
      if (is_larger && is_of_reading(hum)) largest = &hum;
    }
    if (largest != nullptr) found.emplace_back(i, *largest);
  }
  if (found.empty()) return recordings;
  if (copy.empty()) copy.assign(recordings.begin(), recordings.end());
  for (const auto& [position, hum] : found) {
    Recording& recording = copy[position];
    take_off(hum, recording.sample_period_s, recording.dofs[dof].of(Channel::measured_displacement));
    notes.push_back(fmt::format(
        "{}: hum of the mains, {:.2f} Hz and {:.2g} mm high, is taken off the measured "
        "displacement. {} Check the shield of that sensor's cable.",
        recording.file, hum.frequency_hz, 1000.0 * std::abs(hum.amplitude),
        hum.is_followed ? "In another recording the force does not follow it." : "The force does not follow it."));
  }
  return copy;
}

}  // namespace hybridtest
