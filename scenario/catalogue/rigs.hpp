#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/config/section.hpp"
#include "core/records.hpp"
#include "experimental_site/rigs/rig.hpp"
#include "numerical_substructure/substructure_model.hpp"
#include "scenario/catalogue/rig_rating.hpp"

namespace hybridtest {

/// What the preflight needs to know of a rig besides how to make it.
struct RigReading {
  std::string type;
  std::function<std::unique_ptr<Rig>(double control_period_s)> make;
  std::vector<double> transfer_delay_s;  // at low frequency, of each actuator
  /// Stiffness over the actuators of a simulated specimen without its effects: the secant from rest to a displacement
  /// of this size at one actuator after the other. Empty when it is not known before the test.
  std::function<Eigen::MatrixXd(double displacement_m)> stiffness_n_per_m;
  /// The same rig as a linear one without noise and effects, over the actuators: its transfer systems, and a specimen
  /// of its own stiffness as above or, where that is not known, of the stiffness given.
  std::function<std::unique_ptr<Rig>(double control_period_s, double displacement_m, const Eigen::MatrixXd& given)>
      make_linear = {};
  /// The simulated specimen alone, without its effects, as a model over the interface. Empty where there is none, and
  /// behind a geometry.
  std::function<std::unique_ptr<SubstructureModel>()> make_specimen = {};
  bool follows_commands = true;  // false: nothing there tracks a target
  double silence_s_max = 0.0;    // for so long readings may fail to come without a fault
  RigRating rating;
  double displacement_noise_m = 0.0;       // standard deviations of the readings, where they are known
  double force_noise_n = 0.0;              // likewise
  double displacement_resolution_m = 0.0;  // of coarse readings
  bool force_always_varies = true;         // false: a sound reading may be the same to the last bit during motion
  bool is_elsewhere = false;               // outside the process that makes it: not under simulated time
  bool keeps_time = false;                 // by a clock of its own: not in lockstep
  // Of effects that follow an input, which a simulated rig does not have: `current_a at 1`.
  std::vector<std::string> nominal_inputs;
  std::vector<TableLayout> tables;  // that it records by itself, see Rig::record_to()
};

/// @param directory   where files that it names are looked for.
/// @param site        counts the sites of a test, so that no two of one seed have the same noise.
[[nodiscard]] RigReading read_rig(config::Section section, int dofs, const std::filesystem::path& directory, int site);

}  // namespace hybridtest
