#pragma once

#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "recording/run_file_writer.hpp"
#include "tests/unit/recording/run_file_fixture.hpp"

namespace hybridtest {

/// A run directory whose every figure is known: two storeys, a site that lags by 12.5 ms and a
/// numerical substructure. The members may be changed before write().
struct ExampleRun {
  static constexpr int kSteps = 10'000;  // of 1 ms; rows for steps 0 to kSteps
  static constexpr double kDelay_s = 0.0125;

  int coordinator_steps = kSteps;
  int site_steps = kSteps;
  std::uint64_t site_dropped = 0;
  bool site_at_rest = false;
  bool site_skips_steps_100_to_102 = false;
  std::vector<double> site_refused_packets;  // a row of its table; empty: a file without the table
  bool site_has_loop_thread = false;
  int site_waits = 0;       // control samples before the test, the sensors off by 3 mm and 90 kN
  int site_returns = 0;     // control samples after it, with an error of 5 mm and a force of 80 kN
  double site_error = 0.0;  // added to the measured displacement, of the target
  bool with_test_row = true;
  double ground_peak_m_per_s2 = 3.5;
  double step_wall_time_s = 0.0;  // of a paced test
  int stalled_step = -1;          // takes half a second more
  StopReason stop_reason = StopReason::completed;
  int exit_code = 0;
  std::vector<std::vector<double>> extra_exchanges;
  std::vector<std::vector<double>> bridges;  // of a test in real time: step, substructure, in a row, energy [J], late
  std::vector<Event> site_events;
  std::vector<Event> coordinator_events;

  static double time_s(int step) { return 0.001 * step; }
  static double target_m(double time_s) { return 0.02 * std::sin(4.0 * std::numbers::pi * time_s); }

  static RunFileHeader header(const std::string& participant, Role role) {
    RunFileHeader header = example_header();
    header.participant = participant;
    header.role = role;
    header.substructure_ids = {"storey_1", "storey_2"};
    header.interface_dofs =
        role == Role::coordinator ? std::vector<std::string>{} : std::vector<std::string>{"floor_1"};
    return header;
  }

  void write(const std::filesystem::path& directory) const {
    write_coordinator(directory / "coordinator.h5");
    write_site(directory / "storey_1.h5");
    write_numerical(directory / "storey_2.h5");
  }

  void write_coordinator(const std::filesystem::path& path) const {
    RunFileWriter writer{
        path,
        header("coordinator", Role::coordinator),
        {{"steps",
          {{"step", "-"},
           {"model_time_s", "s"},
           {"wall_time_s", "s"},
           {"displacement_floor_1_m", "m"},
           {"displacement_floor_2_m", "m"},
           {"velocity_floor_1_m_per_s", "m/s"},
           {"something_of_tomorrow", "-"}}},
         {"exchanges",
          {{"step", "-"},
           {"substructure", "-"},
           {"round_trip_us", "us"},
           {"attempts", "-"},
           {"flags", "-"},
           {"turnaround_us", "us"}}},
         {"test",
          {{"planned_steps", "-"},
           {"completed_steps", "-"},
           {"stop_reason", "-"},
           {"wall_time_s", "s"},
           {"exit_code", "-"},
           {"step_wall_time_s", "s"}}},
         {"table_of_tomorrow", {{"value", "-"}}},
         {"ground_motions",
          {{"record", "-"},
           {"peak_m_per_s2", "m/s2"},
           {"points", "-"},
           {"duration_s", "s"},
           {"factor", "-"},
           {"end_velocity_m_per_s", "m/s"},
           {"end_displacement_m", "m"}}},
         {"response_spectra",
          {{"record", "-"},
           {"mode", "-"},
           {"period_s", "s"},
           {"displacement_m", "m"},
           {"velocity_m_per_s", "m/s"},
           {"pseudo_acceleration_m_per_s2", "m/s2"}}},
         {"bridges",
          {{"step", "-"}, {"substructure", "-"}, {"in_a_row", "-"}, {"energy_added_j", "J"}, {"came_late", "-"}}}}};
    std::vector<double> steps;
    std::vector<double> exchanges;
    for (int i = 0; i <= coordinator_steps; ++i) {
      // Peaks of 30 mm at step 1000 and −45 mm at step 2000.
      const double first_m = i == 1000 ? 0.03 : 0.001;
      const double second_m = i == 2000 ? -0.045 : 0.002;
      const double stall_s = stalled_step >= 0 && i >= stalled_step ? 0.5 : 0.0;
      steps.insert(steps.end(),
                   {static_cast<double>(i), time_s(i), 0.5 * time_s(i) + stall_s, first_m, second_m, 99.0, 99.0});
      // 1 to 100 us over and over to the site, 10 us to the other.
      exchanges.insert(exchanges.end(),
                       {static_cast<double>(i), 0.0, 1.0 + i % 100, i == 7 ? 3.0 : 1.0, i == 8 ? 8.0 + 2.0 : 0.0, 0.5});
      exchanges.insert(exchanges.end(), {static_cast<double>(i), 1.0, 10.0, 1.0, 0.0, 2.0});
    }
    for (const auto& row : extra_exchanges) exchanges.insert(exchanges.end(), row.begin(), row.end());
    writer.append(0, steps);
    writer.append(1, exchanges);
    if (with_test_row) {
      writer.append(
          2, std::vector{static_cast<double>(kSteps), static_cast<double>(coordinator_steps),
                         static_cast<double>(stop_reason), 4.0, static_cast<double>(exit_code), step_wall_time_s});
      writer.append(4, std::vector{1.0, ground_peak_m_per_s2, 6201.0, 31.0, 1.25, 0.002, -0.03});
      writer.append(5, std::vector{1.0, 0.0, 0.5, 0.05, 0.6, 7.9});
      writer.append(5, std::vector{1.0, 1.0, 0.75, 0.11, 0.9, 7.7});
    }
    for (const auto& row : bridges) writer.append(6, row);
    writer.append_events(coordinator_events, std::vector<std::string>(coordinator_events.size(), "it happened"));
    writer.close();
  }

