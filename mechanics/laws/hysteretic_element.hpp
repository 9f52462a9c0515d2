#pragma once

#include <cmath>

namespace hybridtest {

/// Smooth hysteresis z between -1 and 1, after Bouc and Wen with the exponent 2 and equal parts of gamma and beta:
///
///     dz = (1 - 0.5 (1 + sign(z dx)) z^2) dx / xh
///
/// which is solved in closed form: z falls straight to zero after a reversal and from there grows as tanh(x / xh).
/// Independent of the step.
class HystereticElement {
 public:
  /// @param displacement_m   xh, one over the slope of z at zero; positive.
  explicit HystereticElement(double displacement_m) : length_m_{displacement_m} {}

  /// z at a displacement, reached one way from the one before.
  [[nodiscard]] double share(double displacement_m) noexcept {
    double way = (displacement_m - displacement_m_) / length_m_;
    displacement_m_ = displacement_m;
    if (share_ * way < 0.0) {
      if (std::abs(way) <= std::abs(share_)) return share_ += way;
      way += share_;
      share_ = 0.0;
    }
    const double grown = std::tanh(way);
    return share_ = (share_ + grown) / (1.0 + share_ * grown);  // tanh(artanh(z) + way)
  }
  void reset() noexcept { share_ = displacement_m_ = 0.0; }

 private:
  double length_m_;
  double share_ = 0.0;
  double displacement_m_ = 0.0;
};

}  // namespace hybridtest
