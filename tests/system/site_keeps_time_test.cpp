#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <iostream>
#include <string>
#include <vector>

#include "core/faults.hpp"
#include "tests/support/recording_checks.hpp"
#include "tests/support/system_fixture.hpp"

/// The control loop of a site when the coordinator or the link fails.
namespace hybridtest {
namespace {

using ::testing::Optional;

class SiteKeepsTime : public SystemTest {
 protected:
  static constexpr double kCommandAge_s = 0.5;
  const std::filesystem::path scenario_ = shipped_scenario("two_storey_one_site");
  const Arguments paced_{"--set", "time.mode=paced",     "--set", "time.step_s=0.01",
                         "--set", "time.duration_s=30",  "--set", "substructures[storey_1].limits.command_age_s=0.5",
                         "--set", "excitation.scale=0.5"};
};

TEST_F(SiteKeepsTime, LoopRunsWhileCoordinatorIsFrozen) {
  StartedProgram coordinator = start_participant("coordinator", "coordinator", scenario_, "run", paced_);
  StartedProgram numerical = start_participant("numerical_substructure", "storey_2", scenario_, "run", paced_);
  StartedProgram site = start_participant("experimental_site", "storey_1", scenario_, "run", paced_);
  ASSERT_TRUE(has_recorded("run", "storey_1", 100.0)) << site.standard_error();
  coordinator.signal(SIGSTOP);
  // The lease on the coordinator is 2 s; until then the loop runs without commands.
  ASSERT_THAT(site.wait(), Optional(kExitEndedEarly)) << site.standard_error();
  coordinator.signal(SIGKILL);

  const RecordedRun record = recorded("run");
  const auto overdue = record.events("storey_1", EventCode::command_overdue);
  ASSERT_EQ(overdue.size(), 1U);
  EXPECT_GT(overdue[0].values[0], kCommandAge_s);
  // The loop detects it, not the lease; the margin is for a machine that pauses meanwhile.
  EXPECT_LT(overdue[0].values[0], kCommandAge_s + 0.5);

  const std::vector<double> sample = record.column("storey_1", "control", "sample");
  const std::vector<double> time_s = record.column("storey_1", "control", "time_s");
  const std::vector<double> faults = record.column("storey_1", "control", "faults");
  std::size_t tripped = 0;
  while (tripped < faults.size() && faults[tripped] == 0.0) ++tripped;
  ASSERT_LT(tripped, faults.size());
  EXPECT_EQ(faults[tripped], static_cast<double>(static_cast<std::uint32_t>(FaultFlags::command_age)));
  for (std::size_t i = 0; i < sample.size(); ++i) ASSERT_EQ(sample[i], static_cast<double>(i));
  EXPECT_GE(time_s.back() - time_s[tripped], 1.0) << "from then to the end of the lease";

  const double starts = record.column("storey_1", "loop_timing", "starts").at(0);
  const double overruns = record.column("storey_1", "loop_timing", "overruns").at(0);
  std::cout << "start lateness p99 " << record.column("storey_1", "loop_timing", "start_lateness_p99_us").at(0)
            << " us, max " << record.column("storey_1", "loop_timing", "start_lateness_max_us").at(0) << " us, "
            << overruns << " overruns of " << starts << '\n';
  // The machine decides how late it starts; the test checks that it does not wait for the coordinator.
  EXPECT_LT(record.column("storey_1", "loop_timing", "start_lateness_p50_us").at(0), 1e4);
}

TEST_F(SiteKeepsTime, RealTimeRefusalStopsStartWhereRequired) {
  Arguments arguments = paced_;
  // No machine has this processor.
  arguments.insert(arguments.end(), {"--set", "substructures[storey_1].real_time={cpu: 1023, allow_degraded: false}"});
  StartedProgram site = start_participant("experimental_site", "storey_1", scenario_, "run", arguments);
  ASSERT_THAT(site.wait(), Optional(kExitConfiguration));
  EXPECT_THAT(site.standard_error(), ::testing::HasSubstr("processor 1023 was refused: Invalid argument"));
  EXPECT_THAT(site.standard_error(), ::testing::HasSubstr("allow_degraded"));
}

}  // namespace
}  // namespace hybridtest
