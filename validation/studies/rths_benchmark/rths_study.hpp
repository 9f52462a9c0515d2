#pragma once

#include <cstdint>
#include <vector>

#include "validation/studies/rths_benchmark/benchmark_inputs.hpp"
#include "validation/studies/rths_benchmark/candidates.hpp"
#include "validation/studies/rths_benchmark/virtual_run.hpp"
#include "validation/studies/study_progress.hpp"

namespace hybridtest::rths {

struct StudySettings {
  int plants = 20;         // perturbed ones, besides the nominal
  std::uint64_t seed = 1;  // of the plants and of the sensor noise
  unsigned threads = 1;
};

/// One run of one candidate.
struct StudyRun {
  std::size_t candidate = 0;  // position in the list
  int case_number = 0;
  std::size_t motion = 0;
  int plant = 0;  // 0: nominal
  TestResult result;
  bool is_excused = false;  // the reference itself comes near the force limit

  /// Over the force limit although the reference structure is below it, or diverged.
  [[nodiscard]] bool is_lost() const noexcept {
    return !result.is_complete || (result.reaches_force_limit() && !is_excused);
  }
};

/// Every candidate over four cases, three motions, the nominal and the perturbed plants, with sensor noise.
/// Plant and noise of a run depend only on the seed, case, motion and plant. Every candidate has the same
/// ones, with any other candidates and any number of threads.
/// @return by candidate, case, motion, plant.
[[nodiscard]] std::vector<StudyRun> run_study(const BenchmarkInputs& inputs, const std::vector<Candidate>& candidates,
                                              const StudySettings& settings, StudyProgress& progress);

/// The number of runs of run_study() for this number of candidates.
[[nodiscard]] std::size_t study_size(std::size_t candidates, const StudySettings& settings);

/// Repeats one run of a candidate and returns its signals.
[[nodiscard]] TestHistory run_for_history(const BenchmarkInputs& inputs, const Candidate& candidate, int case_number,
                                          std::size_t motion, int plant, const StudySettings& settings);

}  // namespace hybridtest::rths
