#include "runtime/resume.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "coordinator/clock_windows.hpp"
#include "core/config_error.hpp"
#include "recording/error.hpp"
#include "recording/read_rows.hpp"
#include "runtime/run_directory.hpp"
#include "runtime/version.hpp"

namespace hybridtest {
namespace {

constexpr std::size_t kWallTimeColumn = 2;  // of `steps`
constexpr std::size_t kEventsAtOnce = 256;  // fewer than the recorder has room for

std::filesystem::path directory_aside(const std::filesystem::path& run_directory, int number) {
  return run_directory / ("before_" + std::to_string(number));
}

[[noreturn]] void refuse(const std::filesystem::path& run_directory, const std::string& why) {
  throw ConfigError{"--resume " + run_directory.string() + ": " + why};
}

std::vector<Eigen::Index> interface_sizes(const Scenario& scenario) {
  std::vector<Eigen::Index> sizes;
  for (const SubstructureScenario& one : scenario.substructures) sizes.push_back(one.interface.size());
  return sizes;
}

bool is_same_row(std::span<const double> recorded, std::span<const double> replayed) {
  if (recorded.size() != replayed.size()) return false;
  for (std::size_t i = 0; i < recorded.size(); ++i) {
    if (i != kWallTimeColumn && std::memcmp(&recorded[i], &replayed[i], sizeof(double)) != 0) return false;
  }
  return true;
}

[[noreturn]] void refuse_step(const RunFileReader& file, Step step) {
  throw ConfigError{
      file.path().string() + ": step " + std::to_string(step) +
      " comes out differently than it was recorded, so the test cannot go on. It was recorded by version " +
      file.header().software_version + ", this is version " + std::string{software_version()} +
      "; resume with the same program, the same processor type and unchanged files"};
}

void copy_exchanges(const RunFileReader& file, Step steps, Recorder& recorder) {
  RowSink& sink = recorder.sink("exchanges");
  read_rows(file, "exchanges", [&](std::span<const double> row) {
    if (row[0] >= static_cast<double>(steps)) return true;
    sink.append(row);
    if (recorder.should_drain()) recorder.drain();
    return true;
  });
}

/// @param later   what this process's clock is ahead of that of the recording.
void copy_clocks(const RunFileReader& file, Duration later, Recorder& recorder) {
  // Of `there` the sender's reading is this clock's, of `back` the receiver's.
  constexpr std::array kColumns{std::pair{"there_at_s", 1.0},    std::pair{"least_there_s", -1.0},
                                std::pair{"mean_there_s", -1.0}, std::pair{"back_at_s", 1.0},
                                std::pair{"least_back_s", 1.0},  std::pair{"mean_back_s", 1.0}};
  const TableLayout layout = ClockWindows::layout();
  RowSink& sink = recorder.sink(layout.name);
  std::vector<double> moved;
  read_rows(file, layout.name, [&](std::span<const double> row) {
    moved.assign(row.begin(), row.end());
    for (const auto& [column, sign] : kColumns) moved[layout.position(column).value()] += sign * to_seconds(later);
    sink.append(moved);
    if (recorder.should_drain()) recorder.drain();
    return true;
  });
}

/// @param later   what this process's clock is ahead of that of the recording.
void copy_events(const std::vector<RecordedEvent>& events, Duration later, Recorder& recorder) {
  std::size_t waiting = 0;
  for (const RecordedEvent& recorded : events) {
    Event event = recorded.event;
    event.clock += later;
    recorder.events().send(event);
    if (++waiting % kEventsAtOnce == 0) recorder.drain();
  }
  recorder.drain();
}

}  // namespace

FileSetAside::FileSetAside(const std::filesystem::path& run_directory, std::string_view participant) try
    : file_{run_file(run_directory, participant)} {
  if (!std::filesystem::exists(file_)) return;
  int number = 1;
  while (std::filesystem::exists(run_file(directory_aside(run_directory, number), participant))) ++number;
  std::filesystem::create_directories(directory_aside(run_directory, number));
  aside_ = run_file(directory_aside(run_directory, number), participant);
  // Another participant that is restored at the same time finds it at every moment: it looks here after the first
  // place.
  std::error_code no_link;
  std::filesystem::create_hard_link(file_, aside_, no_link);
  if (no_link) {
    std::filesystem::rename(file_, aside_);
  } else {
    std::filesystem::remove(file_);
  }
} catch (const std::filesystem::filesystem_error& error) {
  refuse(run_directory, "cannot keep the older recording: " + error.code().message());
}

FileSetAside::~FileSetAside() {
  if (is_kept_ || aside_.empty()) return;
  std::error_code ignored;
  std::filesystem::rename(aside_, file_, ignored);
}

RunFileReader interrupted_recording(const std::filesystem::path& run_directory) {
  std::optional<RunFileReader> best;
  std::string why = "there is no recording of a coordinator";
  const auto look_at = [&](const std::filesystem::path& directory) {
    const std::filesystem::path file = run_file(directory, kCoordinatorId);
    try {
      if (!std::filesystem::exists(file)) return;
      RunFileReader found{file};
      if (!best || found.row_count("answers") > best->row_count("answers")) best = std::move(found);
    } catch (const RecordingError& error) {
      why = error.what();
    }
  };
  look_at(run_directory);
  for (int number = 1; std::filesystem::exists(directory_aside(run_directory, number)); ++number) {
    look_at(directory_aside(run_directory, number));
  }
  if (!best) refuse(run_directory, why);
  return std::move(*best);
}

void require_resumable(const std::filesystem::path& run_directory, const Scenario& scenario) {
  if (scenario.timeouts.resume <= Duration::zero()) {
    refuse(run_directory,
           "the scenario has no timeouts.resume_s: when its coordinator died, the others ended the test. Set it before "
           "the test");
  }
  const RunFileReader file = interrupted_recording(run_directory);
  if (file.header().scenario_digest != scenario.digest) {
    refuse(run_directory,
           "the scenario differs from that of the recording; a test goes on only with the scenario it was "
           "started with, without further --set");
  }
  if (file.row_count("steps") == 0 || file.row_count("answers") == 0) {
    refuse(run_directory, "no step is recorded; start the test again");
  }
  // A coordinator that was resumed and did not find everyone has changed nothing.
  const std::vector<double> reasons =
      file.row_count("test") > 0 ? file.column("test", "stop_reason") : std::vector<double>{};
  if (!reasons.empty() && reasons.back() != static_cast<double>(StopReason::not_assembled)) {
    refuse(run_directory, "the coordinator of this test did not die, it ended the test; see `hybridtest summary`");
  }
}

void read_answers(const RunFileReader& file, const std::vector<Eigen::Index>& interface_sizes,
                  const std::function<bool(const AnsweredCommand&)>& visit) {
  AnsweredCommand command;
  for (const Eigen::Index size : interface_sizes) {
    for (auto* values : {&command.displacement_m, &command.velocity_m_per_s, &command.force_n}) {
      values->push_back(InterfaceVector::Zero(size));
    }
  }
  std::size_t substructure = 0;  // of the row that comes next
  Eigen::Index dof = 0;
  read_rows(file, "answers", [&](std::span<const double> row) {
    if (row[3] != static_cast<double>(substructure) || row[4] != static_cast<double>(dof)) {
      throw RecordingError{file.path().string() + ": the table `answers` has rows in another order"};
    }
    command.step = static_cast<Step>(row[0]);
    command.iteration = static_cast<std::uint16_t>(row[1]);
    command.is_trial = row[2] != 0.0;
    command.displacement_m[substructure][dof] = row[5];
    command.velocity_m_per_s[substructure][dof] = row[6];
    command.force_n[substructure][dof] = row[7];
    if (++dof < interface_sizes[substructure]) return true;
    dof = 0;
    if (++substructure < interface_sizes.size()) return true;
    substructure = 0;
    return visit(command);
  });
}

Incarnation first_coordinator(const std::filesystem::path& run_directory, const RunFileReader& newest) try {
  const std::filesystem::path first = run_file(directory_aside(run_directory, 1), kCoordinatorId);
  return std::filesystem::exists(first) ? RunFileReader{first}.header().incarnation : newest.header().incarnation;
} catch (const RecordingError& error) {
  throw ConfigError{error.what()};
}

void restore_coordinator(Coordinator& coordinator, const Scenario& scenario, const RunFileReader& before,
                         Incarnation first_coordinator, Recorder& recorder, double clock_zero_unix_s) try {
  RowCursor steps{before, "steps"};
  RowSink& sink = recorder.sink("steps");
  const auto recorded_steps = static_cast<Step>(before.row_count("steps"));
  double last_wall_time_s = 0.0;
  read_answers(before, interface_sizes(scenario), [&](const AnsweredCommand& command) {
    if (command.step >= recorded_steps) return false;
    if (!coordinator.replay(command)) refuse_step(before, command.step);
    if (command.is_trial) return true;
    const std::span<const double> row = steps.next();
    if (!is_same_row(row, coordinator.replayed_row())) {
      refuse_step(before, command.step);
    }
    last_wall_time_s = row[kWallTimeColumn];
    sink.append(row);
    if (recorder.should_drain()) recorder.drain();
    return true;
  });
  recorder.drain();
  copy_exchanges(before, coordinator.report().completed_steps, recorder);
  const std::vector<RecordedEvent> events = before.events();
  const Duration later = from_seconds(before.header().t0_unix_s - clock_zero_unix_s);
  copy_clocks(before, later, recorder);
  copy_events(events, later, recorder);

  const auto started =
      std::ranges::find(events, EventCode::test_started, [](const RecordedEvent& one) { return one.event.code; });
  ResumedTest test;
  test.first_coordinator = first_coordinator;
  test.started = Instant{later + (started == events.end() ? Duration{} : started->event.clock)};
  test.last_recorded = test.started + from_seconds(last_wall_time_s);
  coordinator.resume(test);
} catch (const RecordingError& error) {
  throw ConfigError{error.what()};
}

void restore_numerical(NumericalNode& node, const Scenario& scenario, const SubstructureScenario& substructure,
                       const RunFileReader& before, Recorder& recorder) try {
  const SubstructureIndex index = scenario.index_of(substructure);
  const InterfaceVector unknown = InterfaceVector::Zero(substructure.interface.size());
  read_answers(before, interface_sizes(scenario), [&](const AnsweredCommand& command) {
    if (command.is_trial) return true;
    const CommandPoint point{command.step, scenario.model_time_s(command.step), command.displacement_m[index],
                             command.velocity_m_per_s[index], unknown};
    switch (node.restore(point, command.iteration, command.force_n[index])) {
      case NumericalNode::Restored::same: break;
      case NumericalNode::Restored::different: refuse_step(before, command.step);
      case NumericalNode::Restored::not_at_once:
        throw ConfigError{substructure.id +
                          ": its model computes outside this process (OpenSees), and its state cannot be restored; "
                          "start a new test"};
    }
    if (recorder.should_drain()) recorder.drain();
    return true;
  });
  recorder.drain();
} catch (const RecordingError& error) {
  throw ConfigError{error.what()};
}

}  // namespace hybridtest
