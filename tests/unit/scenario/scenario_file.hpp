#pragma once

#include <fstream>
#include <string>
#include <vector>

#include "core/config_error.hpp"
#include "scenario/scenario.hpp"
#include "tests/unit/recording/temporary_directory.hpp"

namespace hybridtest {

/// A sound scenario with every kind of section; tests replace parts of its text.
inline constexpr const char* kScenarioText = R"(schema: hybridtest/1
name: sound
time: {mode: lockstep, step_s: 0.001, duration_s: 0.1}
excitation: {ground_motion: motion.txt, scale: 1.0}
structure:
  degrees_of_freedom: [floor_1, floor_2]
  mass_kg: {floor_1: 20.0e3, floor_2: 20.0e3}
  damping: {type: rayleigh, ratio: 0.02, modes: [1, 2]}
integrator: {type: central_difference}
substructures:
  - id: storey_1
    kind: experimental
    interface: [{dof: floor_1}]
    initial_stiffness_n_per_m: [[4.0e6]]
    rig:
      type: simulated
      transfer_system: {type: second_order, natural_frequency_hz: 15.0, damping_ratio: 0.9, delay_s: 0.004}
      specimen: {type: bilinear, stiffness_n_per_m: 4.0e6, yield_force_n: 40.0e3, hardening_ratio: 0.05}
      sensors: {displacement_noise_m: 1.0e-5, force_noise_n: 50.0, seed: 7}
    control_rate_hz: 1024
    compensator: {type: polynomial_displacement, order: 3, delay_s: 0.023}
    limits: {displacement_m: 0.2, velocity_m_per_s: 1.5, force_n: 150.0e3}
  - id: storey_2
    kind: numerical
    interface: [{dof: floor_2, relative_to: floor_1}]
    model: {type: elastic, stiffness_n_per_m: 3.0e6}
)";

/// A directory with a scenario file and its ground motion.
class ScenarioFile {
 public:
  ScenarioFile() {
    std::ofstream{directory_ / "motion.txt"} << "time_s acceleration_m_per_s2\n0.0 0.0\n0.05 1.0\n0.1 0.0\n";
  }

  [[nodiscard]] std::filesystem::path path() const { return directory_ / "scenario.yaml"; }
  [[nodiscard]] std::filesystem::path directory() const { return directory_.path(); }

  [[nodiscard]] Scenario read(const std::string& text = kScenarioText,
                              const std::vector<std::string>& overrides = {}) const {
    std::ofstream{path()} << text;
    return read_scenario(path(), overrides);
  }
  /// What is wrong, one line each with the file's name left out; empty when nothing is.
  [[nodiscard]] std::vector<std::string> errors(const std::string& text,
                                                const std::vector<std::string>& overrides = {}) const {
    try {
      static_cast<void>(read(text, overrides));
    } catch (const ConfigError& error) {
      std::vector<std::string> lines;
      for (const ConfigIssue& issue : error.issues()) {
        const std::string whole = issue.text();
        const std::string name = path().string() + ":";
        lines.push_back(whole.starts_with(name) ? whole.substr(name.size()) : whole);
      }
      return lines;
    }
    return {};
  }

 private:
  TemporaryDirectory directory_;
};

/// The scenario with one piece of its text replaced; the piece must be there, once.
[[nodiscard]] inline std::string with(const std::string& piece, const std::string& replacement,
                                      std::string text = kScenarioText) {
  const std::size_t place = text.find(piece);
  if (place == std::string::npos || text.find(piece, place + 1) != std::string::npos) {
    throw std::invalid_argument{"not once in the scenario: " + piece};
  }
  return text.replace(place, piece.size(), replacement);
}

}  // namespace hybridtest
