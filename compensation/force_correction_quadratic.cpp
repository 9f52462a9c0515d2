#include "compensation/force_correction_quadratic.hpp"

#include <cmath>

#include "core/parameters/parameter_checker.hpp"

namespace hybridtest {
namespace {

QuadraticFit checked_fit(const ForceCorrectionQuadratic::Parameters& parameters, double control_period_s) {
  const std::size_t spacing = checked_periods("point_spacing_s", checked(parameters).point_spacing_s,
                                              checked_control_period(control_period_s), 1, "the points are samples");
  return {static_cast<std::size_t>(parameters.points), spacing, control_period_s};
}

}  // namespace

ForceCorrectionQuadratic::ForceCorrectionQuadratic(const Parameters& parameters, double control_period_s)
    : fit_{checked_fit(parameters, control_period_s)}, displacements_m_{fit_.span()}, forces_n_{fit_.span()} {}

double ForceCorrectionQuadratic::corrected_force(const ForceSample& sample) noexcept {
  displacements_m_.push(sample.measured_displacement_m);
  forces_n_.push(sample.measured_force_n);
  const Quadratic displacement = fit_.fit(displacements_m_);
  const Quadratic force = fit_.fit(forces_n_);

  const double c = displacement.constant - sample.desired_displacement_m;
  const double discriminant = displacement.linear * displacement.linear - 4.0 * displacement.square * c;
  if (discriminant < 0.0) return sample.measured_force_n;
  // The root of smaller magnitude, without the cancellation of the textbook formula.
  const double q = -0.5 * (displacement.linear + std::copysign(std::sqrt(discriminant), displacement.linear));
  return q == 0.0 ? sample.measured_force_n : force.at(c / q);
}

void ForceCorrectionQuadratic::reset() noexcept {
  displacements_m_.clear();
  forces_n_.clear();
}

}  // namespace hybridtest
