#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/support/rtps_packets.hpp"
#include "tests/support/system_fixture.hpp"

/// Whole tests to whose participants somebody sends packets that would keep Fast DDS busy for years, or end the
/// process.
namespace hybridtest {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::Optional;

constexpr int kEach = 20;  // to each port

class RefusedPacketsLive : public SystemTest {
 protected:
  const std::filesystem::path scenario_ = shipped_scenario("two_storey_one_site");
  // Long enough to send something meanwhile, and patient on a busy machine.
  const Arguments arguments_{"--set", "time.duration_s=8", "--set",
                             "timeouts={discovery_s: 120, liveliness_lease_s: 30}"};

  /// To every port that a participant on this host can have, RTPS 9.6.1.1.
  void send_to_all_ports(const std::vector<std::uint8_t>& packet) const {
    constexpr int kParticipants = 10;  // and tools
    const int first = 7400 + 250 * std::stoi(network().back()) + 10;
    for (int port = first; port < first + 2 * kParticipants; ++port) {
      for (int i = 0; i < kEach; ++i) EXPECT_TRUE(send_to(static_cast<std::uint16_t>(port), packet));
    }
  }
  [[nodiscard]] std::string log_of(const std::string& participant) const {
    return text_of(directory() / "run" / (participant + ".log"));
  }
  void expect_same_as_simulated() {
    StartedProgram simulated = start_simulate(scenario_, "simulated", arguments_);
    ASSERT_THAT(simulated.wait(), Optional(kExitCompleted)) << simulated.standard_error();
    EXPECT_EQ(recorded("run").column(kCoordinatorId, "steps", "displacement_floor_2_m"),
              recorded("simulated").column(kCoordinatorId, "steps", "displacement_floor_2_m"));
  }
  /// A run to which this packet is sent in the middle.
  StartedProgram completed_run(const std::vector<std::uint8_t>& packet) {
    StartedProgram run = start_run(scenario_, "run", arguments_);
    EXPECT_TRUE(has_recorded("run", kCoordinatorId, 10.0)) << run.standard_error();
    send_to_all_ports(packet);
    EXPECT_TRUE(run.is_running()) << "the test was over before the packets were sent";
    EXPECT_THAT(run.wait(), Optional(kExitCompleted)) << run.standard_error();
    return run;
  }
  /// Every participant refuses them, says so, and goes on.
  void expect_refused(const std::vector<std::uint8_t>& packet) {
    const StartedProgram run = completed_run(packet);
    const nlohmann::json participants = recorded("run").summary()["participants"];
    ASSERT_EQ(participants.size(), 3U);
    for (const nlohmann::json& one : participants) {
      const std::string id = one["participant"];
      // A port of discovery and one of messages.
      EXPECT_EQ(one["refused_packets"]["harmful"], 2 * kEach) << id;
      EXPECT_EQ(one["refused_packets"]["in_plain_text"], 0) << id;
      EXPECT_THAT(log_of(id), HasSubstr("packets refused by the packet filter: 40 that would hang or end the process"));
    }
    EXPECT_THAT(run.standard_output(), HasSubstr("packets refused"));
    expect_same_as_simulated();
  }
};

TEST_F(RefusedPacketsLive, ThatWouldKeepItBusyForYears) { expect_refused(gap_up_to(std::uint64_t{1} << 60U)); }

TEST_F(RefusedPacketsLive, ThatWouldEndTheProcess) { expect_refused(fragment_without_data()); }

/// Control: a gap that a test could have is read, and nothing is told.
TEST_F(RefusedPacketsLive, NothingIsToldWhereNoneWasRefused) {
  const StartedProgram run = completed_run(gap_up_to(5));
  for (const nlohmann::json& one : recorded("run").summary()["participants"]) {
    const std::string id = one["participant"];
    EXPECT_EQ(one["refused_packets"]["harmful"], 0) << id;
    EXPECT_THAT(log_of(id), Not(HasSubstr("packets refused")));
  }
  EXPECT_THAT(run.standard_output(), Not(HasSubstr("packets refused")));
  expect_same_as_simulated();
}

}  // namespace
}  // namespace hybridtest
