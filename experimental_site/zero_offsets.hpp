#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/interface_vector.hpp"
#include "experimental_site/rigs/rig.hpp"

namespace hybridtest {

/// Zero offsets of the sensors: their readings while the rig stands at zero, averaged over the first
/// samples after arming and then subtracted from the measured values. Real-time safe.
class ZeroOffsets {
 public:
  /// Five periods of the mains, so that its hum averages out; reduces the noise of a 1 kHz loop to a tenth.
  static constexpr double kAveraged_s = 0.1;

  ZeroOffsets(int dofs, double period_s) noexcept
      : wanted_samples_{std::max<std::int64_t>(1, std::llround(kAveraged_s / period_s))},
        mean_{SiteVector::Zero(dofs), SiteVector::Zero(dofs)},
        offset_{mean_} {}

  void reset() noexcept {
    mean_.displacement_m.setZero();
    mean_.force_n.setZero();
    offset_ = mean_;
    samples_ = 0;
    has_offset_ = false;
  }
  /// Values that are not finite are left out; the interlock `not_finite` acts on them.
  void capture(const RigFeedback& feedback) noexcept {
    if (!feedback.displacement_m.allFinite() || !feedback.force_n.allFinite()) return;
    ++samples_;
    const double share = 1.0 / static_cast<double>(samples_);
    mean_.displacement_m += share * (feedback.displacement_m - mean_.displacement_m);
    mean_.force_n += share * (feedback.force_n - mean_.force_n);
    if (!is_captured()) return;
    offset_ = mean_;
    has_offset_ = true;
  }
  [[nodiscard]] bool is_captured() const noexcept { return samples_ >= wanted_samples_; }

  void take_off(RigFeedback& feedback) const noexcept {
    if (!has_offset_) return;
    feedback.displacement_m -= offset_.displacement_m;
    feedback.force_n -= offset_.force_n;
  }
  /// Zero until captured.
  [[nodiscard]] const RigFeedback& offset() const noexcept { return offset_; }

 private:
  std::int64_t wanted_samples_;
  RigFeedback mean_;
  RigFeedback offset_;
  std::int64_t samples_ = 0;
  bool has_offset_ = false;
};

}  // namespace hybridtest
