#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <fstream>
#include <iostream>
#include <iterator>
#include <string>
#include <vector>

#include "tests/support/system_fixture.hpp"

/// A site with a rig of type `udp`, and a controller in its own process at the other end.
namespace hybridtest {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Optional;

// One text for both programs: JSON is YAML too.
const std::string kTransferSystem =
    R"({"type": "second_order", "natural_frequency_hz": 15.0, "damping_ratio": 0.9, "delay_s": 0.004})";
const std::string kSpecimen =
    R"({"type": "bilinear", "stiffness_n_per_m": 4.0e6, "yield_force_n": 40.0e3, "hardening_ratio": 0.05})";

/// The controller simulator that ships with the program.
class Controller {
 public:
  explicit Controller(const std::filesystem::path& output, Arguments options = {})
      : program_{std::filesystem::path{HYBRIDTEST_SOURCE_DIR} / "launch" / "rig_simulator" / "udp_controller",
                 std::move(options), output} {
    const std::string line_begin = "listening at 127.0.0.1 port ";
    const bool listens = wait_until([&] {
      const std::string text = program_.standard_output();
      const std::size_t begin = text.find(line_begin);
      if (begin == std::string::npos || text.find('\n', begin) == std::string::npos) return !program_.is_running();
      port_ = std::stoi(text.substr(begin + line_begin.size()));
      return true;
    });
    if (!listens || port_ == 0) ADD_FAILURE() << "no controller: " << program_.standard_error();
  }

  [[nodiscard]] int port() const noexcept { return port_; }
  [[nodiscard]] StartedProgram& program() noexcept { return program_; }

 private:
  StartedProgram program_;
  int port_ = 0;
};

class UdpRigTest : public SystemTest {
 protected:
  void SetUp() override {
    if (std::system("python3 -c ''") != 0) GTEST_SKIP() << "python3, which the controller simulator needs, is missing";
  }

  [[nodiscard]] Controller start_controller(const Arguments& more = {}) const {
    Arguments options{"--transfer-system", kTransferSystem, "--specimen", kSpecimen};
    options.insert(options.end(), more.begin(), more.end());
    return Controller{directory() / "controller", options};
  }

