#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "core/exit_code.hpp"
#include "core/faults.hpp"
#include "core/ground_motion_facts.hpp"
#include "core/messages.hpp"
#include "recording/summary/clock_relation.hpp"
#include "recording/summary/percentiles.hpp"
#include "recording/summary/process_end.hpp"
#include "recording/summary/reference_comparison.hpp"
#include "recording/summary/tracking_error.hpp"

namespace hybridtest {

/// The largest magnitude a signal reached, with its sign.
struct Peak {
  std::string dof;
  double value = 0.0;         // [m] or [N]
  double model_time_s = 0.0;  // [s] when
};

/// Exchanges of the coordinator with one substructure.
struct ExchangeSummary {
  std::optional<Percentiles> round_trip_us;
  std::optional<Percentiles> turnaround_us;  // the substructure's own share
  std::uint64_t answered = 0;
  std::uint64_t resent = 0;   // commands sent again
  std::uint64_t bridged = 0;  // steps completed without an answer
  int bridged_in_a_row = 0;   // at most
  // Work that the bridged forces did beyond the measured ones, where that is known; see BridgedStep. [J]
  double bridged_energy_j = 0.0;            // sum, positive: the structure gained it
  double bridged_energy_magnitude_j = 0.0;  // sum of the magnitudes
  std::uint64_t lost = 0;                   // the last command, if it was never answered
  // Answers with the measurement flag of that name.
  std::uint64_t extrapolated = 0;
  std::uint64_t held = 0;
  std::uint64_t saturated = 0;
  std::uint64_t late = 0;
  std::uint64_t missed = 0;  // in real time: measured without the target
  std::uint64_t repeated = 0;
};

struct EnergyError {
  double peak_j = 0.0;  // largest magnitude, with its sign
  double final_j = 0.0;
};

/// Timing of the control loop of a site that had its own thread.
struct LoopTimingSummary {
  std::int64_t starts = 0;        // control periods that began by the clock
  Percentiles start_lateness_us;  // from a control period's time to its start
  Percentiles busy_us;            // from there to its end
  std::int64_t overruns = 0;      // control periods that were over when they began
  bool memory_locked = false;
  int fifo_priority = 0;     // 0: ordinary scheduling
  std::optional<int> cpu{};  // that the loop stayed on
};

struct SubstructureSummary {
  std::string id;
  std::vector<Peak> peak_force_n;  // restoring force per interface degree of freedom
  std::optional<ExchangeSummary> exchange;
  std::vector<TrackingError> tracking;  // of a site
  std::optional<EnergyError> energy_error;
  std::optional<LoopTimingSummary> loop_timing;
  std::vector<ClockRelation> clock;  // against the coordinator's, one per part of the test
};

struct InterlockSummary {
  std::string participant;  // the site of the limit
  std::string limit_name;   // a FaultFlags name
  double observed = 0.0;    // SI; NaN for a fault without an observed value
  double limit = 0.0;       // likewise
  Step step = kNoStep;
  double model_time_s = 0.0;
  std::string cause;  // interlock_cause()
};

/// What the packet filter of a participant kept from the network layer, by kind; see docs/security.md.
struct RefusedPacketsSummary {
  std::uint64_t harmful = 0;        // would hang or end the process
  std::uint64_t in_plain_text = 0;  // with credentials: neither encrypted nor needed to find each other
  std::uint64_t announcements = 0;  // with credentials: false, or in the name of another participant
  std::uint64_t departures = 0;     // with credentials: that a participant has left; genuine ones, too

