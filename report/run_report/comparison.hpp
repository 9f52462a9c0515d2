#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "report/run_report/run_record.hpp"

namespace hybridtest::run_report {

/// How far a signal is from the same signal of another recording, over the time that both have. SI units.
struct Difference {
  std::string signal;  // `displacement floor_1`, `storey_1: measured displacement`
  std::string unit;
  double peak = 0.0;                    // largest magnitude here
  double other_peak = 0.0;              // there
  std::optional<double> rms_relative;   // root mean square of the difference over that of the other
  std::optional<double> peak_relative;  // largest difference over the peak of the other
};

/// What a model predicts beside what was measured.
struct Prediction {
  std::string title;  // `specimen, held_out.csv`
  std::string unit;
  plot::Points measured;  // over time [s]
  plot::Points modelled;
  plot::Points completed;  // with the causes added; empty without any
};

/// Curves of another recording, to be drawn over those of a run.
struct Compared {
  std::string label;  // in legends
  std::string what;   // one sentence: what it is
  std::vector<SignalCurve> structure{};
  std::vector<SubstructureRecord> substructures{};  // signals and loops
  std::vector<Difference> differences{};
  std::vector<Prediction> predictions{};            // of a diagnosis
  std::vector<std::string> scenario_differences{};  // `- compensator > delay_s: 0.02`, `+ …`; empty for no run
};

/// Reads what a run is compared with:
///   - another run directory;
///   - a CSV file with a column `time_s` and columns `displacement_<dof>_m`, as `hybridtest reference` writes;
///   - the folder of a diagnosis, whose `prediction.csv` holds what its model predicts.
/// Differences are taken at the times of the run; the other recording is interpolated between its own.
/// @throws ConfigError when it is none of these, or has no signal that the run has.
[[nodiscard]] Compared read_compared(const std::filesystem::path& other, const RunRecord& run);

/// The references of `hybridtest reference` in the folder of the run itself; one that cannot be read is left out.
[[nodiscard]] std::vector<Compared> references_of(const RunRecord& run);

}  // namespace hybridtest::run_report
