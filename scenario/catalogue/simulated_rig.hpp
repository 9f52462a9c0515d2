#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "core/config/section.hpp"
#include "plant/site_model.hpp"
#include "plant/specimens/specimen.hpp"
#include "scenario/catalogue/rigs.hpp"

namespace hybridtest {

/// What a section says of a simulated site: transfer systems, specimen, sensors, effects.
struct SimulatedSiteReading {
  std::vector<SiteModel> dofs;                                     // one per interface degree of freedom
  std::function<std::unique_ptr<Specimen>()> make_full_stiffness;  // of a specimen that couples them; else empty
  bool is_in_transfer_systems = false;                             // the specimen is part of their models
  std::vector<double> transfer_delay_s;                            // at low frequency, of each actuator
  RigRating rating;                                                // of the weakest actuator
};

/// What is meant where `transfer_system` or `specimen` are left out.
enum class AbsentPart { refused, ideal };

[[nodiscard]] SimulatedSiteReading read_simulated_site(config::Section& section, int dofs, AbsentPart absent);

/// The rest of a rig's section of `type: simulated`.
/// @param first_noise_stream   two for each actuator from here on.
[[nodiscard]] RigReading read_simulated_rig(config::Section& section, int dofs, std::uint64_t first_noise_stream,
                                            AbsentPart absent = AbsentPart::refused);

}  // namespace hybridtest
