#pragma once

#include <algorithm>

namespace hybridtest {

/// Share of a dry friction that acts, with the sign of the motion: elastoplastic, so that the force goes
/// with the displacement since the last reversal until that reaches the pre-sliding displacement
/// (Dahl, The Aerospace Corporation TOR-0158, 1968, with the exponent 0). It holds at rest and needs
/// no sign of a noisy velocity.
class PreslidingElement {
 public:
  /// @param presliding_displacement_m   from rest until it slides; positive.
  explicit PreslidingElement(double presliding_displacement_m)
      : presliding_displacement_m_{presliding_displacement_m} {}

  /// -limit to limit. Called once per sample.
  /// @param limit   at which it slides now, over that of which the pre-sliding displacement was given.
  [[nodiscard]] double share(double displacement_m, double limit = 1.0) noexcept {
    share_ = std::clamp(share_ + (displacement_m - displacement_m_) / presliding_displacement_m_, -limit, limit);
    displacement_m_ = displacement_m;
    return share_;
  }
  void reset() noexcept { share_ = displacement_m_ = 0.0; }

 private:
  double presliding_displacement_m_;
  double share_ = 0.0;
  double displacement_m_ = 0.0;
};

}  // namespace hybridtest
