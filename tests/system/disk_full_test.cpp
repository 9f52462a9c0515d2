#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>

#include <cerrno>
#include <cstring>
#include <ostream>
#include <string>

#include "tests/support/recording_checks.hpp"
#include "tests/support/system_fixture.hpp"

/// No disk space for records: the test continues or ends, as the scenario says, and is never valid.
namespace hybridtest {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::Optional;

constexpr double kSteps = 6000.0;
constexpr std::uint64_t kRoom_bytes = 400'000;  // for some 2000 steps of any participant

Arguments six_seconds(const std::string& on_failure) {
  return {"--set", "time.duration_s=6", "--set", "recording={on_failure: " + on_failure + "}"};
}

class DiskFull : public SystemTest {
 protected:
  void expect_completed_without_all_data(const std::string& run) const {
    const nlohmann::json summary = recorded(run).summary();
    EXPECT_EQ(summary["stop_reason"], "completed");
    EXPECT_EQ(summary["completed_steps"], static_cast<int>(kSteps));
    expect_invalid(summary);
  }
  void expect_ended_safely(const std::string& run) const {
    const nlohmann::json summary = recorded(run).summary();
    EXPECT_EQ(summary["stop_reason"], "recording_failed");
    EXPECT_LT(summary["completed_steps"], static_cast<int>(kSteps));
    expect_invalid(summary);
  }

