#include "mechanics/laws/takeda.hpp"

#include "core/parameters/parameter_checker.hpp"

namespace hybridtest {

Takeda::Takeda(const Parameters& parameters)
    : DeterioratingHysteresis{{.stiffness_n_per_m = checked(parameters).stiffness_n_per_m,
                               .yield_force_n = parameters.yield_force_n,
                               .hardening_ratio = parameters.hardening_ratio},
                              {.cracking_force_n = parameters.cracking_force_n,
                               .cracked_n_per_m = parameters.cracked_ratio * parameters.stiffness_n_per_m,
                               .unloading_exponent = parameters.unloading_exponent}} {
  expect_in_range("cracking_force_n", parameters.cracking_force_n,
                  {.low = 0.0, .high = parameters.yield_force_n, .high_open = true}, "cracking comes before yielding");
}

}  // namespace hybridtest
