#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "launch/doctor_findings.hpp"
#include "runtime/network_profile.hpp"
#include "scenario/scenario.hpp"

namespace hybridtest {

/// Names and ports of the profile, from this host.
[[nodiscard]] std::vector<DoctorLine> check_addresses(const NetworkProfile& profile, std::string_view participant);
/// Over TCP: whether those that listen accept a connection now. For when they were not found.
[[nodiscard]] std::vector<DoctorLine> check_connections(const NetworkProfile& profile, std::string_view participant);
/// What this participant asks of the operating system.
[[nodiscard]] DoctorLine check_privileges(const Scenario& scenario, std::string_view participant);
/// Room and speed of the disk of the run directory, against what this participant records.
[[nodiscard]] std::vector<DoctorLine> check_disk(const Scenario& scenario, std::string_view participant,
                                                 const std::filesystem::path& directory);
/// Whether the clock of this host is kept right by somebody.
[[nodiscard]] DoctorLine check_clock();

}  // namespace hybridtest
