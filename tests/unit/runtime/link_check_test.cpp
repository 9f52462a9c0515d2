#include "runtime/link_check.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "transport/simulated/simulated_network.hpp"

/// The check of the links over a network whose delay, losses and clocks are known.
namespace hybridtest {
namespace {

using simulated::NetworkConditions;
using simulated::SimulatedNetwork;
using std::chrono::milliseconds;

NetworkConditions with_latency(Duration latency, Duration jitter = {}) {
  NetworkConditions conditions;
  conditions.latency = latency;
  conditions.jitter = jitter;
  return conditions;
}

NetworkConditions with_loss(double loss) {
  NetworkConditions conditions = with_latency(milliseconds{5});
  conditions.loss = loss;
  return conditions;
}

struct CheckedLink {
  LinkMeasurement measured;
  LinkMeasurement told;  // to the substructure
  bool both_ended = false;
};

CheckedLink check_link(const NetworkConditions& conditions, Duration wall_offset, bool has_substructure = true) {
  SimulatedNetwork network{7, conditions};
  const auto there = network.join("coordinator");
  const auto here = network.join("site");
  LinkCheckSettings settings;
  settings.version = "1.0";
  settings.commands = 400;
  settings.wall_zero = std::chrono::seconds{1'700'000'000};
  settings.identity.id = kCoordinatorId;
  settings.identity.incarnation = 1;
  LinkProbe probe{settings, {{.id = "site", .dofs = 3}}, *there};
  settings.wall_zero += wall_offset;
  settings.identity.id = "site";
  settings.identity.incarnation = 2;
  LinkEcho echo{settings, 0, 3, *here};
  Instant now{};
  Instant probe_next{};
  Instant echo_next{};
  while (!probe.is_done() && now < Instant{std::chrono::minutes{5}}) {
    network.advance_to(now);
    probe_next = probe.advance(now);
    if (has_substructure) echo_next = echo.advance(now);
    const Instant wish = has_substructure ? std::min(probe_next, echo_next) : probe_next;
    now = std::max(now + Duration{1}, std::min(wish, network.next_delivery()));
  }
  CheckedLink result{.measured = probe.measurements().front(), .told = {}, .both_ended = probe.is_done()};
  if (echo.measurement() != nullptr) result.told = *echo.measurement();
  result.both_ended = result.both_ended && (echo.is_done() || !has_substructure);
  return result;
}

TEST(LinkCheck, RoundTripAndClockOffsetAreThoseOfTheNetwork) {
  const CheckedLink link = check_link(with_latency(milliseconds{35}), milliseconds{-3250});
  EXPECT_TRUE(link.both_ended);
  EXPECT_EQ(link.measured.sent, 400);
  EXPECT_EQ(link.measured.answered, 400);
  EXPECT_NEAR(link.measured.round_trip_s_min, 0.070, 1e-6);
  EXPECT_NEAR(link.measured.round_trip_s_p99, 0.070, 1e-6);
  EXPECT_NEAR(link.measured.clock_offset_s, -3.250, 1e-6);
}

TEST(LinkCheck, OffsetIsTrueWithinItsUncertainty) {
  const CheckedLink link = check_link(with_latency(milliseconds{5}, milliseconds{40}), milliseconds{120});
  EXPECT_GE(link.measured.round_trip_s_min, 0.010);
  EXPECT_LE(link.measured.round_trip_s_p99, 0.090);
  EXPECT_GT(link.measured.round_trip_s_p99, link.measured.round_trip_s_median);
  EXPECT_NEAR(link.measured.clock_offset_s, 0.120, link.measured.clock_uncertainty_s);
  // That of one exchange is at best half its round trip (Mills, RFC 5905); that of several is not worse.
  EXPECT_LT(link.measured.clock_uncertainty_s, 0.5 * link.measured.round_trip_s_median);
}

TEST(LinkCheck, LossIsCountedOnTheWayThereAndBack) {
  const CheckedLink link = check_link(with_loss(0.2), {});
  // 0.8^2 of 400 come back; four standard deviations are 0.096.
  EXPECT_NEAR(link.measured.lost_ratio(), 0.36, 0.096);
  EXPECT_EQ(check_link(with_loss(0.0), {}).measured.lost_ratio(), 0.0);
}

TEST(LinkCheck, DuplicatesAreCountedOnce) {
  NetworkConditions conditions = with_latency(milliseconds{5});
  conditions.duplication = 0.5;
  conditions.reordering = 0.3;
  const CheckedLink link = check_link(conditions, {});
  EXPECT_EQ(link.measured.answered, link.measured.sent);
}

TEST(LinkCheck, SubstructureHearsWhatTheCoordinatorMeasured) {
  const CheckedLink link = check_link(with_loss(0.1), milliseconds{800});
  EXPECT_TRUE(link.both_ended);
  EXPECT_EQ(link.told.sent, link.measured.sent);
  EXPECT_EQ(link.told.answered, link.measured.answered);
  EXPECT_EQ(link.told.round_trip_s_median, link.measured.round_trip_s_median);
  EXPECT_EQ(link.told.clock_offset_s, link.measured.clock_offset_s);
  EXPECT_EQ(link.told.clock_uncertainty_s, link.measured.clock_uncertainty_s);
}

TEST(LinkCheck, EndsWithoutTheOther) {
  const CheckedLink link = check_link({}, {}, false);
  EXPECT_TRUE(link.both_ended);
  EXPECT_EQ(link.measured.sent, 0);
}

}  // namespace
}  // namespace hybridtest
