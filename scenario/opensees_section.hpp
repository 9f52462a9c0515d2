#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/config/section.hpp"
#include "core/time.hpp"
#include "scenario/named_file.hpp"

namespace hybridtest {

/// An element `genericClient` of the model in OpenSees.
struct LedElementScenario {
  std::string substructure;           // its id
  std::uint16_t port = 0;             // TCP and UDP
  std::vector<std::string> dofs;      // in the order in which the element lists them
  Eigen::VectorXd mass_kg;            // of the substructure, one per degree of freedom: what OpenSees is told (15)
  Eigen::VectorXd damping_n_s_per_m;  // likewise (14)
};

/// `coordinator: {type: opensees}`: OpenSees integrates, and its elements ask for the forces of the substructures.
struct OpenSeesLeadScenario {
  std::filesystem::path script;        // empty when OpenSees is started by hand
  std::string program;                 // empty: HYBRIDTEST_OPENSEES, or OpenSees of PATH
  std::vector<std::string> arguments;  // of the script
  std::string listen_address;          // of this host
  std::string client_address;          // that OpenSees connects from; no other may
  std::vector<LedElementScenario> elements;
  bool allow_iterations = false;
  Duration silence{};
  std::vector<std::string> dofs;  // of all elements, each once
};

/// Reads the section `coordinator`; nothing where our own integrator leads.
/// @param directory   of the scenario file, where a relative path to the script starts.
[[nodiscard]] std::optional<OpenSeesLeadScenario> read_opensees_lead(config::Section& root,
                                                                     const std::filesystem::path& directory,
                                                                     std::vector<NamedFile>& files);

}  // namespace hybridtest
