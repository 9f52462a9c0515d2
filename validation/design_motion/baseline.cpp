#include "validation/design_motion/baseline.hpp"

#include <cmath>
#include <cstddef>
#include <numbers>

namespace hybridtest::design_motion {
namespace {

struct Motion {
  std::vector<double> velocity_m_per_s;
  std::vector<double> displacement_m;
};

Motion integrate(const std::vector<double>& acceleration, double dt_s) {
  Motion motion;
  motion.velocity_m_per_s.assign(acceleration.size(), 0.0);
  motion.displacement_m.assign(acceleration.size(), 0.0);
  for (std::size_t i = 1; i < acceleration.size(); ++i) {
    const double begin = acceleration[i - 1];
    const double end = acceleration[i];
    motion.velocity_m_per_s[i] = motion.velocity_m_per_s[i - 1] + 0.5 * dt_s * (begin + end);
    motion.displacement_m[i] =
        motion.displacement_m[i - 1] + dt_s * motion.velocity_m_per_s[i - 1] + dt_s * dt_s * (begin / 3.0 + end / 6.0);
  }
  return motion;
}

std::vector<double> correction_shape(std::size_t count, bool is_late) {
  std::vector<double> shape(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double place = static_cast<double>(i) / static_cast<double>(count - 1);
    const double sine = std::sin(std::numbers::pi * place);
    shape[i] = sine * sine * (is_late ? place : 1.0);
  }
  return shape;
}

}  // namespace

std::vector<double> velocity_m_per_s(const std::vector<double>& acceleration_m_per_s2, double dt_s) {
  return integrate(acceleration_m_per_s2, dt_s).velocity_m_per_s;
}

std::vector<double> displacement_m(const std::vector<double>& acceleration_m_per_s2, double dt_s) {
  return integrate(acceleration_m_per_s2, dt_s).displacement_m;
}

void remove_drift(std::vector<double>& acceleration_m_per_s2, double dt_s) {
  const Motion motion = integrate(acceleration_m_per_s2, dt_s);
  const auto even = correction_shape(acceleration_m_per_s2.size(), false);
  const auto late = correction_shape(acceleration_m_per_s2.size(), true);
  const Motion by_even = integrate(even, dt_s);
  const Motion by_late = integrate(late, dt_s);
  const double v = motion.velocity_m_per_s.back();
  const double u = motion.displacement_m.back();
  const double v1 = by_even.velocity_m_per_s.back();
  const double v2 = by_late.velocity_m_per_s.back();
  const double u1 = by_even.displacement_m.back();
  const double u2 = by_late.displacement_m.back();
  const double determinant = v1 * u2 - v2 * u1;
  const double of_even = (-v * u2 + u * v2) / determinant;
  const double of_late = (-u * v1 + v * u1) / determinant;
  for (std::size_t i = 0; i < acceleration_m_per_s2.size(); ++i) {
    acceleration_m_per_s2[i] += of_even * even[i] + of_late * late[i];
  }
}

}  // namespace hybridtest::design_motion
