#include "validation/studies/rths_benchmark/recorded_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "compensation/adaptive_model_inverse.hpp"
#include "core/config_error.hpp"
#include "recording/run_file_reader.hpp"
#include "recording/summary/run_summary.hpp"
#include "scenario/scenario.hpp"
#include "validation/studies/compensation_methods.hpp"
#include "validation/studies/rths_benchmark/frame.hpp"
#include "validation/studies/rths_benchmark/harness_check.hpp"
#include "validation/studies/rths_benchmark/virtual_run.hpp"

namespace hybridtest::rths {
namespace {

/// In process, other streams belong to the study.
constexpr std::uint64_t kNoiseSeed = 1;

/// Of the rate, the highest corner that AdaptiveModelInverse takes.
constexpr double kJerkFilterShare = 0.0999;

[[noreturn]] void refuse(const std::filesystem::path& directory, const std::string& why) {
  throw ConfigError{directory.string() + ": " + why + "; expected a run of launch/scenarios/rths_benchmark"};
}

int case_of(const std::filesystem::path& directory, const Scenario& scenario) {
  const LinearStructure& structure = scenario.structure;
  if (structure.size() == static_cast<Eigen::Index>(kFloors)) {
    const Eigen::Matrix3d mass_kg{structure.mass_kg};
    const Eigen::Matrix3d damping{structure.damping_n_s_per_m};
    // The coordinator has neither the mass nor the damping of the specimen, but knows all of the stiffness.
    Eigen::Matrix3d rest{structure.initial_stiffness_n_per_m};
    rest(0, 0) -= TransferSystemModel{}.stiffness_n_per_m;
    for (int case_number = 1; case_number <= kCases; ++case_number) {
      if (Frame::of_case(case_number).without({}).equals(mass_kg, damping, rest)) return case_number;
    }
  }
  refuse(directory, "masses, damping and stiffness of its structure are those of no case");
}

const SubstructureScenario& actuator_of(const std::filesystem::path& directory, const Scenario& scenario) {
  const auto found = std::ranges::find(scenario.substructures, Role::experimental_site, &SubstructureScenario::role);
  if (found == scenario.substructures.end()) refuse(directory, "it has no experimental site");
  return *found;
}

std::size_t motion_of(const std::filesystem::path& directory, const Scenario& scenario, const BenchmarkInputs& inputs) {
  if (scenario.excitation.records.size() == 1) {
    const std::vector<double>& applied = scenario.excitation.records.front().acceleration_m_per_s2;
    for (std::size_t motion = 0; motion < kMotions; ++motion) {
      const std::vector<double> wanted = inputs.motion(motion).sampled(scenario.time.step_s, scenario.time.last_step);
      const double same = 1e-9 * inputs.motion(motion).peak_m_per_s2();
      const auto is_same = [same](double a, double b) { return std::abs(a - b) <= same; };
      if (largest_magnitude(wanted) > 0.0 && std::ranges::equal(applied, wanted, is_same)) return motion;
    }
  }
  refuse(directory, "its ground motion is none of the benchmark's times " + fmt::format("{:g}", kMotionScale));
}

int samples_per_step_of(const std::filesystem::path& directory, const Scenario& scenario) {
  const double samples = scenario.time.step_s * kSampleRateHz;
  const double whole = std::round(samples);
  if (whole < 1.0 || std::abs(samples - whole) > 1e-6) {
    refuse(directory,
           fmt::format("its step of {:g} s is not a whole number of samples of 4096 Hz", scenario.time.step_s));
  }
  return static_cast<int>(whole);
}

/// One column of a participant's table `steps`, by step; not a number where there is no row.
class StepColumns {
 public:
  StepColumns(const std::filesystem::path& file, std::size_t steps)
      : reader_{file}, steps_{steps}, step_{reader_.column("steps", "step")} {}