  [[nodiscard]] std::uint64_t total() const noexcept { return harmful + in_plain_text + announcements + departures; }
};

/// The state of one participant's file.
struct ParticipantFileSummary {
  std::string participant;
  Role role = Role::operator_tool;
  std::string file;                 // name in the run directory; empty when there is none
  bool closed_cleanly = false;      // false after a kill
  bool write_failed = false;        // disk full
  std::uint64_t dropped_rows = 0;   // counted by the recorder
  std::uint64_t missing_steps = 0;  // gaps in the column `step` of its table `steps`
  // None where it did not come to its end, and in the files of older versions.
  std::optional<RefusedPacketsSummary> refused_packets{};
};

/// How the test ended, beside its stop reason.
struct EndSummary {
  std::string who;                     // a participant's id or `operator`; empty when it is not known
  std::string why;                     // one sentence; empty when there is no more to say
  std::optional<double> model_time_s;  // [s] when; empty for a test that never started
};

/// Times in which a paced test stood still, see is_stall(). The operator's pauses do not count.
struct StallSummary {
  std::uint64_t count = 0;
  double total_s = 0.0;       // [s] wall time beyond that of the steps
  double longest_s = 0.0;     // [s] likewise
  double model_time_s = 0.0;  // [s] of the longest
};

/// Largest response of an oscillator with 5 % damping to what was applied, relative to the ground.
struct SpectrumPoint {
  int mode = 0;  // of the structure, from 1; 0: a period of the grid
  double period_s = 0.0;
  double displacement_m = 0.0;
  double velocity_m_per_s = 0.0;
  double pseudo_acceleration_m_per_s2 = 0.0;
};

struct GroundMotionSummary {
  GroundMotionFacts facts;
  std::optional<double> factor;  // that scaled it to a wanted peak or ordinate
  // That the record leaves the ground with, integrated from rest.
  double end_velocity_m_per_s = 0.0;
  double end_displacement_m = 0.0;
  std::vector<SpectrumPoint> spectrum;  // the periods of the grid, then those of the structure
};

/// The results of a test. All values in SI.
struct RunSummary {
  std::string test_name;
  std::string scenario_digest;
  std::string start_time_utc;
  std::string software_version;

  int exit_code = kExitInternal;
  StopReason stop_reason = StopReason::none;  // none when neither a file nor a process tells it
  EndSummary end;
  StallSummary stalls;
  bool data_valid = false;
  std::vector<std::string> data_faults;  // why the data are invalid, one sentence each
  std::vector<std::string> remarks;      // notes that are not faults

  std::optional<std::int64_t> planned_steps;
  std::int64_t completed_steps = 0;
  double model_time_s = 0.0;  // reached
  std::optional<double> wall_time_s;
  std::optional<double> steps_per_second;

  std::vector<GroundMotionSummary> ground_motions;  // none in the files of older versions
  std::vector<ReferenceComparison> references;      // of `hybridtest reference`
  std::vector<Peak> peak_displacement_m;            // per structure degree of freedom
  std::vector<SubstructureSummary> substructures;
  std::vector<InterlockSummary> interlocks;
  std::vector<std::string> faults;  // the other events of severity fault, one sentence each
  std::vector<ParticipantFileSummary> participants;
};

/// What the caller of summarise() knows beside the files.
struct SummaryInput {
  std::string test_name{};              // for a test whose processes ended before they had a file
  std::vector<ProcessEnd> processes{};  // empty: those in `processes.json`, if it is there
  std::vector<Event> events{};          // heard from the network; a full disk keeps them out of the files
  std::string only{};                   // of the files, only this participant's; empty: all
};

/// The test's end in a few words, such as "ended by an interlock (storey_1, at 3.210 s); data invalid" or
/// "completed; specimens held (once 0.45 s at 3.210 s)".
[[nodiscard]] std::string verdict(const RunSummary& summary);

/// Reads every run file of a run directory. Columns are found by name. Unknown tables, columns and
/// files are ignored; results of absent ones are left out.
///
/// The data are invalid when rows were dropped, steps are missing, a file could not be written to
/// its end or was left by a killed process, files belong to different tests, or the coordinator's
/// file is missing or has no end. Then the exit code is 4 unless the test ended with an error code
/// of its own, which stays.
///
/// Who ended the test, why and when is read from the events and from `processes.json`, see ProcessEnd.
/// @throws RecordingError when the directory has no readable run file, and no process is known either.
[[nodiscard]] RunSummary summarise(const std::filesystem::path& run_directory, const SummaryInput& input = {});

/// For programs: complete, SI; unknown values are null.
void write_summary_json(const RunSummary& summary, std::ostream& stream);
/// @throws RecordingError when the file cannot be written.
void write_summary_json(const RunSummary& summary, const std::filesystem::path& path);

/// Of references, as in the summary.
void print_comparisons(const std::vector<ReferenceComparison>& comparisons, std::ostream& stream);

/// For users: verdict first, in millimetres, kilonewtons and milliseconds.
void print_summary(const RunSummary& summary, std::ostream& stream);

}  // namespace hybridtest
