#pragma once

#include <span>
#include <string>
#include <vector>

#include "validation/studies/rths_benchmark/rths_study.hpp"

namespace hybridtest::rths {

/// Means over the runs of a candidate that were not lost; not a number where there is none.
struct CandidateMeans {
  std::string name;
  Standing standing = Standing::published;
  std::string remark;
  int runs = 0;
  int lost = 0;
  double j1_ms = 0.0;
  double j1_ms_max = 0.0;
  double j2 = 0.0;                 // [%], as all that follow unless it says otherwise
  double reference_floor = 0.0;    // of J2: sensor noise over the deviation of the reference's floor 1
  double j2_over_floor = 0.0;      // [] mean of the runs' ratios to the reference's floor
  double j2_over_own_floor = 0.0;  // [] the same with the deviation of each run's own x_n1
  double true_nominal = 0.0;       // J2 without sensor noise, nominal plant
  double true_perturbed = 0.0;     // likewise, perturbed plants
  double true_max = 0.0;
  double j4 = 0.0;
  double j6 = 0.0;
  double j7 = 0.0;
  double peak_force_n = 0.0;  // largest over the runs whose reference stays away from the limit, lost ones included
};

[[nodiscard]] std::vector<CandidateMeans> means_of(const BenchmarkInputs& inputs,
                                                   const std::vector<Candidate>& candidates,
                                                   std::span<const StudyRun> runs);

/// One thing that is asked of our compensator.
struct Target {
  std::string what;
  std::string limit;
  std::string found;
  bool is_met = false;
};

/// The targets of the study for kOurs: absolute ones, and smaller means of J2, J6 and J7 than every published
/// method and yardstick among `means` that loses no run. Empty where kOurs is not among them.
[[nodiscard]] std::vector<Target> judge_ours(std::span<const CandidateMeans> means);

}  // namespace hybridtest::rths
