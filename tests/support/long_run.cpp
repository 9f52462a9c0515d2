#include "tests/support/long_run.hpp"

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "core/random.hpp"
#include "recording/recorder.hpp"

namespace hybridtest {
namespace {

constexpr double kDrain_s = 0.05;
constexpr double kWaits_s = 0.5;  // of a site that is armed, before the test

RunFileHeader header_of(const std::string& participant, Role role) {
  RunFileHeader header;
  header.participant = participant;
  header.role = role;
  header.test_name = "long_run";
  header.start_time_utc = "2026-11-23T09:00:00Z";
  header.substructure_ids = {"site"};
  if (role == Role::experimental_site) {
    for (int dof = 1; dof <= LongRun::kDofs; ++dof) header.interface_dofs.push_back("floor_" + std::to_string(dof));
  }
  return header;
}

TableLayout control_layout() {
  TableLayout layout{"control", {{"sample", "-"}, {"time_s", "s"}, {"model_time_s", "s"}}};
  for (int dof = 1; dof <= LongRun::kDofs; ++dof) {
    for (const char* signal : {"target_displacement_m", "command_displacement_m", "measured_displacement_m"}) {
      layout.columns.push_back({signal + column_suffix(dof, LongRun::kDofs), "m"});
    }
    layout.columns.push_back({"measured_force_n" + column_suffix(dof, LongRun::kDofs), "N"});
  }
  return layout;
}

/// A motion of 1 to 3 Hz, other in every degree of freedom.
double target_m(int dof, double time_s) {
  return 0.02 * std::sin(2.0 * std::numbers::pi * (1.0 + 0.25 * dof) * time_s);
}

void write_site(const LongRun& run, const std::filesystem::path& path) {
  const std::size_t drain_rows = static_cast<std::size_t>(kDrain_s * run.control_rate_hz);
  Recorder recorder{path,
                    header_of("site", Role::experimental_site),
                    {{control_layout(), 4 * drain_rows}, {{"steps", {{"step", "-"}, {"model_time_s", "s"}}}, 4096}}};
  RowSink& control = recorder.sink("control");
  RowSink& steps = recorder.sink("steps");
  Random noise{1, 2};
  std::vector<double> row(LongRun::kControlColumns);
  const auto waits = static_cast<std::size_t>(kWaits_s * run.control_rate_hz);
  const auto rows_per_step = static_cast<std::size_t>(run.control_rate_hz / run.step_rate_hz);
  for (std::size_t i = 0; i < waits + run.control_rows(); ++i) {
    const double model_time_s = i < waits ? 0.0 : static_cast<double>(i - waits) / run.control_rate_hz;
    row[0] = static_cast<double>(i);
    row[1] = static_cast<double>(i) / run.control_rate_hz;
    row[2] = model_time_s;
    for (int dof = 0; dof < LongRun::kDofs; ++dof) {
      double* const signals = row.data() + 3 + 4 * dof;
      signals[0] = i < waits ? 0.0 : target_m(dof, model_time_s);
      signals[1] = 1.01 * signals[0];
      signals[2] =
          (i < waits ? 0.0 : target_m(dof, model_time_s - LongRun::kDelay_s)) + 1e-5 * noise.uniform(-1.0, 1.0);
      signals[3] = 4e6 * signals[2] + 50.0 * noise.uniform(-1.0, 1.0);
    }
    control.append(row);
    if (i >= waits && (i - waits) % rows_per_step == 0) {
      const auto step = (i - waits) / rows_per_step;
      steps.append(std::vector{static_cast<double>(step), model_time_s});
    }
    if (i % drain_rows == 0) recorder.drain();
  }
  recorder.close();
}

void write_coordinator(const LongRun& run, const std::filesystem::path& path) {
  const std::size_t drain_rows = static_cast<std::size_t>(kDrain_s * run.step_rate_hz);
  Recorder recorder{
      path,
      header_of("coordinator", Role::coordinator),
      {{{"steps", {{"step", "-"}, {"model_time_s", "s"}, {"wall_time_s", "s"}, {"displacement_floor_1_m", "m"}}},
        4 * drain_rows},
       {{"exchanges",
         {{"step", "-"},
          {"substructure", "-"},
          {"round_trip_us", "us"},
          {"attempts", "-"},
          {"flags", "-"},
          {"turnaround_us", "us"}}},
        4 * drain_rows},
       {{"test", {{"planned_steps", "-"}, {"completed_steps", "-"}, {"stop_reason", "-"}}}, 1}}};
  RowSink& steps = recorder.sink("steps");
  RowSink& exchanges = recorder.sink("exchanges");
  Random random{1, 3};
  for (std::size_t i = 0; i < run.step_rows(); ++i) {
    const double number = static_cast<double>(i);
    const double model_time_s = number / run.step_rate_hz;
    steps.append(std::vector{number, model_time_s, model_time_s, target_m(0, model_time_s)});
    exchanges.append(
        std::vector{number, 0.0, 100.0 + 400.0 * random.uniform(0.0, 1.0), 1.0, 0.0, 20.0 + random.uniform(0.0, 1.0)});
    if (i % drain_rows == 0) recorder.drain();
  }
  const auto last = static_cast<double>(run.step_rows() - 1);
  recorder.sink("test").append(std::vector{last, last, static_cast<double>(StopReason::completed)});
  recorder.close();
}

}  // namespace

void LongRun::write(const std::filesystem::path& directory) const {
  write_coordinator(*this, directory / "coordinator.h5");
  write_site(*this, directory / "site.h5");
}

}  // namespace hybridtest
