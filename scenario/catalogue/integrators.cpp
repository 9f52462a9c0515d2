#include "scenario/catalogue/integrators.hpp"

#include <vector>

#include "coordinator/central_difference.hpp"
#include "coordinator/explicit_newmark.hpp"

namespace hybridtest {

std::string read_integrator_type(config::Section section) {
  const std::vector<std::string> names{"central_difference", "explicit_newmark"};
  std::string type = names[section.choice("type", names)];
  section.finish();
  return type;
}

std::unique_ptr<Integrator> make_integrator(std::string_view type, const LinearStructure& structure, double step_s) {
  if (type == "explicit_newmark") return std::make_unique<ExplicitNewmark>(structure, step_s);
  return std::make_unique<CentralDifference>(structure, step_s);
}

}  // namespace hybridtest