  /// @param rig   what follows `type: udp` and the address.
  [[nodiscard]] StartedProgram start_with_udp(int port, const std::string& rig, const Arguments& more) const {
    Arguments arguments{"--set", "substructures[storey_1].rig={type: udp, host: 127.0.0.1, port: " +
                                     std::to_string(port) + ", " + rig + "}"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return start_run(shipped_scenario("two_storey_one_site"), "udp", arguments);
  }

  /// The last value of a column of the link's own table.
  [[nodiscard]] double last_of_link(const std::string& column) const {
    return recorded("udp").column("storey_1", "rig_link", column).back();
  }
};

const Arguments kTenSeconds{"--set", "time.duration_s=10.0"};
/// At the wall's time, 200 steps of 10 control periods a second.
const Arguments kPaced{"--set", "time={mode: paced, step_s: 0.005, duration_s: 60.0}", "--set",
                       "substructures[storey_1].control_rate_hz=400"};

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  EXPECT_EQ(a.size(), b.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

double peak(const std::vector<double>& values) {
  return std::abs(*std::ranges::max_element(values, {}, [](double value) { return std::abs(value); }));
}

TEST_F(UdpRigTest, AgreesWithSimulatedRigOfSamePlant) {
  Controller controller = start_controller();
  StartedProgram udp = start_with_udp(controller.port(), "pace: datagrams", kTenSeconds);
  ASSERT_THAT(udp.wait(), Optional(kExitCompleted)) << udp.standard_error();
  Arguments simulated{"--set", "substructures[storey_1].rig={type: simulated, transfer_system: " + kTransferSystem +
                                   ", specimen: " + kSpecimen + "}"};
  simulated.insert(simulated.end(), kTenSeconds.begin(), kTenSeconds.end());
  StartedProgram reference = start_run(shipped_scenario("two_storey_one_site"), "simulated", simulated);
  ASSERT_THAT(reference.wait(), Optional(kExitCompleted)) << reference.standard_error();

  // Both plants are integrated exactly for commands that run straight from sample to sample, so that no
  // discretisation is left: what differs is the rounding of two formulations, 2e-16 of the value an operation,
  // which over 20 000 control periods with some operations each walks about 1e-13 away.
  constexpr double kRounding = 1e-13;
  const auto compare = [&](const char* participant, const char* table, const char* column) {
    const auto expected = recorded("simulated").column(participant, table, column);
    const double difference = largest_difference(recorded("udp").column(participant, table, column), expected);
    std::cout << column << ": largest difference " << difference / peak(expected) << " of the peak\n";
    EXPECT_LE(difference, kRounding * peak(expected)) << column;
  };
  compare("coordinator", "steps", "displacement_floor_1_m");
  compare("coordinator", "steps", "displacement_floor_2_m");
  compare("storey_1", "control", "measured_displacement_m");
  compare("storey_1", "control", "measured_force_n");
  EXPECT_EQ(last_of_link("answers_skipped"), 0.0);
  EXPECT_EQ(last_of_link("answers_invalid"), 0.0);
}

TEST_F(UdpRigTest, CompletesDespiteLossDuplicationAndReordering) {
  Controller controller = start_controller({"--loss", "0.01", "--duplication", "0.01", "--reordering", "0.01"});
  StartedProgram udp =
      start_with_udp(controller.port(), "pace: datagrams, reply_wait_s: 0.005, watchdog_s: 0.02", kTenSeconds);
  ASSERT_THAT(udp.wait(), Optional(kExitCompleted)) << udp.standard_error();
  EXPECT_EQ(recorded("udp").summary()["data_valid"], true);
  // The return to zero behind the last step included, each of some 20 000 exchanges at 1 % a way.
  EXPECT_GT(last_of_link("answers_skipped"), 100.0);
  EXPECT_GT(last_of_link("answers_stale"), 100.0);
  EXPECT_GT(last_of_link("commands_discarded"), 100.0);
  EXPECT_EQ(last_of_link("answers_invalid"), 0.0);
}

/// The first shell block below a heading of a page.
std::string shell_block(const std::filesystem::path& page, const std::string& heading) {
  std::ifstream stream{page};
  const std::string text{std::istreambuf_iterator<char>{stream}, {}};
  const std::string fence = "```sh\n";
  const std::size_t begin = text.find(fence, text.find("\n## " + heading + "\n"));
  const std::size_t end = text.find("```\n", begin + fence.size());
  if (begin == std::string::npos || end == std::string::npos) return {};
  return text.substr(begin + fence.size(), end - begin - fence.size());
}

std::string replaced(std::string text, const std::string& piece, const std::string& by) {
  for (std::size_t at = text.find(piece); at != std::string::npos; at = text.find(piece, at + by.size())) {
    text.replace(at, piece.size(), by);
  }
  return text;
}

TEST_F(UdpRigTest, ExampleOfTheGuideCompletesAsTyped) {
  const std::filesystem::path source{HYBRIDTEST_SOURCE_DIR};
  std::string commands = shell_block(source / "docs" / "udp_rig.md", "Trying it out");
  ASSERT_THAT(commands, AllOf(HasSubstr("udp_controller --port 5000"), HasSubstr("hybridtest run"), HasSubstr("kill")));
  // Another port, folder and domain, so that other processes on the machine cannot disturb it.
  const std::string port = std::to_string(start_controller().port());
  commands = replaced(replaced(commands, "--port 5000", "--port " + port), "port: 5000", "port: " + port);
  std::string run = "hybridtest run --out " + (directory() / "typed").string();
  for (const std::string& argument : network()) run += " " + argument;
  commands = replaced(commands, "hybridtest run", run);
  std::ofstream{directory() / "typed.sh"} << "set -e\ntrap 'kill $! 2>/dev/null || true' EXIT\ncd '" << source.string()
                                          << "'\nPATH='" << program("").string() << "':$PATH\n"
                                          << commands;
  StartedProgram shell{"/bin/sh", {(directory() / "typed.sh").string()}, directory() / "shell"};
  ASSERT_THAT(shell.wait(), Optional(0)) << shell.standard_error();
  EXPECT_EQ(recorded("typed").summary()["verdict"], "completed");
  EXPECT_THAT(recorded("typed").summary()["remarks"], ::testing::IsEmpty());
}

TEST_F(UdpRigTest, DeadControllerIsAFaultWithinWatchdogTime) {
  constexpr double kWatchdog_s = 0.1;
  Controller controller = start_controller({"--pace", "clock", "--rate-hz", "400"});
  StartedProgram udp = start_with_udp(controller.port(), "watchdog_s: 0.1, reply_wait_s: 0.001", kPaced);
  ASSERT_TRUE(wait_until([&] { return has_recorded("udp", "storey_1", 100.0); })) << udp.standard_error();
  controller.program().signal(SIGKILL);
  ASSERT_THAT(udp.wait(), Optional(kExitEndedEarly)) << udp.standard_error();

  const RecordedRun run = recorded("udp");
  const nlohmann::json summary = run.summary();
  ASSERT_EQ(summary["interlocks"].size(), 1U);
  EXPECT_EQ(summary["interlocks"][0]["limit_name"], "rig_fault");
  EXPECT_EQ(summary["data_valid"], true) << summary["data_faults"];
  EXPECT_EQ(run.events("storey_1", EventCode::interlock_tripped).size(), 1U);

  // Tables of one row per control period each: from the last answer to the fault.
  const auto silent = run.column("storey_1", "rig_link", "silent_samples");
  const auto faults = run.column("storey_1", "control", "faults");
  const auto time_s = run.column("storey_1", "control", "time_s");
  ASSERT_EQ(silent.size(), faults.size());
  const auto fault =
      static_cast<std::size_t>(std::ranges::find(faults, static_cast<double>(FaultFlags::rig_fault)) - faults.begin());
  ASSERT_LT(fault, faults.size());
  std::size_t answer = fault;
  while (answer > 0 && silent[answer] > 0.0) --answer;
  const double noticed_s = time_s[fault] - time_s[answer];
  std::cout << "fault " << 1e3 * noticed_s << " ms after the last answer, watchdog " << 1e3 * kWatchdog_s << " ms\n";
  // A whole number of control periods, so that no rounding up is left but that of the times themselves.
  EXPECT_NEAR(noticed_s, kWatchdog_s, 1e-9);
}

TEST_F(UdpRigTest, StuckSensorsEndTheTest) {
  constexpr double kStuckAfter = 6000.0;  // samples of 0.5 ms, in the middle of the motion
  Controller controller = start_controller({"--stuck-after", "6000"});
  StartedProgram udp = start_with_udp(controller.port(), "pace: datagrams", kTenSeconds);
  ASSERT_THAT(udp.wait(), Optional(kExitEndedEarly)) << udp.standard_error();
  const RecordedRun run = recorded("udp");
  ASSERT_EQ(run.summary()["interlocks"].size(), 1U) << run.summary()["interlocks"];
  EXPECT_EQ(run.summary()["interlocks"][0]["limit_name"], "stuck_sensor");

  const auto faults = run.column("storey_1", "control", "faults");
  const auto fault = std::ranges::find(faults, static_cast<double>(FaultFlags::stuck_sensor)) - faults.begin();
  std::cout << "noticed " << 0.5 * (static_cast<double>(fault) - kStuckAfter) << " ms after the last sound reading\n";
  EXPECT_GT(static_cast<double>(fault), kStuckAfter);
  EXPECT_LT(static_cast<double>(fault), kStuckAfter + 600.0) << "0.1 s, the watchdog, the delay, and 0.2 mm of motion";
}

TEST_F(UdpRigTest, DeadSiteDropsTheEnableAtController) {
  Controller controller = start_controller({"--pace", "clock", "--rate-hz", "400", "--watchdog-s", "0.2"});
  StartedProgram udp = start_with_udp(controller.port(), "watchdog_s: 0.5, reply_wait_s: 0.001", kPaced);
  ASSERT_TRUE(wait_until([&] { return has_recorded("udp", "storey_1", 100.0); })) << udp.standard_error();
  EXPECT_THAT(controller.program().standard_output(), HasSubstr("enable on"));
  EXPECT_THAT(controller.program().standard_output(), ::testing::Not(HasSubstr("enable off")));
  const pid_t site = udp.child({"--id", "storey_1"});
  ASSERT_NE(site, 0);
  ASSERT_TRUE(send_signal(site, SIGKILL));
  EXPECT_TRUE(wait_until([&] {
    return controller.program().standard_output().find(
               "enable off: watchdog: the control loop of the site did not run") != std::string::npos;
  })) << controller.program().standard_output();
  EXPECT_THAT(udp.wait(), Optional(kExitEndedEarly)) << udp.standard_error();
}

TEST_F(UdpRigTest, EndOfTestStopsController) {
  Controller controller = start_controller();
  StartedProgram udp = start_with_udp(controller.port(), "pace: datagrams", {"--set", "time.duration_s=0.1"});
  ASSERT_THAT(udp.wait(), Optional(kExitCompleted)) << udp.standard_error();
  EXPECT_TRUE(wait_until([&] {
    return controller.program().standard_output().find("enable off: requested by the site") != std::string::npos;
  })) << controller.program().standard_output();
}

TEST_F(UdpRigTest, ReportsControllerThatDoesNotAnswer) {
  StartedProgram site = start_participant(
      "experimental_site", "storey_1", shipped_scenario("two_storey_one_site"), "udp",
      {"--set",
       "substructures[storey_1].rig={type: udp, host: 127.0.0.1, port: 9, connect_timeout_s: 0.2, pace: "
       "datagrams}"});
  EXPECT_THAT(site.wait(), Optional(kExitInternal));
  EXPECT_THAT(site.standard_error(), HasSubstr("no answer from the controller 127.0.0.1:9"));
}

TEST_F(UdpRigTest, SimulateRejectsUdpRig) {
  StartedProgram simulate =
      start_simulate(shipped_scenario("two_storey_one_site"), "udp",
                     {"--set", "substructures[storey_1].rig={type: udp, host: 127.0.0.1, port: 9, pace: datagrams}"});
  EXPECT_THAT(simulate.wait(), Optional(kExitConfiguration));
  EXPECT_THAT(simulate.standard_error(), HasSubstr("the rig of storey_1 is of type udp"));
}

}  // namespace
}  // namespace hybridtest
