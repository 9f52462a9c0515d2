#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <string>
#include <vector>

#include "core/opensees_program.hpp"
#include "tests/support/opensees.hpp"
#include "tests/support/opensees_record.hpp"
#include "tests/support/recording_checks.hpp"
#include "tests/support/system_fixture.hpp"

/// A model in the real OpenSees is a substructure of a test that our coordinator leads.
namespace hybridtest {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Optional;

class OpenSeesSubstructure : public SystemTest {
 protected:
  /// The second storey of the shipped building in OpenSees.
  [[nodiscard]] Arguments storey_in_opensees(const std::string& more_keys = "", const std::string& more_lines = "") {
    std::ofstream{directory() / "steel.tcl"} << "uniaxialMaterial Steel01 1 30.0e3 3.0e6 0.05\n";
    std::ofstream{directory() / "storey.tcl"} << "model basic -ndm 1 -ndf 1\nnode 1 0.0\nnode 2 0.0\nfix 1 1\n"
                                                 "source steel.tcl\nelement zeroLength 1 1 2 -mat 1 -dir 1\n"
                                              << more_lines;
    return {"--set", "substructures[storey_2].model={type: opensees, script: " + (directory() / "storey.tcl").string() +
                         ", interface: [{node: 2, dof: 1}]" + more_keys + "}"};
  }
  [[nodiscard]] std::vector<double> displacement(const std::string& run, const std::string& dof) const {
    return recorded(run).column(kCoordinatorId, "steps", "displacement_" + dof + "_m");
  }
  /// The process of OpenSees below the participant; 0 when there is none.
  static pid_t opensees_of(const StartedProgram& run, std::string_view id) {
    const pid_t participant = participant_of(run, id);
    if (participant == 0) return 0;
    const std::string process = std::to_string(participant);
    std::ifstream children{"/proc/" + process + "/task/" + process + "/children"};
    pid_t child = 0;
    return children >> child ? child : 0;
  }
  /// A run that takes steps, with the process of its OpenSees.
  std::pair<StartedProgram, pid_t> start_endless(const std::string& more_keys = "") {
    Arguments arguments = storey_in_opensees(more_keys);
    arguments.insert(arguments.end(),
                     {"--set", "time.duration_s=600", "--set", "substructures[storey_1].limits.command_age_s=60"});
    StartedProgram run = start_run(shipped_scenario("two_storey_one_site"), "run", arguments);
    EXPECT_TRUE(has_recorded("run", "coordinator", 500.0)) << run.standard_error();
    const pid_t opensees = opensees_of(run, "storey_2");
    EXPECT_NE(opensees, 0);
    return {std::move(run), opensees};
  }
  void expect_failed(const std::string& why) const {
    const nlohmann::json summary = recorded("run").summary();
    EXPECT_EQ(summary["stop_reason"], "model_failed");
    EXPECT_EQ(summary["end"]["who"], "storey_2");
    EXPECT_THAT(summary["end"]["why"].get<std::string>(), HasSubstr(why));
  }
};

TEST_F(OpenSeesSubstructure, StoreyIsOurOwnLaw) {
  HYBRIDTEST_NEEDS_OPENSEES();
  const Arguments short_test{"--set", "time.duration_s=12"};
  Arguments own = short_test;
  own.insert(own.end(), {"--set",
                         "substructures[storey_2].model={type: bilinear, stiffness_n_per_m: 3.0e6, "
                         "yield_force_n: 30.0e3, hardening_ratio: 0.05}"});
  Arguments theirs = storey_in_opensees();
  theirs.insert(theirs.end(), short_test.begin(), short_test.end());
  StartedProgram with_law = start_simulate(shipped_scenario("two_storey_one_site"), "law", own);
  StartedProgram with_opensees = start_simulate(shipped_scenario("two_storey_one_site"), "opensees", theirs);
  ASSERT_THAT(with_law.wait(), Optional(kExitCompleted)) << with_law.standard_error();
  ASSERT_THAT(with_opensees.wait(), Optional(kExitCompleted)) << with_opensees.standard_error();
  for (const std::string dof : {"floor_1", "floor_2"}) {
    EXPECT_LT(peak_error(displacement("opensees", dof), displacement("law", dof)), 1e-9) << dof;
  }
  StartedProgram again = start_simulate(shipped_scenario("two_storey_one_site"), "again", theirs);
  ASSERT_THAT(again.wait(), Optional(kExitCompleted)) << again.standard_error();
  EXPECT_EQ(displacement("again", "floor_2"), displacement("opensees", "floor_2")) << "the same seed, the same bits";
}

TEST_F(OpenSeesSubstructure, IteratedStepsAreThoseOfOurOwnLaw) {
  HYBRIDTEST_NEEDS_OPENSEES();
  // All substructures are computed; Newton's iterations try displacements and take them back.
  const auto scenario = directory() / "two_models.yaml";
  std::ofstream{scenario}
      << "schema: hybridtest/1\nname: two_models\n"
         "time: {mode: lockstep, step_s: 0.01, duration_s: 6.0}\n"
         "excitation: {ground_motion: "
      << (shipped_scenario("two_storey_one_site").parent_path() / "ground_motions/design_ec8_c.AT2").string()
      << "}\nstructure: {degrees_of_freedom: [floor_1, floor_2], mass_kg: {floor_1: 20.0e3, "
         "floor_2: 20.0e3}, damping: {type: none}}\nintegrator: {type: implicit_newmark}\n"
         "substructures:\n"
         "  - {id: storey_1, kind: numerical, interface: [{dof: floor_1}], model: {type: elastic, "
         "stiffness_n_per_m: 4.0e6}}\n"
         "  - {id: storey_2, kind: numerical, interface: [{dof: floor_2, relative_to: floor_1}], "
         "model: {type: bilinear, stiffness_n_per_m: 3.0e6, yield_force_n: 30.0e3, "
         "hardening_ratio: 0.05}}\n";
  StartedProgram law = start_simulate(scenario, "law");
  StartedProgram opensees = start_simulate(scenario, "opensees", storey_in_opensees());
  ASSERT_THAT(law.wait(), Optional(kExitCompleted)) << law.standard_error();
  ASSERT_THAT(opensees.wait(), Optional(kExitCompleted)) << opensees.standard_error();
  EXPECT_LT(peak_error(displacement("opensees", "floor_2"), displacement("law", "floor_2")), 1e-6);
  EXPECT_GT(peak_of(recorded("opensees").column(kCoordinatorId, "steps", "iterations")), 1.0);
}

TEST_F(OpenSeesSubstructure, RunHasScriptSourcesAndOutput) {
  HYBRIDTEST_NEEDS_OPENSEES();
  const auto scenario = directory() / "scenario.yaml";
  static_cast<void>(storey_in_opensees());
  std::string text = text_of(shipped_scenario("two_storey_one_site"));
  std::filesystem::create_directory_symlink(shipped_scenario("two_storey_one_site").parent_path() / "ground_motions",
                                            directory() / "ground_motions");
  const std::string model = "{type: elastic, stiffness_n_per_m: 3.0e6}";
  ASSERT_THAT(text, HasSubstr(model));
  text.replace(text.find(model), model.size(), "{type: opensees, script: storey.tcl, interface: [{node: 2, dof: 1}]}");
  std::ofstream{scenario} << text;
  StartedProgram run = start_run(scenario, "run", {"--set", "time.duration_s=2"});
  ASSERT_THAT(run.wait(), Optional(kExitCompleted)) << run.standard_error();
  EXPECT_EQ(text_of(directory() / "run" / "storey.tcl"), text_of(directory() / "storey.tcl"));
  EXPECT_TRUE(std::filesystem::exists(directory() / "run" / "steel.tcl")) << "named in `source`";
  EXPECT_THAT(text_of(directory() / "run" / "storey_2_model.log"), HasSubstr("OpenSees"));
}

TEST_F(OpenSeesSubstructure, KilledModelEndsTheTestWithItsSignal) {
  HYBRIDTEST_NEEDS_OPENSEES();
  auto [run, opensees] = start_endless();
  ASSERT_TRUE(send_signal(opensees, SIGKILL));
  ASSERT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  expect_failed("its process was ended by signal 9");
  EXPECT_THAT(text_of(directory() / "run" / "storey_2.log"), HasSubstr("the end of its output"));
}

TEST_F(OpenSeesSubstructure, StoppedModelEndsTheTestInBoundedTime) {
  HYBRIDTEST_NEEDS_OPENSEES();
  auto [run, opensees] = start_endless(", answer_timeout_s: 2");
  ASSERT_TRUE(send_signal(opensees, SIGSTOP));
  ASSERT_THAT(run.wait(std::chrono::seconds{20}), Optional(kExitEndedEarly)) << run.standard_error();
  expect_failed("has not answered for 2 s");
  EXPECT_TRUE(wait_until([process = opensees] { return !is_alive(process); })) << "no process is left";
}

TEST_F(OpenSeesSubstructure, SlowStepDoesNotEndTheTest) {
  HYBRIDTEST_NEEDS_OPENSEES();
  // One step takes longer than the liveliness lease of 2 s.
  Arguments arguments = storey_in_opensees(
      "", "trace add execution setTime enter {apply {args {if {[incr ::steps] == 5} {after 3000}}}}\n");
  arguments.insert(arguments.end(),
                   {"--set", "time.duration_s=0.1", "--set", "substructures[storey_1].limits.command_age_s=60"});
  StartedProgram run = start_run(shipped_scenario("two_storey_one_site"), "run", arguments);
  ASSERT_THAT(run.wait(), Optional(kExitCompleted)) << run.standard_error();
  EXPECT_GT(recorded("run").column(kCoordinatorId, "steps", "wall_time_s").back(), 3.0);
}

TEST_F(OpenSeesSubstructure, ModelDiesWithItsParticipant) {
  HYBRIDTEST_NEEDS_OPENSEES();
  auto [run, opensees] = start_endless();
  ASSERT_TRUE(send_signal(opensees, SIGSTOP)) << "it does not even notice";
  ASSERT_TRUE(send_signal(participant_of(run, "storey_2"), SIGKILL));
  ASSERT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  EXPECT_TRUE(wait_until([process = opensees] { return !is_alive(process); }));
}

TEST_F(OpenSeesSubstructure, WrongScriptNeverStarts) {
  HYBRIDTEST_NEEDS_OPENSEES();
  const Arguments arguments = storey_in_opensees("", "analyze 100 0.01\n");
  StartedProgram run = start_run(shipped_scenario("two_storey_one_site"), "run", arguments);
  ASSERT_THAT(run.wait(), Optional(kExitConfiguration));
  EXPECT_THAT(run.standard_error(), AllOf(HasSubstr("storey.tcl"), HasSubstr("a transient analysis")));
}

/// The shipped example against the same model with everything in OpenSees.
class IsolatedFrame : public OpenSeesSubstructure {
 protected:
  static void change(std::string& script, const std::string& from, const std::string& to) {
    ASSERT_THAT(script, HasSubstr(from));
    script.replace(script.find(from), from.size(), to);
  }
  static std::string shipped_script() { return text_of(folder() / "isolated_frame.tcl"); }
  /// Largest error of a level over its peak.
  /// @param script   of the model and of the reference.
  double error_of(std::string script, Arguments more, const Arguments& unsplit_arguments) {
    std::filesystem::create_directories(directory() / "opensees");
    std::filesystem::create_directory_symlink(folder().parent_path() / "ground_motions",
                                              directory() / "ground_motions");
    limit_opensees_threads();
    // Long enough for the strong part of the motion.
    change(script, "analyze 31000", "analyze 8000");
    more.insert(more.end(), {"--set", "time.duration_s=8"});
    const auto model = directory() / "opensees" / "isolated_frame.tcl";
    std::ofstream{model} << script;
    more.insert(more.end(), {"--set", "substructures[frame].model.script=" + model.string()});
    StartedProgram split = start_simulate(folder() / "isolated_frame.yaml", "split", more);
    Arguments reference{model.string()};
    reference.insert(reference.end(), unsplit_arguments.begin(), unsplit_arguments.end());
    StartedProgram unsplit{
        test_opensees(), reference, directory() / "unsplit", {.working_directory = directory() / "opensees"}};
    EXPECT_THAT(split.wait(), Optional(kExitCompleted)) << split.standard_error();
    EXPECT_THAT(unsplit.wait(), Optional(0)) << unsplit.standard_error();
    const auto levels = columns_of(directory() / "opensees" / "levels.txt");  // from step 1 on
    double largest = 0.0;
    for (const auto& [dof, column] : {std::pair{"raft", 1U}, std::pair{"floor_1", 2U}, std::pair{"floor_2", 3U}}) {
      std::vector<double> found = displacement("split", dof);
      found.erase(found.begin());
      EXPECT_EQ(found.size(), levels.at(column).size());
      largest = std::max(largest, peak_error(found, levels[column]));
    }
    RecordProperty("error", std::to_string(largest));
    return largest;
  }

