#include "experimental_site/rigs/replay_rig.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "core/config_error.hpp"

namespace hybridtest {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

RecordedMeasurement three_rows() {
  return {.time_s = {10.0, 10.1, 10.3},
          .displacement_m = {SiteVector{{0.0}}, SiteVector{{0.01}}, SiteVector{{0.05}}},
          .force_n = {SiteVector{{100.0}}, SiteVector{{200.0}}, SiteVector{{-200.0}}}};
}

struct Replay {
  explicit Replay(ReplayRig::AtEnd at_end) : rig{three_rows(), at_end} {
    rig.connect();
    rig.arm();
  }
  RigStatus at(double time_s) {
    ActuatorCommand command;
    command.time_s = time_s;
    command.displacement_m = SiteVector{{0.9}};
    return rig.exchange(command, feedback);
  }
  ReplayRig rig;
  RigFeedback feedback{SiteVector::Zero(1), SiteVector::Zero(1)};
};

TEST(ReplayRig, InterpolatesTheRecordForAnyCommand) {
  Replay replay{ReplayRig::AtEnd::fault};
  ASSERT_EQ(replay.at(0.0), RigStatus::healthy);
  EXPECT_EQ(replay.feedback.displacement_m[0], 0.0);
  EXPECT_EQ(replay.feedback.force_n[0], 100.0);
  ASSERT_EQ(replay.at(0.05), RigStatus::healthy);
  // 10.05 s and 10.1 s are rounded to 2e-15 s, over 0.1 s.
  EXPECT_NEAR(replay.feedback.displacement_m[0], 0.005, 1e-15);
  EXPECT_NEAR(replay.feedback.force_n[0], 150.0, 1e-11);
  ASSERT_EQ(replay.at(0.2), RigStatus::healthy);
  EXPECT_NEAR(replay.feedback.displacement_m[0], 0.03, 1e-15);
  EXPECT_NEAR(replay.feedback.force_n[0], 0.0, 1e-11);
}

TEST(ReplayRig, FaultsOrHoldsAtEndAsConfigured) {
  Replay fault{ReplayRig::AtEnd::fault};
  EXPECT_EQ(fault.at(0.29), RigStatus::healthy);
  EXPECT_EQ(fault.at(0.31), RigStatus::fault);
  EXPECT_EQ(fault.feedback.displacement_m[0], 0.05);
  Replay hold{ReplayRig::AtEnd::hold};
  EXPECT_EQ(hold.at(100.0), RigStatus::healthy);
  EXPECT_EQ(hold.feedback.force_n[0], -200.0);
}

TEST(ReplayRig, HoldsStartUntilArmedAndPositionWhenStopped) {
  ReplayRig rig{three_rows(), ReplayRig::AtEnd::fault};
  rig.connect();
  ActuatorCommand command;
  command.displacement_m = SiteVector::Zero(1);
  command.time_s = 0.2;
  RigFeedback feedback{SiteVector::Zero(1), SiteVector::Zero(1)};
  ASSERT_EQ(rig.exchange(command, feedback), RigStatus::healthy);
  EXPECT_EQ(feedback.force_n[0], 100.0);
  rig.arm();
  command.time_s = 0.1 + 1e-9;
  ASSERT_EQ(rig.exchange(command, feedback), RigStatus::healthy);
  EXPECT_NEAR(feedback.displacement_m[0], 0.01, 1e-9);
  rig.stop_motion();
  const double stopped_m = feedback.displacement_m[0];
  command.time_s = 0.25;
  ASSERT_EQ(rig.exchange(command, feedback), RigStatus::healthy);
  EXPECT_EQ(feedback.displacement_m[0], stopped_m);
}

TEST(ReplayRig, RejectsInvalidRecord) {
  const auto refused = [](auto change, const char* why) {
    RecordedMeasurement record = three_rows();
    change(record);
    EXPECT_THAT([&] { ReplayRig(record, ReplayRig::AtEnd::fault); }, ThrowsMessage<ConfigError>(HasSubstr(why)));
  };
  refused([](auto& record) { record = {}; }, "a record of 0 times");
  refused([](auto& record) { record.force_n.pop_back(); }, "2 forces");
  refused([](auto& record) { record.time_s[2] = 10.1; }, "row 3 of the record: its time is not later");
  refused([](auto& record) { record.force_n[1][0] = std::numeric_limits<double>::quiet_NaN(); }, "row 2 of the record");
  refused([](auto& record) { record.displacement_m[1] = SiteVector{{1.0, 2.0}}; }, "number of actuators differs");
}

}  // namespace
}  // namespace hybridtest
