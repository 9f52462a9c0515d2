#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "core/faults.hpp"
#include "validation/studies/study_progress.hpp"

/// The two-storey, two-actuator test on which four methods of delay compensation were compared
/// (Mangkalakiri, Mosqueda and Ahmadizadeh, 2006), simulated with the nodes of a real test.
namespace hybridtest::founding {

inline constexpr std::size_t kFloors = 2;
inline constexpr std::size_t kActuators = 2;

/// One scenario of the study.
struct Method {
  const char* name;    // of the scenario file, without its extension
  const char* figure;  // its place in the study
};

/// In the order of the study's figures; the exact specimen first.
inline constexpr std::array<Method, 7> kMethods{{
    {"exact", "the exact specimen"},
    {"uncompensated", "figure 9"},
    {"polynomial_displacement", "figure 10"},
    {"polynomial_force", "figure 11"},
    {"newmark_kinematics", "figure 12"},
    {"force_correction_quadratic", "figure 13"},
    {"force_correction", "figure 13 without its jumps"},
}};

/// The results of one scenario.
struct MethodRun {
  std::string name;
  StopReason reason = StopReason::none;
  std::string interlock;                                    // the text of the interlock that tripped; empty if none did
  std::vector<double> time_s;                               // each step
  std::array<std::vector<double>, kFloors> displacement_m;  // by floor, each step
  std::vector<double> period_time_s;                        // each control period
  std::array<std::vector<double>, kActuators> force_n;      // received by the integrator, each control period
  std::vector<double> energy_error_j;                       // each control period; negative: added by the delay
};

/// Runs one scenario of the study in this thread under simulated time.
/// @throws ConfigError as read_scenario().
[[nodiscard]] MethodRun run_method(const std::filesystem::path& scenario_file);

/// Every method, the exact specimen first.
/// @param scenarios   the directory with `<name>.yaml` of each.
[[nodiscard]] std::vector<MethodRun> run_founding_study(const std::filesystem::path& scenarios, unsigned threads,
                                                        StudyProgress& progress);

}  // namespace hybridtest::founding
