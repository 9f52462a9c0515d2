#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "coordinator/excitation/applied_load.hpp"
#include "coordinator/excitation/motion_correction.hpp"
#include "core/config/section.hpp"
#include "core/ground_motion_facts.hpp"
#include "core/messages.hpp"
#include "mechanics/structure/interface_map.hpp"
#include "mechanics/structure/linear_structure.hpp"
#include "scenario/free_vibration_section.hpp"
#include "scenario/structure_section.hpp"

namespace hybridtest {

/// One ground motion of a test, as it is applied.
struct GroundRecord {
  std::string text;            // the file as written in the scenario, or `harmonic`, for people
  std::filesystem::path file;  // empty for a generated motion
  GroundMotionFacts facts;     // scaled and corrected
  MotionEnd end_as_read;       // scaled, without the corrections
  MotionEnd end;               // as applied, at the end of the record
  bool is_corrected = false;
  std::optional<double> factor_found;         // by scale_to
  std::string support;                        // which it moves alone; empty: all of them together
  Eigen::VectorXd influence;                  // displacement of each degree of freedom per unit of ground displacement
  std::vector<double> acceleration_m_per_s2;  // at each step
};

/// One force history with where it acts.
struct AppliedForce {
  std::string text;  // for people
  double peak_n = 0.0;
  ForceLoad load;
};

/// What the section `excitation` says.
struct ExcitationScenario {
  std::vector<GroundRecord> records;
  std::vector<AppliedForce> forces;
  std::optional<FreeVibration> free_vibration;

  /// The step from which the integrator decides and at which records and forces begin; 0 without a ramp before it.
  [[nodiscard]] Step release_step() const noexcept;
  /// @param structure   its mass decides the load of a ground motion.
  [[nodiscard]] AppliedLoad load(const LinearStructure& structure) const;
  /// Applied in steps of the test: zero before the release, and without what comes after the end of the test.
  [[nodiscard]] GroundMotion applied_motion(const GroundRecord& record, double step_s) const;
};

/// Reads the section; reports what is wrong at its key.
/// @param directory   relative paths start there.
/// @param files       gets those that the section names.
[[nodiscard]] ExcitationScenario read_excitation(config::Section section, const DofTable& dofs, const TestSteps& test,
                                                 const std::filesystem::path& directory, std::vector<NamedFile>& files);

/// Reads the key `support` of an interface degree of freedom, which only supports that move on their own need, and
/// reports a motion of a support that would strain the substructure by itself: the test computes displacements
/// relative to the supports, and leaves that part out.
/// @param key   of the entry that names the degree of freedom.
void read_interface_support(config::Section& entry, std::string_view key, const InterfaceDof& interface,
                            const ExcitationScenario& excitation);

}  // namespace hybridtest
