#include "report/run_report/advice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "core/text/short_number.hpp"

namespace hybridtest::run_report {
namespace {

struct NextStep {
  StopReason reason;
  std::string_view what_to_do;
};

constexpr std::array<NextStep, 18> kNextSteps{{
    {StopReason::none,
     "No file and no process tells how the test ended. Copy the files of all participants into the run directory, then "
     "run `hybridtest summary` and `hybridtest report` again."},
    {StopReason::interrupted, "The operator stopped the test. The record is complete up to the stop."},
    {StopReason::interlock,
     "A site brought its specimen to rest because a limit was exceeded. Look at the margins below, inspect the "
     "specimen, "
     "then decide: a smaller excitation, another compensator, or a wider limit within the rating of the rig."},
    {StopReason::participant_lost,
     "Look at the log of the lost participant in the run directory, and at its host and network with `hybridtest "
     "doctor`."},
    {StopReason::coordinator_lost,
     "Look at coordinator.log in the run directory, and at its host and network with `hybridtest doctor`."},
    {StopReason::not_finite,
     "A force or the integrator gave no finite number. Check the step against the limit that `hybridtest check` "
     "prints, "
     "and the sensors of the site that is named."},
    {StopReason::not_assembled, "Nothing moved. Start the missing participant with the same scenario file and domain."},
    {StopReason::refused, "Nothing moved. Give every participant the same scenario file, and each an id of its own."},
    {StopReason::recording_failed, "Check free space and permissions of the disk, then run the test again."},
    {StopReason::emergency_stop, "Make sure that every rig is at rest before anyone goes near a specimen."},
    {StopReason::participant_failed,
     "Nothing moved. The last line of the log of the participant says why it could not start."},
    {StopReason::no_equilibrium,
     "The integrator found no equilibrium within its iterations. Try a shorter step or a larger `iterations_max`."},
    {StopReason::opensees_lost, "Look at the output of OpenSees in the run directory."},
    {StopReason::opensees_iterates,
     "A specimen cannot be tried twice. Choose an integrator of OpenSees that asks once in a step; see "
     "docs/opensees.md."},
    {StopReason::deadlines_missed,
     "Look at the round trip and the lateness of the control loop of the participant that is named. A longer `step_s`, "
     "a "
     "quieter machine or a larger `bridging.most_in_a_row` leaves more time; see docs/real_time.md."},
    {StopReason::network_too_slow,
     "Nothing moved. Lengthen `step_s`, shorten `bridging.deadline_s`, or use the mode `paced`; see "
     "docs/real_time.md."},
    {StopReason::resume_refused,
     "The recording of the coordinator and the site disagree about a step that was imposed. Start a new test; see "
     "docs/resume.md."},
    {StopReason::model_failed, "Look at the log of the numerical substructure: its model failed, not its specimen."},
}};

std::string_view next_step(StopReason reason) {
  const auto* found = std::ranges::find(kNextSteps, reason, &NextStep::reason);
  return found == kNextSteps.end() ? std::string_view{} : found->what_to_do;
}

}  // namespace

Standing standing_of(const RunSummary& summary) {
  if (summary.stop_reason != StopReason::completed) {
    return summary.stop_reason == StopReason::interrupted && summary.data_valid ? Standing::fair : Standing::bad;
  }
  if (!summary.data_valid) return Standing::bad;
  return summary.stalls.count > 0 || !summary.faults.empty() ? Standing::fair : Standing::good;
}

std::vector<std::string> advice_for(const RunSummary& summary) {
  std::vector<std::string> advice;
  if (!summary.end.why.empty()) advice.push_back("Cause: " + summary.end.why + ".");
  if (summary.stop_reason != StopReason::completed) advice.emplace_back(next_step(summary.stop_reason));
  for (const InterlockSummary& interlock : summary.interlocks) {
    if (summary.end.why.find(interlock.cause) != std::string::npos) continue;  // said already
    advice.push_back(fmt::format("Interlock of {} at {} s: {}.", interlock.participant,
                                 short_number(interlock.model_time_s, 3), interlock.cause));
  }
  for (const std::string& fault : summary.data_faults) advice.push_back("The data are invalid: " + fault + ".");
  if (!summary.data_faults.empty()) {
    advice.emplace_back(
        "Do not use results that need the missing records. Use another disk or a lower control rate, and run the test "
        "again.");
  }
  if (summary.stalls.count > 0) {
    advice.push_back(fmt::format(
        "The specimens were held {} for up to {} s, because the next target came late. A material that creeps or "
        "relaxes feels this; a larger `time_scale` or a better network avoids it.",
        summary.stalls.count == 1 ? std::string{"once"} : fmt::format("{} times", summary.stalls.count),
        short_number(summary.stalls.longest_s, 2)));
  }
  for (const std::string& fault : summary.faults) advice.push_back("Fault: " + fault + ".");
  for (const std::string& remark : summary.remarks) advice.push_back("Remark: " + remark + ".");
  return advice;
}

}  // namespace hybridtest::run_report
