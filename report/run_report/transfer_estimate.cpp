#include "report/run_report/transfer_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/assert.hpp"
#include "report/run_report/tuning.hpp"

namespace hybridtest::run_report {
namespace {

/// Drops the older half of a full segment: the next one overlaps by half.
void keep_newer_half(std::vector<double>& signal) {
  signal.erase(signal.begin(), signal.begin() + static_cast<std::ptrdiff_t>(signal.size() / 2));
}

}  // namespace

TransferEstimate::TransferEstimate(double period_s, std::size_t samples)
    : period_s_{period_s},
      samples_{samples},
      window_(samples),
      target_power_(samples / 2 + 1),
      measured_power_(samples / 2 + 1),
      cross_(samples / 2 + 1) {
  HYBRIDTEST_ASSERT(samples >= 16 && (samples & (samples - 1)) == 0);
  transform_.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  for (std::size_t i = 0; i < samples; ++i) {
    const double turn = 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(samples);
    window_[i] = 0.5 * (1.0 - std::cos(turn));
  }
}

void TransferEstimate::add(double target, double measured) {
  if (!std::isfinite(target) || !std::isfinite(measured)) {
    target_.clear();
    measured_.clear();
    return;
  }
  target_.push_back(target);
  measured_.push_back(measured);
  if (target_.size() == samples_) end_segment();
}

std::vector<std::complex<double>> TransferEstimate::spectrum_of(const std::vector<double>& segment) {
  const double mean = std::accumulate(segment.begin(), segment.end(), 0.0) / static_cast<double>(segment.size());
  std::vector<double> tapered(segment.size());
  for (std::size_t i = 0; i < segment.size(); ++i) tapered[i] = (segment[i] - mean) * window_[i];
  std::vector<std::complex<double>> result;
  transform_.fwd(result, tapered);
  return result;
}

void TransferEstimate::end_segment() {
  const auto target = spectrum_of(target_);
  const auto measured = spectrum_of(measured_);
  for (std::size_t i = 0; i < cross_.size(); ++i) {
    target_power_[i] += std::norm(target[i]);
    measured_power_[i] += std::norm(measured[i]);
    cross_[i] += measured[i] * std::conj(target[i]);
  }
  ++segments_;
  keep_newer_half(target_);
  keep_newer_half(measured_);
}

std::vector<TransferPoint> TransferEstimate::points() const {
  std::vector<TransferPoint> points;
  if (segments_ < 2) return points;
  const double most = *std::ranges::max_element(target_power_);
  for (std::size_t i = 1; i < cross_.size(); ++i) {
    if (!(target_power_[i] > kPowerMin * most) || !(measured_power_[i] > 0.0)) continue;
    const double coherence = std::norm(cross_[i]) / (target_power_[i] * measured_power_[i]);
    if (coherence < kCoherenceMin) continue;
    const double frequency_hz = static_cast<double>(i) / (static_cast<double>(samples_) * period_s_);
    points.push_back({frequency_hz, std::abs(cross_[i]) / target_power_[i],
                      -std::arg(cross_[i]) / (2.0 * std::numbers::pi * frequency_hz), coherence});
  }
  return points;
}

}  // namespace hybridtest::run_report
