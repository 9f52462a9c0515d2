#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "coordinator/integrator.hpp"
#include "core/config/section.hpp"
#include "mechanics/structure/linear_structure.hpp"

namespace hybridtest {

/// @return the type's name, for make_integrator().
[[nodiscard]] std::string read_integrator_type(config::Section section);
[[nodiscard]] std::unique_ptr<Integrator> make_integrator(std::string_view type, const LinearStructure& structure,
                                                          double step_s);

}  // namespace hybridtest