 private:
  static std::filesystem::path folder() { return shipped_scenario("opensees/isolated_frame").parent_path(); }
};

TEST_F(IsolatedFrame, OnElasticIsolatorsIsTheUnsplitOne) {
  HYBRIDTEST_NEEDS_OPENSEES();
  const double error =
      error_of(shipped_script(),
               {"--set", "substructures[isolators].rig.specimen={type: elastic, stiffness_n_per_m: 8.0e6}", "--set",
                "substructures[isolators].limits.force_n=5e6"},
               {"unsplit"});
  EXPECT_LT(error, 0.0005) << "at every instant, so also at the peak";
}

TEST_F(IsolatedFrame, OnYieldingIsolatorsIsTheUnsplitOne) {
  HYBRIDTEST_NEEDS_OPENSEES();
  EXPECT_LT(error_of(shipped_script(), {}, {"unsplit", "steel"}), 0.005);
}

TEST_F(IsolatedFrame, OfYieldingFibresIsTheUnsplitOne) {
  HYBRIDTEST_NEEDS_OPENSEES();
  std::string script = shipped_script();
  change(script, "set modulus 200.0e9\n",
         "set modulus 200.0e9\nuniaxialMaterial Steel02 1 60.0e6 200.0e9 0.02 18 0.925 0.15\n"
         "section Fiber 1 {\n patch rect 1 8 1 -0.1 -0.1 0.1 0.1\n}\n");
  change(script, "element elasticBeamColumn $column $bottom $top 0.015 $modulus 2.0e-4 1",
         "element forceBeamColumn $column $bottom $top 4 1 1");
  // Damping of the initial stiffness acts inside the unsplit frame, also where it has yielded.
  change(script, "rayleigh 0.05 0.0 1.0e-3 0.0", "rayleigh 0.05 0.0 0.0 0.0");
  const double error =
      error_of(script,
               {"--set", "substructures[isolators].rig.specimen={type: elastic, stiffness_n_per_m: 8.0e6}", "--set",
                "substructures[isolators].limits.force_n=5e6", "--set", "structure.damping.stiffness_s=0"},
               {"unsplit"});
  EXPECT_LT(error, 0.005);
}

}  // namespace
}  // namespace hybridtest
