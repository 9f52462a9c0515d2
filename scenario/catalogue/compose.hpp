#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "compensation/compensator.hpp"
#include "compensation/delay_setting.hpp"
#include "compensation/force_compensator.hpp"
#include "coordinator/integrator.hpp"
#include "core/config/section.hpp"
#include "core/records.hpp"
#include "core/time.hpp"
#include "experimental_site/rigs/rig.hpp"
#include "mechanics/laws/law.hpp"
#include "mechanics/structure/linear_structure.hpp"
#include "numerical_substructure/substructure_model.hpp"
#include "plant/transfer_systems/transfer_system.hpp"

/// The explicit tables of what a scenario can name: integrators, laws, models, transfer systems,
/// specimens, compensators, rigs. Each reader checks the parameters of its section, reports what
/// is wrong there, and returns a maker; makers are called only when nothing was wrong.
namespace hybridtest {

template <class Part>
using Maker = std::function<std::unique_ptr<Part>()>;

/// Reports at `key` when not one was found for each interface degree of freedom.
void expect_count(config::Section& section, std::string_view key, std::size_t found, int expected);

[[nodiscard]] Maker<Law> read_law(config::Section section);
/// A law or `none`, which is an empty maker: a specimen without a force of its own.
[[nodiscard]] Maker<Law> read_specimen_law(config::Section section);

/// The model of a numerical substructure with `dofs` interface degrees of freedom.
[[nodiscard]] Maker<SubstructureModel> read_model(config::Section section, int dofs,
                                                  const std::filesystem::path& directory);

/// What the preflight needs to know of a rig or compensator besides how to make it.
struct RigReading {
  std::string type;
  std::function<std::unique_ptr<Rig>(double control_period_s)> make;
  double transfer_delay_s = 0.0;    // at low frequency, of a simulated rig's slowest actuator
  bool is_elsewhere = false;        // outside the process that makes it: not under simulated time
  bool keeps_time = false;          // by a clock of its own: not in lockstep
  std::vector<TableLayout> tables;  // that it records by itself, see Rig::record_to()
};
/// @param directory   where files that it names are looked for.
/// @param site        counts the sites of a test, so that no two of one seed have the same noise.
[[nodiscard]] RigReading read_rig(config::Section section, int dofs, const std::filesystem::path& directory, int site);

struct CompensatorReading {
  /// @param delay_change_s   added to its setting; 0 where it has none that `setting` speaks of.
  std::function<std::unique_ptr<Compensator>(double control_period_s, double delay_change_s)> make;
  double delay_s = 0.0;  // that it makes up for
  DelaySetting setting = {};
};
/// `none` when no type is given.
[[nodiscard]] CompensatorReading read_compensator(config::Section section);

using ForceCompensatorMaker = std::function<std::unique_ptr<ForceCompensator>(double control_period_s)>;
/// `none` when no type is given.
[[nodiscard]] ForceCompensatorMaker read_force_compensator(config::Section section);

/// @return the type's name, for make_integrator().
[[nodiscard]] std::string read_integrator_type(config::Section section);
[[nodiscard]] std::unique_ptr<Integrator> make_integrator(std::string_view type, const LinearStructure& structure,
                                                          double step_s);

}  // namespace hybridtest
