#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace hybridtest {

/// How far a degree of freedom of a run is from a reference.
struct DofComparison {
  std::string dof;
  double peak_m = 0.0;                        // largest magnitude of the run
  double reference_peak_m = 0.0;              // of the reference, over the same time
  std::optional<double> rms_relative;         // root mean square of the difference over that of the reference
  std::optional<double> difference_relative;  // largest difference over the peak of the reference
};

/// A run against the same test without coupling.
struct ReferenceComparison {
  std::string reference;  // `in_process` or `opensees`
  double step_s = 0.0;    // of the reference
  double until_s = 0.0;   // of what was compared
  std::vector<DofComparison> dofs;
};

/// The folder of a run that holds its references.
[[nodiscard]] std::filesystem::path reference_folder(const std::filesystem::path& run);

/// As JSON.
[[nodiscard]] std::string text_of(const ReferenceComparison& comparison);

/// @throws RecordingError when it cannot be written.
void write_reference_comparison(const ReferenceComparison& comparison, const std::filesystem::path& file);

/// Those of a run, by name; a file that is none is left out.
[[nodiscard]] std::vector<ReferenceComparison> reference_comparisons(const std::filesystem::path& run);

}  // namespace hybridtest
