#include "validation/studies/rths_benchmark/rths_study.hpp"

#include "validation/studies/parallel_runs.hpp"
#include "validation/studies/rths_benchmark/plant.hpp"

namespace hybridtest::rths {
namespace {

/// Streams of the seed below this are the plants' own.
constexpr std::uint64_t kNoiseStreams = 1'000'000;

VirtualTest test_of(const BenchmarkInputs& inputs, int case_number, std::size_t motion, int plant, std::uint64_t seed) {
  const auto index = static_cast<std::uint64_t>(case_number) * 3 + motion;
  return {.case_number = case_number,
          .motion = inputs.motion(motion),
          .reference = inputs.reference(case_number, motion),
          .plant = plant_parameters(plant, seed),
          .has_sensor_noise = true,
          .noise_seed = seed,
          .noise_stream = kNoiseStreams * (index + 1) + static_cast<std::uint64_t>(plant)};
}

}  // namespace

std::size_t study_size(std::size_t candidates, const StudySettings& settings) {
  return candidates * kCases * kMotions * (static_cast<std::size_t>(settings.plants) + 1);
}

std::vector<StudyRun> run_study(const BenchmarkInputs& inputs, const std::vector<Candidate>& candidates,
                                const StudySettings& settings, StudyProgress& progress) {
  const auto plants = static_cast<std::size_t>(settings.plants) + 1;
  std::vector<StudyRun> runs(study_size(candidates.size(), settings));
  run_in_parallel(runs.size(), settings.threads, [&](std::size_t i) {
    StudyRun& run = runs[i];
    run.plant = static_cast<int>(i % plants);
    run.motion = i / plants % kMotions;
    run.case_number = static_cast<int>(i / plants / kMotions % kCases) + 1;
    run.candidate = i / plants / kMotions / kCases;
    const Candidate& candidate = candidates[run.candidate];
    const VirtualTest test = test_of(inputs, run.case_number, run.motion, run.plant, settings.seed);
    run.is_excused = test.reference.is_near_force_limit();
    run.result = run_virtual_test(test, *candidate.make_path(), *candidate.make_force_compensator());
    progress.completed(candidate.name);
  });
  return runs;
}

TestHistory run_for_history(const BenchmarkInputs& inputs, const Candidate& candidate, int case_number,
                            std::size_t motion, int plant, const StudySettings& settings) {
  TestHistory history;
  static_cast<void>(run_virtual_test(test_of(inputs, case_number, motion, plant, settings.seed), *candidate.make_path(),
                                     *candidate.make_force_compensator(), &history));
  return history;
}

}  // namespace hybridtest::rths
