#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "coordinator/coordinator.hpp"
#include "coordinator/force_bridge.hpp"
#include "core/messages.hpp"
#include "core/real_time_thread.hpp"
#include "experimental_site/control_loop.hpp"
#include "experimental_site/interlocks.hpp"
#include "experimental_site/rigs/rig.hpp"
#include "mechanics/structure/interface_map.hpp"
#include "mechanics/structure/linear_structure.hpp"
#include "numerical_substructure/substructure_model.hpp"
#include "scenario/catalogue/integrators.hpp"
#include "scenario/catalogue/rig_rating.hpp"
#include "scenario/excitation_section.hpp"
#include "scenario/loop_sections.hpp"
#include "scenario/opensees_section.hpp"
#include "scenario/structure_section.hpp"

namespace hybridtest {

/// Model time of a test and how it relates to the wall.
struct TimeScenario {
  CouplingMode mode = CouplingMode::lockstep;
  double step_s = 0.0;
  double duration_s = 0.0;
  double time_scale = 1.0;
  Step last_step = 0;
};

/// Of a test in real time, besides its sites.
struct RealTimeScenario {
  BridgingSettings bridging;
  RealTimeRequest coordinator;  // what its thread requests
};

struct TimeoutScenario {
  Duration discovery{};
  Duration arm{};
  Duration stop{};
  Duration liveliness_lease{};
  Duration link{};    // how long a test waits for a link that is down; zero: no longer than the lease
  Duration resume{};  // for which the others wait for a resumed coordinator; 0: they end the test

  /// Of a participant that sends nothing.
  [[nodiscard]] Duration silence_most() const noexcept { return std::max(liveliness_lease, link); }
};

/// Delay of the force at one interface degree of freedom, for the preflight. [s]
struct ForceDelay {
  double transfer_s = 0.0;       // of the rig at low frequency
  double after_command_s = 0.0;  // that the compensator of the command leaves; negative: ahead of the target
  double remaining_s = 0.0;      // that the compensator of the force leaves of it
  bool is_learnt = false;        // during the test: these are the values at its start
  double moved_s = 0.0;          // what a force compensator that is not linear makes up for
  double further_s = 0.0;        // how much more it could
};

/// A learnt delay, for the preflight.
enum class LearntDelay { initial, smallest, largest };

/// What an experimental substructure adds: the site.
struct SiteScenario {
  double control_rate_hz = 0.0;
  int periods_per_step = 1;  // the control rate, rounded up so that whole periods fill a step
  LoopScenario loop;
  std::string rig_type;
  bool rig_is_elsewhere = false;        // outside the site's process: not under simulated time
  std::vector<TableLayout> rig_tables;  // that the rig records by itself
  RigRating rating;
  double displacement_noise_m = 0.0;        // standard deviations of the readings, where they are known
  double force_noise_n = 0.0;               // likewise
  std::vector<std::string> nominal_inputs;  // of a simulated rig, see RigReading
  bool has_model = false;                   // of the site, beside its rig: what a diagnosis of the run compares with
  std::vector<ForceDelay> delays;           // one per interface degree of freedom
  bool has_estimator = false;               // a delay is estimated within bounds
  /// Stiffness of a simulated specimen over the interface, see RigReading. Empty when it is not known.
  std::function<Eigen::MatrixXd(double displacement_m)> specimen_stiffness_n_per_m;
};

struct SubstructureScenario {
  std::string id;
  Role role = Role::numerical_substructure;
  InterfaceMap interface;
  RealTimeRequest real_time;                 // of the control loop of a site; of the node, in real time
  std::vector<std::string> interface_names;  // `floor_2_floor_1` for relative ones
  /// Positions in the interface that a numerical substructure records: all, or of a wide interface those of `output`.
  std::vector<Eigen::Index> recorded;
  Eigen::MatrixXd initial_stiffness_n_per_m;
  /// Names of `recorded`.
  [[nodiscard]] std::vector<std::string> recorded_names() const;
  // Makers of the parts, called in the process that needs them.
  std::function<std::unique_ptr<SubstructureModel>()> make_model;  // numerical
  SiteScenario site;                                               // experimental, and below
  /// @param control_period_s   in site time.
  std::function<std::unique_ptr<Rig>(double control_period_s)> make_rig;
  std::function<SiteCompensation(double control_period_s)> make_compensation;
  /// The substructure itself, for a test without coupling: the model or, of a site, the simulated specimen of its rig
  /// or of the `model` beside it. Empty where neither is known.
  std::function<std::unique_ptr<SubstructureModel>()> make_reference;
  std::function<std::unique_ptr<Rig>(double control_period_s)> make_model_rig;  // by `model`; empty without one
  // The same for the preflight: linear, see RigReading::make_linear. Force compensators that are not linear are left
  // out, see ForceDelay::moved_s.
  std::function<std::unique_ptr<Rig>(double control_period_s, double displacement_m)> make_linear_rig;
  std::function<SiteCompensation(double control_period_s, LearntDelay learnt)> make_linear_compensation;
};

/// A scenario file, read, checked and ready to be composed.
struct Scenario {
  std::filesystem::path file;
  std::string name;
  TimeScenario time;
  RealTimeScenario real_time;
  TimeoutScenario timeouts;
  bool stop_on_recording_failure = false;
  std::vector<std::string> dofs;
  LinearStructure structure;                // initial stiffness assembled from its own and that of the substructures
  std::vector<Eigen::Index> recorded_dofs;  // rows of those in the coordinator's record, ascending
  ExcitationScenario excitation;
  IntegratorReading integrator;
  double integrator_step_s = 0.0;                                // that of the test, but for the effect `step_mismatch`
  std::function<std::unique_ptr<Integrator>()> make_integrator;  // empty where OpenSees leads
  /// OpenSees leads: structure, excitation and integrator are in its model, and here the structure has no mass.
  std::optional<OpenSeesLeadScenario> opensees;
  std::vector<SubstructureScenario> substructures;
  std::vector<NamedFile> files;  // that it names, but those of rigs and models
  std::string effective;         // with defaults filled in
  ScenarioDigest digest{};

  /// Names of `recorded_dofs`.
  [[nodiscard]] std::vector<std::string> recorded_names() const;
  [[nodiscard]] double model_time_s(Step step) const noexcept { return static_cast<double>(step) * time.step_s; }
  /// nullptr when there is none.
  [[nodiscard]] const SubstructureScenario* find(std::string_view id) const noexcept;
  [[nodiscard]] SubstructureIndex index_of(const SubstructureScenario& substructure) const noexcept;
};

/// Of a site, as the scenario says.
[[nodiscard]] ControlLoopSettings control_loop_settings(const Scenario& scenario,
                                                        const SubstructureScenario& substructure);

/// Names of tests become names of folders and of DDS partitions.
inline constexpr std::string_view kTestNameRule = "1 to 64 letters, digits, '_', '-' or '.', the first not a '.'";
[[nodiscard]] bool is_test_name(std::string_view name) noexcept;

/// @param overrides   `key.path=value`, as given to --set.
/// @throws ConfigError with everything that is wrong.
[[nodiscard]] Scenario read_scenario(const std::filesystem::path& file, const std::vector<std::string>& overrides);

}  // namespace hybridtest