  void write_site(const std::filesystem::path& path) const {
    std::vector<TableLayout> tables = site_tables();
    if (site_has_loop_thread) {
      tables.push_back({"loop_timing",
                        {{"starts", "-"},
                         {"start_lateness_p50_us", "us"},
                         {"start_lateness_p99_us", "us"},
                         {"start_lateness_max_us", "us"},
                         {"busy_p50_us", "us"},
                         {"busy_p99_us", "us"},
                         {"busy_max_us", "us"},
                         {"overruns", "-"},
                         {"memory_locked", "-"},
                         {"fifo_priority", "-"},
                         {"cpu", "-"}}});
    }
    if (!site_refused_packets.empty()) {
      tables.push_back(
          {"refused_packets", {{"harmful", "-"}, {"in_plain_text", "-"}, {"announcements", "-"}, {"departures", "-"}}});
    }
    RunFileWriter writer{path, header("storey_1", Role::experimental_site), tables};
    append_site(writer);
    if (site_has_loop_thread) {
      writer.append(2, std::vector{61440.0, 8.0, 21.0, 345.0, 5.0, 12.0, 99.0, 3.0, 1.0, 80.0, 1.0});
    }
    if (!site_refused_packets.empty()) writer.append(tables.size() - 1, site_refused_packets);
    writer.close();
  }

  static std::vector<TableLayout> site_tables() {
    return {{"steps",
             {{"step", "-"},
              {"model_time_s", "s"},
              {"target_displacement_m", "m"},
              {"measured_displacement_m", "m"},
              {"measured_force_n", "N"},
              {"flags", "-"}}},
            {"control",
             {{"sample", "-"},
              {"time_s", "s"},
              {"model_time_s", "s"},
              {"target_displacement_m", "m"},
              {"command_displacement_m", "m"},
              {"measured_displacement_m", "m"},
              {"measured_force_n", "N"},
              {"energy_error_j", "J"},
              {"faults", "-"}}}};
  }

  void append_site(RunFileWriter& writer) const {
    std::vector<double> steps;
    std::vector<double> control;
    const auto aside = [&](int sample, double model_time_s, double error_m, double force_n, double energy_j) {
      control.insert(control.end(), {static_cast<double>(sample), 100.0 + time_s(sample), model_time_s, 0.0, 0.0,
                                     error_m, force_n, energy_j, 0.0});
    };
    for (int i = -site_waits; i < 0; ++i) aside(i, 0.0, 0.003, 90'000.0, 0.0);
    for (int i = 0; i <= site_steps; ++i) {
      if (!(site_skips_steps_100_to_102 && i >= 100 && i <= 102)) {
        steps.insert(steps.end(), {static_cast<double>(i), time_s(i), 0.0, 0.0, 1.0, 0.0});
      }
      if (i == kSteps && site_returns == 0) continue;  // whole periods in the control table
      const double target = site_at_rest ? 0.0 : target_m(time_s(i));
      const double measured = site_at_rest ? 0.0 : target_m(time_s(i) - kDelay_s) + site_error * target;
      const double force_n = i == 3000 ? -41'000.0 : 10.0;
      const double energy_j = i == 4000 ? -12.5 : 0.25;
      control.insert(control.end(), {static_cast<double>(i), 100.0 + time_s(i), time_s(i), target, target, measured,
                                     force_n, energy_j, 0.0});
    }
    for (int i = 1; i <= site_returns; ++i) aside(site_steps + i, time_s(site_steps), 0.005, 80'000.0, 99.0);
    writer.append(0, steps);
    writer.append(1, control);
    writer.append_events(site_events, std::vector<std::string>(site_events.size(), "it \"happened\", there"));
    writer.set_dropped(1, site_dropped);
    writer.flush();
  }

  void write_numerical(const std::filesystem::path& path) const {
    RunFileWriter writer{
        path,
        header("storey_2", Role::numerical_substructure),
        {{"steps", {{"step", "-"}, {"model_time_s", "s"}, {"displacement_floor_2_m", "m"}, {"force_floor_2_n", "N"}}}}};
    std::vector<double> steps;
    for (int i = 0; i <= coordinator_steps; ++i) {
      steps.insert(steps.end(), {static_cast<double>(i), time_s(i), 0.0, i == 500 ? 7000.0 : 0.0});
    }
    writer.append(0, steps);
    writer.close();
  }
};

}  // namespace hybridtest
