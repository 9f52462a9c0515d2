#include "runtime/table_notes.hpp"

#include <utility>

namespace hybridtest {
namespace {

/// Rows that come irregularly, or have no time.
TableNote untimed(std::string table, std::string description) {
  return {std::move(table), std::move(description), "", 0.0};
}

TableNote of_refused_packets() {
  return untimed(
      "refused_packets",
      "One row at the end: how many packets the packet filter kept from Fast DDS, by kind: such as would hang "
      "or end the process; with credentials those in plain text, false announcements, and notices that a "
      "participant has left, which genuine ones send, too.");
}

std::vector<TableNote> of_coordinator(const Scenario& scenario) {
  // Where OpenSees leads, its analysis chooses the steps.
  const bool is_regular = !scenario.opensees;
  return {
      {"steps",
       "One row per completed step: ground acceleration, motion of the structure and the forces on it. The first row "
       "is the state before the test. wall_time_s counts from the event test_started.",
       is_regular ? "model_time_s" : "", is_regular ? scenario.time.step_s : 0.0},
      untimed("exchanges",
              "One row per command and answer: which substructure (index from 0 into substructure_ids), how long it "
              "took, how often the command was sent."),
      untimed("clocks",
              "One row per substructure and half second. there: command received less command sent, which is its clock "
              "less the coordinator's plus a latency; back: answer received less answer sent. The least and the mean, "
              "and when the least was, by the coordinator's clock."),
      untimed(
          "bridges",
          "In real time, one row per force that missed its deadline: its step and substructure, its place in the gap, "
          "the work that the force in its place did beyond the measured one (NaN where none followed), and whether "
          "the measured one came late (1) or was interpolated (0)."),
      untimed("answers",
              "Of a test that can be resumed (timeouts.resume_s), one row per command, substructure and interface "
              "degree of freedom: what was commanded and the force that was answered, bit for bit."),
      untimed("opensees", "One row per question of the OpenSees that leads: its step, its trial and its own time."),
      untimed("test", "One row: how many steps were planned and taken, why the test ended, wall time and exit code."),
      untimed("ground_motions", "One row per applied ground motion, after scaling and correction."),
      untimed(
          "response_spectra",
          "Response of an oscillator with 5 % damping to what was applied. mode 0: a period of the grid; otherwise the "
          "number of the structure's mode."),
      of_refused_packets()};
}

std::vector<TableNote> of_site(const Scenario& scenario, const SubstructureScenario& substructure) {
  const ControlLoopSettings settings = control_loop_settings(scenario, substructure);
  const double period_s = settings.step_s / settings.periods_per_step;
  return {
      {"steps", "One row per step: the target of the specimen and what was measured at the end of the step.",
       "model_time_s", scenario.time.step_s},
      {"control",
       "One row per control period: target, command, measured displacement and force. time_s counts control periods "
       "since the site was armed; rows before the start and after the end of the test are in it too.",
       "time_s", period_s},
      untimed("rig_link", "One row per control period: the exchange with the controller of the rig."),
      untimed("rig_actuators", "One row per control period: stroke and force of each actuator."),
      untimed("loop_timing",
              "One row: lateness and duration of the control periods, and what the operating system granted."),
      untimed("loop_start_lateness", "Histogram of the time by which control periods started late; one row per bin."),
      of_refused_packets()};
}

}  // namespace

std::vector<TableNote> table_notes(const Scenario& scenario, std::string_view participant) {
  const SubstructureScenario* substructure = scenario.find(participant);
  if (substructure == nullptr) return of_coordinator(scenario);
  if (substructure->role == Role::experimental_site) return of_site(scenario, *substructure);
  return {{"steps", "One row per step: displacement of each interface degree of freedom and the restoring force.",
           "model_time_s", scenario.time.step_s},
          of_refused_packets()};
}

}  // namespace hybridtest