  [[nodiscard]] std::vector<double> operator[](const std::string& name) const {
    const std::vector<double> values = reader_.column("steps", name);
    std::vector<double> by_step(steps_, kNotANumber);
    for (std::size_t row = 0; row < values.size(); ++row) {
      if (step_[row] >= 0.0 && step_[row] < static_cast<double>(steps_)) {
        by_step[static_cast<std::size_t>(step_[row])] = values[row];
      }
    }
    return by_step;
  }

 private:
  RunFileReader reader_;
  std::size_t steps_;
  std::vector<double> step_;
};

struct Signals {
  std::vector<double> target_m;
  std::vector<double> measured_m;
  std::vector<double> floor_2_m;
  std::vector<double> floor_3_m;
  Floors reference_m;

  /// Leaves out the steps that one of the two participants did not record.
  void keep_recorded() {
    const auto keep = [recorded = recorded_everywhere()](std::vector<double>& values) {
      std::size_t kept = 0;
      for (std::size_t i = 0; i < values.size(); ++i) {
        if (recorded[i]) values[kept++] = values[i];
      }
      values.resize(kept);
    };
    for (auto* values : {&target_m, &measured_m, &floor_2_m, &floor_3_m}) keep(*values);
    for (auto& values : reference_m) keep(values);
  }

 private:
  [[nodiscard]] std::vector<bool> recorded_everywhere() const {
    std::vector<bool> recorded(target_m.size());
    for (std::size_t i = 0; i < recorded.size(); ++i) {
      recorded[i] = std::isfinite(target_m[i] + measured_m[i] + floor_2_m[i] + floor_3_m[i]);
    }
    return recorded;
  }
};

void add_timing(const std::filesystem::path& directory, RecordedRun& run) {
  for (const SubstructureSummary& substructure : summarise(directory).substructures) {
    if (substructure.exchange) run.bridged += substructure.exchange->bridged;
    if (!substructure.loop_timing) continue;
    run.lateness_us_p99 = substructure.loop_timing->start_lateness_us.p99;
    run.lateness_us_max = substructure.loop_timing->start_lateness_us.max;
  }
}

Criteria published_criteria(int case_number, std::size_t motion) {
  for (const PublishedRow& row : published_rows()) {
    if (row.case_number == case_number && row.motion == motion) return row.criteria;
  }
  return no_criteria();
}

/// A value that there is not, as a dash.
std::string cell(double value, int digits) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, digits) : "–";
}

std::string cells(const Criteria& criteria) {
  std::string text;
  for (const double value : criteria.values) text += " " + cell(value, 3) + " |";
  return text;
}

}  // namespace

RecordedRun read_recorded_run(const std::filesystem::path& directory, const BenchmarkInputs& inputs) {
  const Scenario scenario = read_scenario(directory / "scenario.yaml", {});
  const SubstructureScenario& actuator = actuator_of(directory, scenario);
  RecordedRun run;
  run.directory = directory.string();
  run.case_number = case_of(directory, scenario);
  run.samples_per_step = samples_per_step_of(directory, scenario);
  run.motion = motion_of(directory, scenario, inputs);

  Signals signals;
  signals.reference_m = every(inputs.reference(run.case_number, run.motion), run.samples_per_step);
  run.steps_wanted = std::min(signals.reference_m[0].size(), static_cast<std::size_t>(scenario.time.last_step) + 1);
  for (auto& values : signals.reference_m) values.resize(run.steps_wanted);
  const auto file_of = [&](std::string_view id) {
    return directory / (std::string{id} + std::string{kRunFileExtension});
  };
  const StepColumns structure{file_of(kCoordinatorId), run.steps_wanted};
  const StepColumns site{file_of(actuator.id), run.steps_wanted};
  signals.target_m = site["target_displacement_m"];
  signals.measured_m = site["measured_displacement_m"];
  signals.floor_2_m = structure["displacement_" + scenario.dofs[1] + "_m"];
  signals.floor_3_m = structure["displacement_" + scenario.dofs[2] + "_m"];
  signals.keep_recorded();
  run.steps = signals.target_m.size();
  if (run.steps < 2) refuse(directory, "it has no steps that both coordinator and actuator recorded");
  const auto& [floor_1_m, floor_2_m, floor_3_m] = signals.reference_m;
  run.criteria = evaluate_criteria({signals.target_m, signals.measured_m, signals.floor_2_m, signals.floor_3_m},
                                   {floor_1_m, floor_2_m, floor_3_m}, run.samples_per_step * kPeriodS);
  run.in_process = run_in_process(inputs, run.case_number, run.motion, run.samples_per_step, run.steps_wanted);
  add_timing(directory, run);
  return run;
}

