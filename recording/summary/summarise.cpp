#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <map>
#include <set>
#include <tuple>

#include "core/event_text.hpp"
#include "core/stall.hpp"
#include "recording/error.hpp"
#include "recording/read_rows.hpp"
#include "recording/run_file_reader.hpp"
#include "recording/summary/columns.hpp"
#include "recording/summary/exchanges.hpp"
#include "recording/summary/find_end.hpp"
#include "recording/summary/peak_search.hpp"
#include "recording/summary/run_summary.hpp"
#include "recording/summary/site_figures.hpp"

namespace hybridtest {
namespace {

constexpr std::string_view kSteps = "steps";
constexpr std::string_view kTest = "test";
constexpr std::string_view kLoopTiming = "loop_timing";
constexpr std::string_view kRefusedPackets = "refused_packets";

std::string count_of(std::uint64_t count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

/// The last value of a column if it is finite.
std::optional<double> last_of(const RunFileReader& file, std::string_view table, std::string_view column) {
  const auto value = value_in_last_row(file, table, column);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

/// The ground motions with the spectra of what was applied; none in the files of older versions.
std::vector<GroundMotionSummary> ground_motions_of(const RunFileReader& file) {
  constexpr std::string_view kMotions = "ground_motions";
  constexpr std::string_view kSpectra = "response_spectra";
  if (!file.has_table(kMotions)) return {};
  const auto peak_m_per_s2 = file.column(kMotions, "peak_m_per_s2");
  const auto points = file.column(kMotions, "points");
  const auto duration_s = file.column(kMotions, "duration_s");
  const auto factor = file.column(kMotions, "factor");
  const auto end_velocity_m_per_s = file.column(kMotions, "end_velocity_m_per_s");
  const auto end_displacement_m = file.column(kMotions, "end_displacement_m");
  std::vector<GroundMotionSummary> motions(peak_m_per_s2.size());
  for (std::size_t i = 0; i < motions.size(); ++i) {
    motions[i].facts = {
        .peak_m_per_s2 = peak_m_per_s2[i], .points = static_cast<std::int64_t>(points[i]), .duration_s = duration_s[i]};
    if (std::isfinite(factor[i])) motions[i].factor = factor[i];
    motions[i].end_velocity_m_per_s = end_velocity_m_per_s[i];
    motions[i].end_displacement_m = end_displacement_m[i];
  }
  if (!file.has_table(kSpectra)) return motions;
  const auto record = file.column(kSpectra, "record");
  const auto mode = file.column(kSpectra, "mode");
  const auto period_s = file.column(kSpectra, "period_s");
  const auto displacement_m = file.column(kSpectra, "displacement_m");
  const auto velocity_m_per_s = file.column(kSpectra, "velocity_m_per_s");
  const auto acceleration_m_per_s2 = file.column(kSpectra, "pseudo_acceleration_m_per_s2");
  for (std::size_t row = 0; row < record.size(); ++row) {
    if (!(record[row] >= 1.0 && record[row] <= static_cast<double>(motions.size()))) continue;
    motions[static_cast<std::size_t>(record[row]) - 1].spectrum.push_back(
        {.mode = static_cast<int>(mode[row]),
         .period_s = period_s[row],
         .displacement_m = displacement_m[row],
         .velocity_m_per_s = velocity_m_per_s[row],
         .pseudo_acceleration_m_per_s2 = acceleration_m_per_s2[row]});
  }
  return motions;
}

/// Steps that are missing between consecutive rows.
std::uint64_t missing_steps(const RunFileReader& file) {
  const auto step = column_position(file, kSteps, "step");
  if (!step) return 0;
  double missing = 0.0;
  std::optional<double> before;
  read_rows(file, kSteps, [&](std::span<const double> row) {
    const double gap = before ? row[*step] - *before - 1.0 : 0.0;
    if (gap > 0.0) missing += gap;
    before = row[*step];
    return true;
  });
  return static_cast<std::uint64_t>(missing);
}

std::optional<LoopTimingSummary> loop_timing_of(const RunFileReader& file) {
  if (file.row_count(kLoopTiming) == 0) return {};
  const auto value = [&](std::string_view column) { return last_of(file, kLoopTiming, column).value_or(0.0); };
  const auto percentiles_of = [&](const std::string& quantity) {
    return Percentiles{value(quantity + "_p50_us"), value(quantity + "_p99_us"), value(quantity + "_max_us")};
  };
  LoopTimingSummary timing;
  timing.starts = static_cast<std::int64_t>(value("starts"));
  timing.start_lateness_us = percentiles_of("start_lateness");
  timing.busy_us = percentiles_of("busy");
  timing.overruns = static_cast<std::int64_t>(value("overruns"));
  timing.memory_locked = value("memory_locked") != 0.0;
  timing.fifo_priority = static_cast<int>(value("fifo_priority"));
  if (const double cpu = value("cpu"); cpu >= 0.0) timing.cpu = static_cast<int>(cpu);
  return timing;
}

std::optional<RefusedPacketsSummary> refused_packets_of(const RunFileReader& file) {
  if (file.row_count(kRefusedPackets) == 0) return {};
  const auto count = [&](std::string_view column) {
    return static_cast<std::uint64_t>(last_of(file, kRefusedPackets, column).value_or(0.0));
  };
  return RefusedPacketsSummary{.harmful = count("harmful"),
                               .in_plain_text = count("in_plain_text"),
                               .announcements = count("announcements"),
                               .departures = count("departures")};
}

/// A response with such a tracking error is one of other displacements than the recorded ones.
constexpr double kTrackingRemark = 0.1;  // of the target's root mean square

std::string tracking_remark(const std::string& site, const TrackingError& error) {
  char percent[32];
  std::snprintf(percent, sizeof percent, "%.0f %%", 100.0 * error.rms_relative.value_or(0.0));
  return site + " " + error.dof + ": tracking error of " + percent +
         " of the targets (RMS), expected at most 10 %; check sensors, rig and compensation";
}

std::string interlock_key(const Event& event) {
  return event.source.text() + "/" + event.subject.text() + "/" + std::to_string(event.step);
}

InterlockSummary interlock_of(const Event& event) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const bool has_value = has_observed_value(event.subject.view());
  return {.participant = event.source.text(),
          .limit_name = event.subject.text(),
          .observed = has_value ? event.values[0] : kNone,
          .limit = has_value ? event.values[1] : kNone,
          .step = event.step,
          .model_time_s = event.model_time_s,
          .cause = interlock_cause(event.subject.view(), event.values)};
}

/// Puts a summary together from the files of a run.
class Summariser {
 public:
  Summariser(const std::filesystem::path& run_directory, const SummaryInput& input) : input_{input} {
    if (input_.processes.empty()) input_.processes = read_process_ends(run_directory);
    open_files(run_directory);
    collect_events();
  }

  RunSummary summarise() {
    summarise_files();
    if (coordinator_ == nullptr) {
      add_data_fault("the coordinator's file is missing: copy it into the run directory");
    } else {
      summarise_test();
    }
    summarise_substructures();
    summarise_events();
    check_ends();
    find_end(summary_, input_.processes, events_);
    conclude();
    return std::move(summary_);
  }

 private:
  void open_files(const std::filesystem::path& run_directory);
  void collect_events();
  void summarise_files();
  void summarise_test();
  void read_steps();
  [[nodiscard]] std::function<void(std::span<const double>)> stall_search();
  void summarise_substructures();
  void summarise_events();
  void check_ends();
  void conclude();

  /// Steps whose command was lost are bridged, and not in the file of the substructure.
  [[nodiscard]] bool is_in_real_time() const {
    return coordinator_ != nullptr && coordinator_->has_column("bridges", "step");
  }
  void add_data_fault(std::string text) { summary_.data_faults.push_back(std::move(text)); }
  [[nodiscard]] const RunFileReader* file_of(const std::string& participant) const {
    const auto found = std::find_if(files_.begin(), files_.end(), [&](const RunFileReader& file) {
      return file.header().participant == participant && file.header().role != Role::coordinator;
    });
    return found == files_.end() ? nullptr : &*found;
  }

  SummaryInput input_;
  std::vector<RunFileReader> files_;
  std::vector<RecordedEvent> events_;  // of all files, then those from the network
  const RunFileReader* coordinator_ = nullptr;
  RunSummary summary_;
};

void Summariser::open_files(const std::filesystem::path& run_directory) {
  std::vector<std::filesystem::path> paths;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator{run_directory, error}) {
    const bool is_wanted = input_.only.empty() || entry.path().stem() == input_.only;
    if (is_wanted && entry.path().extension() == kRunFileExtension) paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  for (const auto& path : paths) {
    try {
      files_.emplace_back(path);
    } catch (const RecordingError& unreadable) {
      add_data_fault(unreadable.what());
    }
  }
  if (files_.empty() && input_.processes.empty())
    throw RecordingError{run_directory.string() + ": no readable run file (*.h5) in this directory"};
  for (const RunFileReader& file : files_) {
    if (file.header().role == Role::coordinator) coordinator_ = &file;
  }
}

void Summariser::collect_events() {
  for (const RunFileReader& file : files_) {
    const std::vector<RecordedEvent> events = file.events();
    events_.insert(events_.end(), events.begin(), events.end());
  }
  for (const Event& event : input_.events) events_.push_back({event, describe(event)});
}

void Summariser::summarise_files() {
  if (files_.empty()) {
    summary_.test_name = input_.test_name;
    return;
  }
  const RunFileHeader& first = (coordinator_ != nullptr ? *coordinator_ : files_.front()).header();
  summary_.test_name = first.test_name;
  summary_.scenario_digest = hex(first.scenario_digest);
  summary_.start_time_utc = first.start_time_utc;
  summary_.software_version = first.software_version;
  for (const RunFileReader& file : files_) {
    const RunFileHeader& header = file.header();
    const RunFileCounters& counters = file.counters();
    const ParticipantFileSummary state{header.participant,     header.role,
                                       file.path().filename(), counters.closed_cleanly,
                                       counters.write_failed,  counters.dropped_rows(),
                                       missing_steps(file),    refused_packets_of(file)};
    if (header.test_name != first.test_name || header.scenario_digest != first.scenario_digest) {
      add_data_fault(state.file + " belongs to another test or scenario");
    }
    if (state.write_failed) {
      add_data_fault(header.participant + ": writing failed (disk full?); " + count_of(state.dropped_rows, "record") +
                     " lost");
    } else if (state.dropped_rows > 0) {
      add_data_fault(header.participant + ": " + count_of(state.dropped_rows, "record") + " dropped");
    }
    if (!state.closed_cleanly && !state.write_failed) {
      add_data_fault(header.participant + ": killed while recording; its file ends at the last flush");
    }
    if (state.missing_steps > 0) {
      add_data_fault(header.participant + ": " + count_of(state.missing_steps, "step") +
                     " missing between recorded steps");
    }
    summary_.participants.push_back(state);
  }
}

void Summariser::summarise_test() {
  const RunFileReader& file = *coordinator_;
  summary_.model_time_s = last_of(file, kSteps, "model_time_s").value_or(0.0);

  if (const auto reason = last_of(file, kTest, "stop_reason")) {
    summary_.stop_reason = static_cast<StopReason>(static_cast<int>(*reason));
  } else {
    add_data_fault("the coordinator's file does not say how the test ended");
  }
  if (const auto planned = last_of(file, kTest, "planned_steps")) {
    summary_.planned_steps = static_cast<std::int64_t>(*planned);
  }
  const double last_step = last_of(file, kSteps, "step").value_or(0.0);
  const double completed = last_of(file, kTest, "completed_steps").value_or(last_step);
  summary_.completed_steps = static_cast<std::int64_t>(completed);

  summary_.ground_motions = ground_motions_of(file);
  for (const GroundMotionSummary& motion : summary_.ground_motions) {
    const std::string warning = ground_motion_warning(motion.facts);
    if (!warning.empty()) summary_.remarks.push_back(warning);
  }

  summary_.wall_time_s = last_of(file, kTest, "wall_time_s");
  const auto first_wall_s = value_in_first_row(file, kSteps, "wall_time_s");
  if (!summary_.wall_time_s && first_wall_s) {
    summary_.wall_time_s = *value_in_last_row(file, kSteps, "wall_time_s") - *first_wall_s;
  }
  if (summary_.wall_time_s && *summary_.wall_time_s > 0.0)
    summary_.steps_per_second = completed / *summary_.wall_time_s;
  read_steps();
}

/// Peaks, and stalls of a test that has a clock.
void Summariser::read_steps() {
  const RunFileReader& file = *coordinator_;
  PeakSearch displacement{file, kSteps, "displacement", "m"};
  const auto search = stall_search();
  read_rows(file, kSteps, [&](std::span<const double> row) {
    displacement.add(row);
    if (search) search(row);
    return true;
  });
  summary_.peak_displacement_m = displacement.peaks();
}

/// Looks at every row of the steps; empty in lockstep: without a clock nothing stands still.
std::function<void(std::span<const double>)> Summariser::stall_search() {
  const double step_s = last_of(*coordinator_, kTest, "step_wall_time_s").value_or(0.0);
  const auto step = column_position(*coordinator_, kSteps, "step");
  const auto wall_time = column_position(*coordinator_, kSteps, "wall_time_s");
  const auto model_time = column_position(*coordinator_, kSteps, "model_time_s");
  if (!(step_s > 0.0) || !step || !wall_time || !model_time) return {};
  std::set<std::int64_t> paused;
  for (const RecordedEvent& recorded : events_) {
    if (recorded.event.code == EventCode::test_paused) paused.insert(recorded.event.step);
  }
  return [=, this, before_s = std::optional<double>{}](std::span<const double> row) mutable {
    const double taken_s = before_s ? row[*wall_time] - *before_s : 0.0;
    before_s = row[*wall_time];
    if (!is_stall(taken_s, step_s)) return;
    // A pause begins when a step is over; the commands of the next may be out already.
    const auto at = static_cast<std::int64_t>(row[*step]);
    if (paused.contains(at) || paused.contains(at - 1)) return;
    StallSummary& stalls = summary_.stalls;
    ++stalls.count;
    stalls.total_s += taken_s - step_s;
    if (taken_s - step_s <= stalls.longest_s) return;
    stalls.longest_s = taken_s - step_s;
    stalls.model_time_s = row[*model_time];
  };
}

void Summariser::summarise_substructures() {
  // The order of the scenario if the coordinator's file is there, then all other files.
  std::vector<std::string> ids;
  if (coordinator_ != nullptr) ids = coordinator_->header().substructure_ids;
  for (const RunFileReader& file : files_) {
    const std::string& id = file.header().participant;
    if (&file != coordinator_ && std::find(ids.begin(), ids.end(), id) == ids.end()) ids.push_back(id);
  }
  std::vector<std::optional<ExchangeSummary>> exchanges(ids.size());
  if (coordinator_ != nullptr) {
    exchanges = exchanges_of(*coordinator_, ids.size(), static_cast<double>(summary_.completed_steps));
  }
  std::vector<ParticipantClock> clocks;
  if (coordinator_ != nullptr) clocks = participant_clocks(*coordinator_);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    SubstructureSummary substructure;
    substructure.id = ids[i];
    substructure.exchange = exchanges[i];
    const auto clock = std::ranges::find(clocks, ids[i], &ParticipantClock::participant);
    if (clock != clocks.end()) substructure.clock = std::move(clock->parts);
    if (const RunFileReader* file = file_of(ids[i])) {
      SiteFigures figures = site_figures(*file);
      substructure.peak_force_n = std::move(figures.peak_force_n);
      substructure.tracking = std::move(figures.tracking);
      substructure.energy_error = figures.energy_error;
      for (const TrackingError& error : substructure.tracking) {
        if (error.rms_relative.value_or(0.0) <= kTrackingRemark) continue;
        summary_.remarks.push_back(tracking_remark(ids[i], error));
      }
      substructure.loop_timing = loop_timing_of(*file);
    } else {
      summary_.remarks.push_back(ids[i] + ": no file in this directory; if it ran on another host, copy its file here");
    }
    summary_.substructures.push_back(std::move(substructure));
  }
}

void Summariser::summarise_events() {
  // The same event is in the file of its source and in the files of its receivers.
  std::set<std::string> seen;
  std::set<std::string> told;
  for (const RecordedEvent& recorded : events_) {
    const Event& event = recorded.event;
    if (event.code == EventCode::interlock_tripped) {
      if (!seen.insert(interlock_key(event)).second) continue;
      summary_.interlocks.push_back(interlock_of(event));
    } else if (event.code == EventCode::real_time_refused || event.code == EventCode::test_continued ||
               event.code == EventCode::coordinator_succeeded) {
      const std::string text = event.source.text() + ": " + recorded.text;
      if (told.insert(text).second) summary_.remarks.push_back(text);
    } else if (event.severity == Severity::fault) {
      const std::string text = event.source.text() + ": " + recorded.text;
      if (told.insert(text).second) summary_.faults.push_back(text);
    }
  }
  std::stable_sort(summary_.interlocks.begin(), summary_.interlocks.end(),
                   [](const auto& a, const auto& b) { return a.step < b.step; });
}

/// Checks that every file reaches the end of the test.
void Summariser::check_ends() {
  if (coordinator_ == nullptr) return;
  for (const RunFileReader& file : files_) {
    const auto last = last_of(file, kSteps, "step");
    if (!last) continue;
    const auto missing = summary_.completed_steps - static_cast<std::int64_t>(*last);
    // The last message may not have arrived when the test ended.
    std::int64_t allowed = &file == coordinator_ ? 0 : 1;
    // In real time the last commands may have been lost: what was bridged is told.
    if (is_in_real_time() && &file != coordinator_) {
      for (const SubstructureSummary& substructure : summary_.substructures) {
        if (substructure.id == file.header().participant && substructure.exchange)
          allowed += substructure.exchange->bridged_in_a_row;
      }
    }
    if (missing > allowed) {
      add_data_fault(file.header().participant + ": the record ends " +
                     count_of(static_cast<std::uint64_t>(missing), "step") + " before the end of the test");
    }
  }
}

void Summariser::conclude() {
  summary_.data_valid = summary_.data_faults.empty();
  // Without an end, the validity of the data is unknown.
  const bool has_end = summary_.stop_reason != StopReason::none;
  summary_.exit_code = has_end ? exit_code_for(summary_.stop_reason) : kExitDataInvalid;
  if (!summary_.data_valid && summary_.exit_code == kExitCompleted) summary_.exit_code = kExitDataInvalid;
}

}  // namespace

RunSummary summarise(const std::filesystem::path& run_directory, const SummaryInput& input) {
  RunSummary summary = Summariser{run_directory, input}.summarise();
  summary.references = reference_comparisons(run_directory);
  return summary;
}

}  // namespace hybridtest