 private:
  static void expect_invalid(const nlohmann::json& summary) {
    EXPECT_EQ(summary["exit_code"], kExitDataInvalid);
    EXPECT_EQ(summary["data_valid"], false);
    EXPECT_THAT(summary["verdict"].get<std::string>(), HasSubstr("data invalid"));
  }
};

TEST_F(DiskFull, ContinueCompletesTestWithInvalidData) {
  StartedProgram run = start_run(shipped_scenario("two_storey_one_site"), "run", six_seconds("continue"),
                                 {.file_bytes_max = kRoom_bytes});
  ASSERT_THAT(run.wait(), Optional(kExitDataInvalid)) << run.standard_error();
  EXPECT_THAT(run.standard_output(), HasSubstr("DATA INVALID"));
  EXPECT_THAT(run.standard_error(), HasSubstr("recording failed"));
  const RecordedRun record = recorded("run");
  EXPECT_EQ(record.summary()["data_valid"], false);
  // With disk space again the files are repaired.
  StartedProgram summary = start_hybridtest({"summary", record.directory().string()}, "summary");
  ASSERT_THAT(summary.wait(), Optional(kExitDataInvalid)) << summary.standard_error();
  for (const char* participant : {"coordinator", "storey_1"}) {
    const RunFileCounters counters = record.open(participant).counters();
    EXPECT_TRUE(counters.write_failed) << participant;
    EXPECT_GT(counters.dropped_rows(), 0U) << participant;
    expect_opens_with_h5dump(record.file(participant), directory());
    expect_all_steps_from_the_first(record, participant);
  }
}

TEST_F(DiskFull, StopEndsTestSafelyWithInvalidData) {
  StartedProgram run =
      start_run(shipped_scenario("two_storey_one_site"), "run", six_seconds("stop"), {.file_bytes_max = kRoom_bytes});
  ASSERT_THAT(run.wait(), Optional(kExitDataInvalid)) << run.standard_error();
  EXPECT_EQ(recorded("run").summary()["data_valid"], false);
  EXPECT_THAT(run.standard_error(), HasSubstr("recording_failed"));
  expect_all_steps_from_the_first(recorded("run"), "coordinator");
  EXPECT_LT(recorded("run").last_step("storey_2"), kSteps);
}

class SimulatedDiskFull : public DiskFull, public ::testing::WithParamInterface<std::string> {};

TEST_P(SimulatedDiskFull, KeepsItsRowsAsRunDoes) {
  StartedProgram simulate = start_simulate(shipped_scenario("two_storey_one_site"), "run", six_seconds(GetParam()),
                                           {.file_bytes_max = kRoom_bytes});
  ASSERT_THAT(simulate.wait(), Optional(kExitDataInvalid)) << simulate.standard_error();
  EXPECT_THAT(simulate.standard_output(), HasSubstr("DATA INVALID"));
  EXPECT_THAT(simulate.standard_error(),
              AllOf(HasSubstr("recording failed (File too large): data are missing from here on; check the free space"),
                    HasSubstr("the recording failed: "), HasSubstr("file write failed: File too large (errno = 27)\n"),
                    Not(HasSubstr("lock"))));
  const bool stops = GetParam() == "stop";
  const std::string end = stops ? "test stopped: recording_failed" : "test completed";
  EXPECT_THAT(simulate.standard_error(), HasSubstr(end));
  // With disk space again the files are repaired.
  StartedProgram summary = start_hybridtest({"summary", recorded("run").directory().string()}, "summary");
  ASSERT_THAT(summary.wait(), Optional(kExitDataInvalid)) << summary.standard_error();
  for (const char* participant : {"coordinator", "storey_1"}) {
    expect_opens_with_h5dump(recorded("run").file(participant), directory());
    expect_all_steps_from_the_first(recorded("run"), participant);
    EXPECT_GT(recorded("run").last_step(participant), 500.0) << participant;
  }
  const double reached = recorded("run").last_step("storey_2");
  EXPECT_TRUE(stops ? reached < kSteps : reached == kSteps) << reached;
}

INSTANTIATE_TEST_SUITE_P(OnFailure, SimulatedDiskFull, ::testing::Values("continue", "stop"),
                         [](const auto& instance) { return instance.param; });

/// One participant of three has no room; it runs by hand, the others from `hybridtest run` or by hand.
struct OneFullDisk {
  std::string participant;
  std::string on_failure;
};

void PrintTo(const OneFullDisk& full, std::ostream* stream) { *stream << full.participant << ' ' << full.on_failure; }

class OneDiskFull : public DiskFull, public ::testing::WithParamInterface<OneFullDisk> {};

TEST_P(OneDiskFull, DecidesOutcomeOfWholeTest) {
  const std::filesystem::path scenario = shipped_scenario("two_storey_one_site");
  const Arguments arguments = six_seconds(GetParam().on_failure);
  const auto start = [&](const std::string& program_name, const std::string& id) {
    ProgramOptions options;
    if (id == GetParam().participant) options.file_bytes_max = kRoom_bytes;
    return start_participant(program_name, id, scenario, "run", arguments, options);
  };
  StartedProgram coordinator = start("coordinator", "coordinator");
  StartedProgram site = start("experimental_site", "storey_1");
  StartedProgram numerical = start("numerical_substructure", "storey_2");
  const auto coordinator_exit = coordinator.wait();
  ASSERT_TRUE(coordinator_exit.has_value()) << coordinator.standard_error();
  ASSERT_TRUE(site.wait().has_value()) << site.standard_error();
  ASSERT_TRUE(numerical.wait().has_value()) << numerical.standard_error();
  const bool stops = GetParam().on_failure == "stop";
  if (stops || GetParam().participant == "coordinator") {
    EXPECT_EQ(*coordinator_exit, kExitDataInvalid);
  }

  StartedProgram summary = start_hybridtest({"summary", (directory() / "run").string()}, "summary");
  ASSERT_THAT(summary.wait(), Optional(kExitDataInvalid)) << summary.standard_error();
  EXPECT_THAT(summary.standard_output(), HasSubstr(GetParam().participant));
  if (GetParam().participant == "coordinator") {
    // It could not record its own end either.
    EXPECT_EQ(recorded("run").summary()["data_valid"], false);
    const double reached = recorded("run").last_step("storey_2");
    EXPECT_TRUE(stops ? reached < kSteps : reached == kSteps) << reached;
  } else if (stops) {
    expect_ended_safely("run");
  } else {
    expect_completed_without_all_data("run");
  }
}

INSTANTIATE_TEST_SUITE_P(Each, OneDiskFull,
                         ::testing::Values(OneFullDisk{"coordinator", "continue"}, OneFullDisk{"coordinator", "stop"},
                                           OneFullDisk{"storey_1", "continue"}, OneFullDisk{"storey_1", "stop"}),
                         [](const auto& instance) {
                           return instance.param.participant + "_" + instance.param.on_failure;
                         });

/// A file system of a given size that only this process and its children see.
class SmallDisk {
 public:
  explicit SmallDisk(std::filesystem::path place) : place_{std::move(place)} {
    std::filesystem::create_directories(place_);
    // Mounts made from here on stay in here.
    if (::unshare(CLONE_NEWNS) != 0 || ::mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0) return;
    is_there_ = ::mount("tmpfs", place_.c_str(), "tmpfs", 0, "size=1m") == 0;
  }
  ~SmallDisk() {
    if (is_there_) ::umount2(place_.c_str(), MNT_DETACH);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  [[nodiscard]] bool is_there() const noexcept { return is_there_; }

 private:
  std::filesystem::path place_;
  bool is_there_ = false;
};

class WholeDiskFull : public DiskFull, public ::testing::WithParamInterface<std::string> {};

TEST_P(WholeDiskFull, StillPrintsAVerdict) {
  const SmallDisk disk{directory() / "small"};
  if (!disk.is_there()) GTEST_SKIP() << "a small file system takes the right to mount one: " << std::strerror(errno);
  StartedProgram run = start_run(shipped_scenario("two_storey_one_site"), "small/run", six_seconds(GetParam()));
  ASSERT_THAT(run.wait(), Optional(kExitDataInvalid)) << run.standard_error();
  EXPECT_THAT(run.standard_output(), HasSubstr("DATA INVALID")) << run.standard_error();
  for (const char* participant : {"coordinator", "storey_1"}) {
    expect_all_steps_from_the_first(recorded("small/run"), participant);
    expect_opens_with_h5dump(recorded("small/run").file(participant), directory());
  }
}

INSTANTIATE_TEST_SUITE_P(OnFailure, WholeDiskFull, ::testing::Values("continue", "stop"),
                         [](const auto& instance) { return instance.param; });

}  // namespace
}  // namespace hybridtest
