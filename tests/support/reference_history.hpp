#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace hybridtest {

/// Displacements that OpenSees computed, at 0.01 s, 0.02 s …
struct ReferenceHistory {
  std::vector<std::vector<double>> displacement_m;  // [m], one history per floor from below

  [[nodiscard]] std::size_t samples() const noexcept { return displacement_m.empty() ? 0 : displacement_m[0].size(); }
};

/// @param file   columns time_s, displacement_1_m … and others that are not read.
/// @throws std::runtime_error for a file that cannot be read or has no such columns.
[[nodiscard]] ReferenceHistory read_reference(const std::filesystem::path& file);

/// A history of tests/reference: the building under the shipped design motion. Part of the repository.
[[nodiscard]] std::filesystem::path committed_reference(const std::string& building);

/// Largest distance of a displacement from the reference, as a share of the reference's peak.
/// @param found   with a step of 0.001 s, from time 0; may end before the reference does.
[[nodiscard]] double largest_share(const std::vector<double>& reference, const std::vector<double>& found);

/// Samples of the reference that a displacement of this many steps (0.001 s, from time 0) can be compared with.
[[nodiscard]] std::size_t compared_samples(const ReferenceHistory& reference, std::size_t steps);

}  // namespace hybridtest
