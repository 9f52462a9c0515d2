#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "runtime/simulation.hpp"

namespace hybridtest {

/// Set for every run of these tests: a motion that is strong from the first step.
inline constexpr const char* kPulse = "excitation.ground_motion=../../tests/simulation/ground_motions/pulse.txt";

/// A whole-system run with faults, drawn by its seed.
struct DrawnCase {
  std::string scenario;
  std::vector<std::string> overrides;
  SimulationSettings settings;
  bool has_long_outage = false;

  /// The faults drawn cannot end the test: no participant is killed, and heartbeats arrive in time.
  [[nodiscard]] bool is_harmless() const;
  [[nodiscard]] bool is_killed(const std::string& participant) const;
  /// The command that runs the same case.
  [[nodiscard]] std::string command() const;
};

[[nodiscard]] DrawnCase draw_case(std::uint64_t seed, CouplingMode mode);

}  // namespace hybridtest