Criteria run_in_process(const BenchmarkInputs& inputs, int case_number, std::size_t motion, int samples_per_exchange,
                        std::size_t exchanges) {
  Reference reference = inputs.reference(case_number, motion);
  const std::size_t samples = (exchanges - 1) * static_cast<std::size_t>(samples_per_exchange) + 1;
  for (auto& floor : reference.displacement_m) floor.resize(std::min(floor.size(), samples));
  const double period_s = samples_per_exchange * kPeriodS;
  AdaptiveModelInverse::Parameters parameters;
  parameters.jerk_filter_hz = std::min(parameters.jerk_filter_hz, kJerkFilterShare / period_s);
  CompensatedPath path{std::make_unique<AdaptiveModelInverse>(parameters, period_s), Arrangement::straight};
  const auto force_lead = make_force_lead(kLoopDelayPeriods, period_s);
  return run_virtual_test({.case_number = case_number,
                           .motion = inputs.motion(motion),
                           .reference = reference,
                           .plant = {},
                           .has_sensor_noise = true,
                           .noise_seed = kNoiseSeed,
                           .noise_stream = 0,
                           .samples_per_exchange = samples_per_exchange},
                          path, *force_lead)
      .criteria;
}

std::string recorded_markdown(std::span<const RecordedRun> runs) {
  std::string text =
      "| case, motion, rate | | J1 [ms] | J2 | J3 | J4 | J5 | J6 | J7 | J8 | J9 [%] | steps | bridged | lateness p99, "
      "largest [us] |\n| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
  for (const RecordedRun& run : runs) {
    text += fmt::format("| {}, {}, {:.0f} Hz | {} |{} {} of {} | {} | {}, {} |\n", run.case_number,
                        kMotionNames[run.motion], run.rate_hz(), run.directory, cells(run.criteria), run.steps,
                        run.steps_wanted, run.bridged, cell(run.lateness_us_p99, 1), cell(run.lateness_us_max, 1));
    text += fmt::format("| | in process, at the same rate |{} | | |\n", cells(run.in_process));
    text += fmt::format("| | published, released controller, 4096 Hz |{} | | |\n",
                        cells(published_criteria(run.case_number, run.motion)));
  }
  return text;
}

std::string recorded_csv(std::span<const RecordedRun> runs) {
  std::string text =
      "run,case,motion,rate_hz,J1,J2,J3,J4,J5,J6,J7,J8,J9,steps,steps_wanted,bridged,lateness_us_p99,lateness_us_max,"
      "in_process_J2,in_process_J6,in_process_J7\n";
  for (const RecordedRun& run : runs) {
    text += fmt::format("{},{},{},{:.0f}", run.directory, run.case_number, kMotionNames[run.motion], run.rate_hz());
    for (const double value : run.criteria.values) text += fmt::format(",{:.4f}", value);
    text += fmt::format(",{},{},{},{:.1f},{:.1f},{:.4f},{:.4f},{:.4f}\n", run.steps, run.steps_wanted, run.bridged,
                        run.lateness_us_p99, run.lateness_us_max, run.in_process.j(2), run.in_process.j(6),
                        run.in_process.j(7));
  }
  return text;
}

}  // namespace hybridtest::rths
