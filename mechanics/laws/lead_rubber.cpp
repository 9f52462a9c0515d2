#include "mechanics/laws/lead_rubber.hpp"

#include <algorithm>
#include <cmath>

#include "core/parameters/parameter_checker.hpp"

namespace hybridtest {

LeadRubber::LeadRubber(const Parameters& parameters) : parameters_{checked(parameters)} {}

double LeadRubber::initial_stiffness_n_per_m() const noexcept {
  return parameters_.rubber_stiffness_n_per_m + parameters_.lead_strength_n / parameters_.yield_displacement_m;
}

double LeadRubber::trial(double displacement_m, double /*velocity_m_per_s*/) noexcept {
  const double elastic_m = committed_.elastic_m + (displacement_m - committed_.displacement_m);
  trial_.displacement_m = displacement_m;
  trial_.path_m = path_after(std::abs(elastic_m));
  trial_.elastic_m = elastic_m - std::copysign(trial_.path_m - committed_.path_m, elastic_m);
  return parameters_.rubber_stiffness_n_per_m * displacement_m +
         parameters_.lead_strength_n / parameters_.yield_displacement_m * trial_.elastic_m;
}

/// Plastic path after the step, where all of it would be elastic if the lead were strong enough: the elastic part that
/// is left is what the strength after this path holds, a quadratic equation.
double LeadRubber::path_after(double elastic_m) const noexcept {
  const double yield_m = parameters_.yield_displacement_m;
  const double half_m = parameters_.heating_path_m;
  const double before_m = committed_.path_m;
  if (half_m == 0.0) return before_m + std::max(0.0, elastic_m - yield_m);
  if (elastic_m <= yield_m / (1.0 + before_m / half_m)) return before_m;
  const double whole_m = elastic_m + before_m;
  const double difference_m = whole_m - half_m;
  return 0.5 * (difference_m + std::sqrt(difference_m * difference_m + 4.0 * half_m * (whole_m - yield_m)));
}

}  // namespace hybridtest
