#pragma once

#include <cstdint>

#include "core/interface_vector.hpp"

namespace hybridtest {

struct ClosingMotionSettings {
  double period_s = 0.0;
  double halt_s = 0.0;         // time from moving to standing
  double return_time_s = 0.0;  // from there to zero; longer where the velocity limit requires it
  double displacement_limit_m = 0.0;
  double velocity_limit_m_per_s = 0.0;
};

/// The last motion of a site. It stops with constant deceleration. Then it returns to zero along a
/// raised cosine that stays below half the velocity limit, or stays where it stopped. Position and
/// velocity are continuous if begin() gets the velocity of the site. Real-time safe.
class ClosingMotion {
 public:
  ClosingMotion(const ClosingMotionSettings& settings, int dofs) noexcept;

  /// @param velocity_m_per_s   zero: the return starts at once, as after an interlock.
  void begin(const SiteVector& displacement_m, const SiteVector& velocity_m_per_s, bool returns) noexcept;

  /// Moves on by one control period.
  void advance() noexcept;

  [[nodiscard]] const SiteVector& displacement_m() const noexcept { return displacement_m_; }
  [[nodiscard]] bool is_over() const noexcept { return period_ >= halt_periods_ + return_periods_; }

 private:
  void halt() noexcept;
  void begin_return() noexcept;

  ClosingMotionSettings settings_;
  bool returns_ = true;
  SiteVector begin_m_;
  SiteVector velocity_m_per_s_;
  SiteVector displacement_m_;
  std::int64_t halt_periods_ = 0;
  std::int64_t return_periods_ = 0;
  std::int64_t period_ = 0;
};

}  // namespace hybridtest
