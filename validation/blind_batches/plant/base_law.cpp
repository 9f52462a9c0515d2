#include "validation/blind_batches/plant/base_law.hpp"

#include <algorithm>
#include <cmath>

namespace hybridtest::blind {
namespace {

/// An elastic-plastic spring (the plastic slip is the state) beside an elastic one.
History bilinear(const LawModel& law, const History& x, const History& yield_share) {
  const double plastic_stiffness = (1.0 - law.hardening_ratio) * law.stiffness_n_per_m;
  History force(x.size());
  double slip = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double share = yield_share.empty() ? 1.0 : yield_share[i];
    const double reach = share * law.yield_force_n / law.stiffness_n_per_m;
    slip = std::clamp(slip, x[i] - reach, x[i] + reach);
    force[i] = plastic_stiffness * (x[i] - slip) + law.hardening_ratio * law.stiffness_n_per_m * x[i];
  }
  return force;
}

/// z' = x' (ao - (gamma + beta sign(z x')) |z|) along a stretch in one direction; turned so that
/// the direction is positive: z' = ao - s z for z > 0, ao - (beta - gamma) z for z < 0.
double bouc_wen_along(const LawModel& law, double z, double path) {
  const double closing = law.beta_per_m - law.gamma_per_m;
  if (z < 0.0) {
    const double to_zero = std::abs(closing * z) < 1e-9 ? -z : std::log1p(-closing * z) / closing;
    if (path <= to_zero) {
      return std::abs(closing) < 1e-9 ? z + path : (z - 1.0 / closing) * std::exp(-closing * path) + 1.0 / closing;
    }
    path -= to_zero;
    z = 0.0;
  }
  const double opening = law.beta_per_m + law.gamma_per_m;
  return (z - 1.0 / opening) * std::exp(-opening * path) + 1.0 / opening;
}

History bouc_wen(const LawModel& law, const History& x) {
  History force(x.size());
  double z = 0.0;
  double previous = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double direction = x[i] < previous ? -1.0 : 1.0;
    z = direction * bouc_wen_along(law, direction * z, std::abs(x[i] - previous));
    previous = x[i];
    force[i] = law.stiffness_n_per_m * (law.alpha * x[i] + (1.0 - law.alpha) * z);
  }
  return force;
}

/// State of a Giuffre-Menegotto-Pinto spring between two reversals.
struct Curve {
  double from_x = 0.0;
  double from_f = 0.0;
  double corner_x = 0.0;
  double r = 1.0;
};

class SteelSpring {
 public:
  explicit SteelSpring(const LawModel& law)
      : law_{law}, yield_m_{law.yield_force_n / law.stiffness_n_per_m}, extreme_{-yield_m_, yield_m_} {}

  double force(double x) {
    const int heading = x > x_ ? 1 : x < x_ ? -1 : heading_;
    if (heading != heading_) turn(heading);
    x_ = x;
    f_ = on_curve(x);
    return f_;
  }

 private:
  void turn(int heading) {
    heading_ = heading;
    extreme_[0] = std::min(extreme_[0], x_);
    extreme_[1] = std::max(extreme_[1], x_);
    const double b = law_.hardening_ratio;
    curve_.from_x = x_;
    curve_.from_f = f_;
    // Elastic line from here: f + k (c - x); asymptote: b k c +- (1 - b) Fy.
    curve_.corner_x = (law_.stiffness_n_per_m * x_ - f_ + heading * (1.0 - b) * law_.yield_force_n) /
                      ((1.0 - b) * law_.stiffness_n_per_m);
    const double xi = std::abs(extreme_[heading > 0 ? 1 : 0] - curve_.corner_x) / yield_m_;
    curve_.r = law_.r0 * (1.0 - law_.cr1 * xi / (law_.cr2 + xi));
  }

  [[nodiscard]] double on_curve(double x) const {
    const double along = x - curve_.from_x;
    if (along == 0.0) return curve_.from_f;
    const double reach = curve_.corner_x - curve_.from_x;
    if (reach == 0.0) return curve_.from_f + law_.hardening_ratio * law_.stiffness_n_per_m * along;
    // log of (1 + q^R)^(1/R) without overflow.
    const double q = std::log(std::abs(along / reach));
    const double rounding = std::exp(std::max(0.0, q) + std::log1p(std::exp(-curve_.r * std::abs(q))) / curve_.r);
    return curve_.from_f +
           law_.stiffness_n_per_m * along * (law_.hardening_ratio + (1.0 - law_.hardening_ratio) / rounding);
  }

  LawModel law_;
  double yield_m_;
  double extreme_[2];
  Curve curve_;
  int heading_ = 0;
  double x_ = 0.0;
  double f_ = 0.0;
};

History steel(const LawModel& law, const History& x) {
  SteelSpring spring{law};
  History force(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) force[i] = spring.force(x[i]);
  return force;
}

}  // namespace

History law_force(const LawModel& law, const History& displacement_m, const History& yield_share) {
  switch (law.kind) {
    case LawKind::none: break;
    case LawKind::elastic: {
      History force(displacement_m.size(), 0.0);
      add(force, displacement_m, law.stiffness_n_per_m);
      return force;
    }
    case LawKind::bilinear: return bilinear(law, displacement_m, yield_share);
    case LawKind::giuffre_menegotto_pinto: return steel(law, displacement_m);
    case LawKind::bouc_wen: return bouc_wen(law, displacement_m);
  }
  return History(displacement_m.size(), 0.0);
}

}  // namespace hybridtest::blind
