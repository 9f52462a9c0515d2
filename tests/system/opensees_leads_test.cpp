#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "core/opensees_program.hpp"
#include "tests/support/opensees.hpp"
#include "tests/support/opensees_record.hpp"
#include "tests/support/recording_checks.hpp"
#include "tests/support/system_fixture.hpp"

/// The real OpenSees leads a test: it integrates, the substructures of the test are its genericClient elements.
namespace hybridtest {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Optional;

/// A port that nothing listens on.
int free_port() {
  const int socket_number = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  bind(socket_number, reinterpret_cast<const sockaddr*>(&address), size);
  getsockname(socket_number, reinterpret_cast<sockaddr*>(&address), &size);
  close(socket_number);
  return ntohs(address.sin_port);
}

class OpenSeesLeads : public SystemTest {
 protected:
  /// A copy of files in launch/scenarios/opensees, at ports of this test alone.
  std::filesystem::path own_copy(const std::string& name) {
    const std::filesystem::path from = shipped_scenario("opensees/" + name).parent_path();
    std::filesystem::create_directories(directory() / "opensees");
    std::filesystem::create_directory_symlink(from.parent_path() / "ground_motions", directory() / "ground_motions");
    for (const char* extension : {".yaml", ".tcl"}) write(name + extension, text_of(from / (name + extension)));
    return directory() / "opensees" / (name + ".yaml");
  }
  void write(const std::string& name, std::string text) {
    for (const std::string shipped : {"8090", "8091"}) {
      if (!ports_.contains(shipped)) ports_[shipped] = std::to_string(free_port());
      replace_all(text, shipped, ports_[shipped]);
    }
    std::ofstream{directory() / "opensees" / name} << text;
  }
  void change(const std::string& name, const std::string& from, const std::string& to) {
    std::string text = text_of(directory() / "opensees" / name);
    ASSERT_THAT(text, HasSubstr(from));
    replace_all(text, from, to);
    std::ofstream{directory() / "opensees" / name} << text;
  }
  static void replace_all(std::string& text, const std::string& from, const std::string& to) {
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
      text.replace(at, from.size(), to);
    }
  }
  /// The same model with everything in OpenSees; its results are in this test's folder.
  void run_unsplit(const std::string& script, const Arguments& more = {}) {
    limit_opensees_threads();
    Arguments arguments{script, "unsplit"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    StartedProgram unsplit{
        test_opensees(), arguments, directory() / "unsplit", {.working_directory = directory() / "opensees"}};
    ASSERT_THAT(unsplit.wait(), Optional(0)) << unsplit.standard_error();
  }
  /// Newton's method to equilibrium, which asks for several displacements in a step.
  void iterate(const std::string& script) {
    change(script, "test NormUnbalance 1.0 1", "test NormUnbalance 1.0e-3 50");
    change(script, "algorithm Linear -initial", "algorithm Newton");
    change(script, "integrator AlphaOS 1.0", "integrator Newmark 0.5 0.25");
  }
  [[nodiscard]] Arguments with_network(Arguments arguments) const {
    const Arguments more = network();
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  [[nodiscard]] int port() const { return std::stoi(ports_.at("8090")); }
  /// The process of OpenSees below `hybridtest run`; 0 when there is none.
  static pid_t opensees_of(const StartedProgram& run) {
    const pid_t coordinator = participant_of(run, kCoordinatorId);
    if (coordinator == 0) return 0;
    std::ifstream children{"/proc/" + std::to_string(coordinator) + "/task/" + std::to_string(coordinator) +
                           "/children"};
    pid_t child = 0;
    return children >> child ? child : 0;
  }

  std::map<std::string, std::string> ports_;
};

TEST_F(OpenSeesLeads, LinearFrameIsTheUnsplitOne) {
  HYBRIDTEST_NEEDS_OPENSEES();
  const std::filesystem::path scenario = own_copy("shear_frame");
  change("shear_frame.tcl", "set duration_s 31.0", "set duration_s 8.0");
  StartedProgram run =
      start_run(scenario, "run",
                {"--set", "substructures[storey_1].rig.specimen={type: elastic, stiffness_n_per_m: 4.0e6}", "--set",
                 "substructures[storey_1].limits.force_n=1e6"});
  ASSERT_THAT(run.wait(), Optional(kExitCompleted)) << run.standard_error();
  run_unsplit("shear_frame.tcl");
  const auto split = columns_of(directory() / "run" / "floors.txt");
  const auto whole = columns_of(directory() / "opensees" / "floors.txt");
  ASSERT_EQ(split.size(), 3U);
  ASSERT_EQ(split[1].size(), 8000U);
  // The same method with the same stiffness: the order of additions alone differs. Asked for: 5e-4.
  EXPECT_LT(peak_error(split[1], whole[1]), 1e-9);
  EXPECT_LT(peak_error(split[2], whole[2]), 1e-9);
}

TEST_F(OpenSeesLeads, YieldingFrameIsTheUnsplitOne) {
  HYBRIDTEST_NEEDS_OPENSEES();
  const std::filesystem::path scenario = own_copy("shear_frame");
  change("shear_frame.tcl", "set duration_s 31.0", "set duration_s 8.0");
  StartedProgram run = start_run(scenario, "run");
  ASSERT_THAT(run.wait(), Optional(kExitCompleted)) << run.standard_error();
  run_unsplit("shear_frame.tcl", {"steel"});
  const auto split = columns_of(directory() / "run" / "floors.txt");
  const auto whole = columns_of(directory() / "opensees" / "floors.txt");
  // The same method and law: the order of additions alone differs. Asked for: 5e-3.
  EXPECT_LT(peak_error(split[1], whole[1]), 1e-9);
  EXPECT_LT(peak_error(split[2], whole[2]), 1e-9);
  // The coordinator recorded the motion that it imposed, at the times of OpenSees.
  const std::vector<double> times = recorded("run").column("coordinator", "opensees", "opensees_time_s");
  EXPECT_NEAR(times.back(), 8.0, 1e-6);
  EXPECT_NEAR(peak_of(recorded("run").column("coordinator", "steps", "displacement_floor_1_m")), peak_of(split[1]),
              1e-4);
  EXPECT_EQ(recorded("run").summary()["stop_reason"], "completed");
}

TEST_F(OpenSeesLeads, FibrePortalWithBraceIsTheUnsplitOne) {
  HYBRIDTEST_NEEDS_OPENSEES();
  const std::filesystem::path scenario = own_copy("portal_with_brace");
  change("portal_with_brace.tcl", "set duration_s 31.0", "set duration_s 8.0");
  StartedProgram run = start_run(scenario, "run");
  ASSERT_THAT(run.wait(), Optional(kExitCompleted)) << run.standard_error();
  run_unsplit("portal_with_brace.tcl");
  const auto split = columns_of(directory() / "run" / "roof.txt");
  const auto whole = columns_of(directory() / "opensees" / "roof.txt");
  // OpenSees commits its own brace at the corrected displacement, the specimen stays at the predicted one: measured
  // 1.2e-4. Asked for: 5e-3.
  EXPECT_LT(peak_error(split[1], whole[1]), 3e-4);
}

TEST_F(OpenSeesLeads, IterationOnASpecimenEndsTheTest) {
  HYBRIDTEST_NEEDS_OPENSEES();
  const std::filesystem::path scenario = own_copy("shear_frame");
  iterate("shear_frame.tcl");
  StartedProgram run = start_run(scenario, "run");
  ASSERT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  EXPECT_EQ(recorded("run").summary()["stop_reason"], "opensees_iterates");
  EXPECT_THAT(run.standard_error(), HasSubstr("a second displacement of 'storey_1' in one step"));
  EXPECT_LT(recorded("run").summary()["completed_steps"], 3000) << "it yields at 2.6 s; before, one trial is enough";
}

TEST_F(OpenSeesLeads, AllowedIterationsAreImposed) {
  HYBRIDTEST_NEEDS_OPENSEES();
  const std::filesystem::path scenario = own_copy("shear_frame");
  change("shear_frame.tcl", "set duration_s 31.0", "set duration_s 6.0");
  iterate("shear_frame.tcl");
  StartedProgram run = start_run(scenario, "run", {"--set", "coordinator.allow_iterations=true"});
  ASSERT_THAT(run.wait(), Optional(kExitCompleted)) << run.standard_error();
  EXPECT_GT(recorded("run").summary()["completed_steps"], 6000) << "more than one in a step of OpenSees";
}

TEST_F(OpenSeesLeads, ModelsMayBeIterated) {
  HYBRIDTEST_NEEDS_OPENSEES();
  const std::filesystem::path scenario = own_copy("shear_frame");
  change("shear_frame.tcl", "set duration_s 31.0", "set duration_s 6.0");
  iterate("shear_frame.tcl");
  std::string text = text_of(scenario);
  text.resize(text.find("substructures:"));
  std::ofstream{scenario} << text
                          << "substructures:\n"
                             "  - id: storey_1\n"
                             "    kind: numerical\n"
                             "    interface: [{dof: floor_1}]\n"
                             "    model: {type: springs, springs: [{type: bilinear, stiffness_n_per_m: 4.0e6, "
                             "yield_force_n: 40.0e3, hardening_ratio: 0.05}]}\n";
  StartedProgram run = start_run(scenario, "run");
  ASSERT_THAT(run.wait(), Optional(kExitCompleted)) << run.standard_error();
  run_unsplit("shear_frame.tcl", {"steel"});
  const auto split = columns_of(directory() / "run" / "floors.txt");
  const auto whole = columns_of(directory() / "opensees" / "floors.txt");
  // Both find the same equilibrium, to the tolerance of 1e-3 N of the test of convergence.
  EXPECT_LT(peak_error(split[1], whole[1]), 1e-6);
}

TEST_F(OpenSeesLeads, SubstructureMayBeAnotherOpenSees) {
  HYBRIDTEST_NEEDS_OPENSEES();
  const std::filesystem::path scenario = own_copy("shear_frame");
  change("shear_frame.tcl", "set duration_s 31.0", "set duration_s 6.0");
  std::ofstream{directory() / "opensees" / "storey.tcl"} << "model BasicBuilder -ndm 1 -ndf 1\n"
                                                            "node 0 0.0\nnode 1 0.0\nfix 0 1\n"
                                                            "uniaxialMaterial Steel01 1 40.0e3 4.0e6 0.05\n"
                                                            "element zeroLength 1 0 1 -mat 1 -dir 1\n";
  std::string text = text_of(scenario);
  text.resize(text.find("substructures:"));
  std::ofstream{scenario} << text
                          << "substructures:\n"
                             "  - id: storey_1\n"
                             "    kind: numerical\n"
                             "    interface: [{dof: floor_1}]\n"
                             "    model: {type: opensees, script: storey.tcl, interface: [{node: 1, dof: 1}]}\n";
  StartedProgram run = start_run(scenario, "run");
  ASSERT_THAT(run.wait(), Optional(kExitCompleted)) << run.standard_error();
  run_unsplit("shear_frame.tcl", {"steel"});
  const auto split = columns_of(directory() / "run" / "floors.txt");
  const auto whole = columns_of(directory() / "opensees" / "floors.txt");
  // The same material and the same commits, in another process. Asked for: 5e-3.
  EXPECT_LT(peak_error(split[1], whole[1]), 1e-9);
  EXPECT_LT(peak_error(split[2], whole[2]), 1e-9);
}

TEST_F(OpenSeesLeads, KilledOpenSeesEndsTheTest) {
  HYBRIDTEST_NEEDS_OPENSEES();
  StartedProgram run = start_run(own_copy("shear_frame"), "run");
  ASSERT_TRUE(wait_until([&] { return has_recorded("run", kCoordinatorId, 500); })) << run.standard_error();
  const pid_t opensees = opensees_of(run);
  ASSERT_NE(opensees, 0);
  send_signal(opensees, SIGKILL);
  ASSERT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  const nlohmann::json summary = recorded("run").summary();
  EXPECT_EQ(summary["stop_reason"], "opensees_lost");
  EXPECT_EQ(summary["end"]["who"], "opensees");
  EXPECT_THAT(summary["end"]["why"].get<std::string>(), HasSubstr("connection closed"));
  expect_rig_came_to_zero(recorded("run"), "storey_1");
  expect_all_steps_from_the_first(recorded("run"), "storey_1");
}

TEST_F(OpenSeesLeads, StoppedOpenSeesEndsTheTestAfterItsSilence) {
  HYBRIDTEST_NEEDS_OPENSEES();
  StartedProgram run = start_run(own_copy("shear_frame"), "run", {"--set", "coordinator.silence_s=1"});
  ASSERT_TRUE(wait_until([&] { return has_recorded("run", kCoordinatorId, 500); })) << run.standard_error();
  const pid_t opensees = opensees_of(run);
  ASSERT_NE(opensees, 0);
  send_signal(opensees, SIGSTOP);
  ASSERT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  EXPECT_EQ(recorded("run").summary()["stop_reason"], "opensees_lost");
  EXPECT_THAT(recorded("run").summary()["end"]["why"].get<std::string>(), HasSubstr("asked for nothing for 1"));
  EXPECT_FALSE(is_alive(opensees)) << "a stopped process is ended too";
}

TEST_F(OpenSeesLeads, OpenSeesEndsWithAKilledCoordinator) {
  HYBRIDTEST_NEEDS_OPENSEES();
  StartedProgram run = start_run(own_copy("shear_frame"), "run");
  ASSERT_TRUE(wait_until([&] { return has_recorded("run", kCoordinatorId, 500); })) << run.standard_error();
  const pid_t opensees = opensees_of(run);
  send_signal(participant_of(run, kCoordinatorId), SIGKILL);
  ASSERT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  EXPECT_EQ(recorded("run").summary()["stop_reason"], "coordinator_lost");
  EXPECT_TRUE(wait_until([&] { return !is_alive(opensees); }));
}

TEST_F(OpenSeesLeads, OpenSeesEndsWithAKilledSite) {
  HYBRIDTEST_NEEDS_OPENSEES();
  StartedProgram run = start_run(own_copy("shear_frame"), "run");
  ASSERT_TRUE(wait_until([&] { return has_recorded("run", kCoordinatorId, 500); })) << run.standard_error();
  const pid_t opensees = opensees_of(run);
  send_signal(participant_of(run, "storey_1"), SIGKILL);
  ASSERT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  EXPECT_EQ(recorded("run").summary()["stop_reason"], "participant_lost");
  EXPECT_FALSE(is_alive(opensees));
}

TEST_F(OpenSeesLeads, InterlockEndsOpenSeesToo) {
  HYBRIDTEST_NEEDS_OPENSEES();
  StartedProgram run =
      start_run(own_copy("shear_frame"), "run", {"--set", "substructures[storey_1].limits.displacement_m=0.005"});
  ASSERT_TRUE(wait_until([&] { return has_recorded("run", kCoordinatorId, 100); })) << run.standard_error();
  const pid_t opensees = opensees_of(run);
  ASSERT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  EXPECT_EQ(recorded("run").summary()["stop_reason"], "interlock");
  EXPECT_FALSE(is_alive(opensees));
}

TEST_F(OpenSeesLeads, PausedTestGoesOnWhereItWas) {
  HYBRIDTEST_NEEDS_OPENSEES();
  const std::filesystem::path scenario = own_copy("shear_frame");
  change("shear_frame.tcl", "set duration_s 31.0", "set duration_s 8.0");
  StartedProgram run = start_run(scenario, "run");
  ASSERT_TRUE(wait_until([&] { return has_recorded("run", kCoordinatorId, 500); })) << run.standard_error();
  StartedProgram pause = start_hybridtest(with_network({"pause", test_name()}), "pause");
  ASSERT_THAT(pause.wait(), Optional(0)) << pause.standard_error();
  StartedProgram resume = start_hybridtest(with_network({"resume", test_name()}), "resume");
  ASSERT_THAT(resume.wait(), Optional(0)) << resume.standard_error();
  ASSERT_THAT(run.wait(), Optional(kExitCompleted)) << run.standard_error();
  run_unsplit("shear_frame.tcl", {"steel"});
  EXPECT_LT(peak_error(columns_of(directory() / "run" / "floors.txt")[1],
                       columns_of(directory() / "opensees" / "floors.txt")[1]),
            1e-9);
}

TEST_F(OpenSeesLeads, StartedByHandItIsToldToBeEndedByHand) {
  HYBRIDTEST_NEEDS_OPENSEES();
  const std::filesystem::path scenario = own_copy("shear_frame");
  change("shear_frame.yaml", "  script: shear_frame.tcl\n", "");
  StartedProgram run = start_run(scenario, "run");
  // Before anybody listens, OpenSees gives up at once.
  ASSERT_TRUE(wait_until([&] { return run.standard_error().find("storey_1: ready") != std::string::npos; }));
  StartedProgram opensees{
      test_opensees(), {"shear_frame.tcl"}, directory() / "by_hand", {.working_directory = directory() / "opensees"}};
  ASSERT_TRUE(wait_until([&] { return has_recorded("run", kCoordinatorId, 500); })) << run.standard_error();
  StartedProgram stop = start_hybridtest(with_network({"stop", test_name()}), "stop");
  // The coordinator may obey and leave before the tool has discovered it; the tool then says that it was not found.
  ASSERT_THAT(stop.wait(), Optional(AnyOf(kExitCompleted, kExitEndedEarly))) << stop.standard_error();
  ASSERT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  EXPECT_THAT(text_of(directory() / "run" / "coordinator.log"), HasSubstr("end its process by hand"));
}

TEST_F(OpenSeesLeads, FailingScriptEndsTheTestAtOnce) {
  HYBRIDTEST_NEEDS_OPENSEES();
  const std::filesystem::path scenario = own_copy("shear_frame");
  change("shear_frame.tcl", "model BasicBuilder", "error {no such beam}\nmodel BasicBuilder");
  StartedProgram run = start_run(scenario, "run");
  ASSERT_THAT(run.wait(), Optional(kExitConfiguration)) << run.standard_error();
  EXPECT_THAT(text_of(directory() / "run" / "coordinator.log"), HasSubstr("no such beam"));
  EXPECT_EQ(recorded("run").summary()["stop_reason"], "participant_failed");
  EXPECT_EQ(recorded("run").summary()["end"]["who"], "opensees");
}

TEST_F(OpenSeesLeads, ForeignClientIsRefusedAndMovesNothing) {
  HYBRIDTEST_NEEDS_OPENSEES();
  const std::filesystem::path scenario = own_copy("shear_frame");
  change("shear_frame.yaml", "  script: shear_frame.tcl\n", "");
  change("shear_frame.tcl", "set duration_s 31.0", "set duration_s 2.0");
  StartedProgram run = start_run(scenario, "run");
  ASSERT_TRUE(wait_until([&] { return run.standard_error().find("storey_1: ready") != std::string::npos; }));
  const int foreign = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port()));
  ASSERT_EQ(connect(foreign, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  const std::string hello = "GET / HTTP/1.1\r\nHost: localhost\r\nAccept: everything\r\n\r\n";
  ASSERT_EQ(send(foreign, hello.data(), hello.size(), 0), std::ssize(hello));
  EXPECT_TRUE(
      wait_until([&] { return run.standard_error().find("does not speak the protocol") != std::string::npos; }));
  close(foreign);
  StartedProgram opensees{
      test_opensees(), {"shear_frame.tcl"}, directory() / "by_hand", {.working_directory = directory() / "opensees"}};
  ASSERT_THAT(run.wait(), Optional(kExitCompleted)) << run.standard_error();
  EXPECT_THAT(opensees.wait(), Optional(0)) << opensees.standard_error();
}

}  // namespace
}  // namespace hybridtest
