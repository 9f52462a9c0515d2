#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "coordinator/integrators/integrator.hpp"
#include "mechanics/structure/linear_structure.hpp"
#include "scenario/catalogue/part.hpp"

namespace hybridtest {

/// The integrator that a file names.
struct IntegratorReading {
  std::string type;
  std::string text;    // the type with its parameters, for messages: `kr_alpha with rho_inf 0.8`
  std::string source;  // that the method is from
  IntegratorNeeds needs;
  std::function<std::unique_ptr<Integrator>(const LinearStructure& structure, double step_s,
                                            const InitialMotion& initial)>
      make;
};

/// Every integrator that a file can name.
[[nodiscard]] const std::vector<PartType<IntegratorReading>>& integrators();

[[nodiscard]] IntegratorReading read_integrator(config::Section section);

}  // namespace hybridtest
