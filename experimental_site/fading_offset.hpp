#pragma once

#include "core/interface_vector.hpp"

namespace hybridtest {

/// An offset that decays to zero along a cubic, from an initial displacement and velocity to zero
/// displacement and zero velocity. Added to a path that does not begin at the position of the
/// actuators, it avoids a step in position and velocity. Real-time safe.
class FadingOffset {
 public:
  explicit FadingOffset(int dofs) noexcept;

  /// @param duration_s   above 0.
  void begin(const SiteVector& displacement_m, const SiteVector& velocity_m_per_s, double duration_s) noexcept;
  void end() noexcept;
  void advance(double interval_s) noexcept;

  /// Exactly zero after the duration.
  [[nodiscard]] const SiteVector& displacement_m() const noexcept { return displacement_m_; }
  [[nodiscard]] const SiteVector& velocity_m_per_s() const noexcept { return velocity_m_per_s_; }
  [[nodiscard]] bool is_over() const noexcept { return is_over_; }

 private:
  void evaluate() noexcept;

  double duration_s_ = 1.0;
  double since_s_ = 0.0;
  bool is_over_ = true;
  SiteVector begin_displacement_m_;
  SiteVector begin_velocity_m_per_s_;
  SiteVector displacement_m_;
  SiteVector velocity_m_per_s_;
};

}  // namespace hybridtest
