#include "experimental_site/rigs/udp_rig.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "core/config_error.hpp"
#include "core/random.hpp"
#include "tests/support/allocation_count.hpp"
#include "tests/support/echo_port.hpp"
#include "tests/support/kept_rows.hpp"
#include "tests/support/scripted_controller.hpp"
#include "tests/support/scripted_port.hpp"

namespace hybridtest {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double kStiffness_n_per_m = 1.0e6;
constexpr int kWatchdogSamples = 10;

UdpRig::Settings settings() {
  UdpRig::Settings settings;
  settings.name = "rig.example:5000";
  settings.actuators = 2;
  settings.control_period = 1ms;
  settings.watchdog = kWatchdogSamples * 1ms;
  settings.reply_wait = 500us;
  settings.connect_timeout = 100ms;
  return settings;
}

/// A rig with the controller at the other end.
struct Bench {
  explicit Bench(const UdpRig::Settings& chosen = settings()) {
    auto own_port = std::make_unique<ScriptedPort>(controller.peer());
    port = own_port.get();
    rig.emplace(chosen, std::move(own_port));
  }

  void arm() {
    rig->connect();
    rig->arm();
  }
  [[nodiscard]] RigStatus exchange(double first_m, double second_m = 0.0) {
    command.displacement_m = SiteVector{{first_m, second_m}};
    const RigStatus status = rig->exchange(command, feedback);
    ++command.sample;
    command.time_s += 0.001;
    return status;
  }

  ScriptedController controller{kStiffness_n_per_m};
  ScriptedPort* port = nullptr;
  std::optional<UdpRig> rig;
  ActuatorCommand command;
  RigFeedback feedback{SiteVector::Zero(2), SiteVector::Zero(2)};
};

TEST(UdpRig, SendsTheCommandAndReturnsItsMeasurement) {
  Bench bench;
  bench.arm();
  ASSERT_EQ(bench.exchange(0.01, -0.02), RigStatus::healthy);
  EXPECT_EQ(bench.feedback.displacement_m, (SiteVector{{0.01, -0.02}}));
  EXPECT_EQ(bench.feedback.force_n, (SiteVector{{0.01 * kStiffness_n_per_m, -0.02 * kStiffness_n_per_m}}));
  const CommandDatagram& sent = bench.controller.commands.back();
  EXPECT_EQ(sent.request, ControllerRequest::active);
  EXPECT_EQ(sent.loop_count, 1U);
  EXPECT_EQ(sent.control_period_ns, 1'000'000U);
  ASSERT_EQ(bench.exchange(0.03), RigStatus::healthy);
  EXPECT_EQ(bench.controller.commands.back().time_ns, 1'000'000);
  EXPECT_EQ(bench.controller.commands.back().sequence, sent.sequence + 1);
}

TEST(UdpRig, DoesNotWaitAfterItsCommandIsAnswered) {
  Bench bench;
  bench.arm();
  bench.port->waited = {};
  ASSERT_EQ(bench.exchange(0.01), RigStatus::healthy);
  EXPECT_EQ(bench.port->waited, 0ns);
  bench.controller.is_alive = false;
  ASSERT_EQ(bench.exchange(0.02), RigStatus::healthy);
  EXPECT_EQ(bench.port->waited, 500us);
}

TEST(UdpRig, CausesNoMotionBeforeArmingOrAfterStop) {
  Bench bench;
  EXPECT_EQ(bench.exchange(0.01), RigStatus::fault) << "not connected";
  EXPECT_EQ(bench.rig->fault(), RigFault::not_connected);
  bench.rig->connect();
  EXPECT_EQ(bench.exchange(0.01), RigStatus::healthy);
  EXPECT_EQ(bench.controller.commands.back().request, ControllerRequest::inactive);
  EXPECT_EQ(bench.feedback.displacement_m[0], 0.0);
  bench.rig->arm();
  EXPECT_EQ(bench.exchange(0.01), RigStatus::healthy);
  EXPECT_EQ(bench.feedback.displacement_m[0], 0.01);
  bench.rig->stop_motion();
  EXPECT_EQ(bench.exchange(0.05), RigStatus::healthy) << "a rig at rest still measures";
  EXPECT_EQ(bench.controller.commands.back().request, ControllerRequest::stop);
  EXPECT_EQ(bench.feedback.displacement_m[0], 0.01);
  EXPECT_THROW(bench.rig->arm(), std::runtime_error);
  bench.rig->connect();
  bench.rig->arm();
  EXPECT_EQ(bench.exchange(0.05), RigStatus::healthy);
  EXPECT_EQ(bench.feedback.displacement_m[0], 0.05);
}

TEST(UdpRig, SendsStopRepeatedlyInAnyState) {
  Bench bench;
  bench.rig->stop_motion();  // nothing is open yet
  EXPECT_TRUE(bench.controller.commands.empty());
  bench.arm();
  bench.controller.commands.clear();
  bench.rig->stop_motion();
  bench.rig->stop_motion();
  ASSERT_GE(bench.controller.commands.size(), 6U);
  for (const CommandDatagram& command : bench.controller.commands) {
    EXPECT_EQ(command.request, ControllerRequest::stop);
  }
  EXPECT_EQ(bench.controller.state, ControllerState::stopped);
}

TEST(UdpRig, LoopCountAdvancesOnlyWhileLoopRuns) {
  Bench bench;
  bench.arm();
  static_cast<void>(bench.exchange(0.0));
  static_cast<void>(bench.exchange(0.0));
  bench.rig->stop_motion();
  std::vector<std::uint32_t> counts;
  for (const CommandDatagram& command : bench.controller.commands) counts.push_back(command.loop_count);
  EXPECT_TRUE(std::ranges::is_sorted(counts));
  EXPECT_EQ(counts.front(), 0U);
  EXPECT_EQ(counts.back(), 2U);
}

TEST(UdpRig, SilentControllerIsAFaultAfterWatchdogTime) {
  Bench bench;
  bench.arm();
  ASSERT_EQ(bench.exchange(0.01), RigStatus::healthy);
  bench.controller.is_alive = false;
  for (int sample = 1; sample < kWatchdogSamples; ++sample) {
    ASSERT_EQ(bench.exchange(0.02), RigStatus::healthy) << sample;
    EXPECT_EQ(bench.feedback.displacement_m[0], 0.01) << "the newest measurement there is";
  }
  EXPECT_EQ(bench.exchange(0.02), RigStatus::fault);
  EXPECT_EQ(bench.rig->fault(), RigFault::no_answer);
  bench.controller.is_alive = true;
  EXPECT_EQ(bench.exchange(0.02), RigStatus::healthy) << "whether to go on is not the rig's to decide";
}

TEST(UdpRig, ControllerWithoutCommandsCountsAsSilent) {
  Bench bench;
  bench.arm();
  MeasurementDatagram free_running;
  bench.controller.deliver = [&](const auto& answer, auto&) {
    static_cast<void>(decode(answer, free_running));  // the last that it heard
  };
  ASSERT_EQ(bench.exchange(0.01), RigStatus::healthy);
  bench.controller.is_alive = false;
  RigStatus status = RigStatus::healthy;
  int samples = 0;
  for (; status == RigStatus::healthy && samples < 100; ++samples) {
    ++free_running.sequence;
    bench.port->arriving.push_back(ScriptedController::bytes_of(free_running));
    status = bench.exchange(0.02);
  }
  // The first of them brings the answer to the exchange before.
  EXPECT_EQ(samples, kWatchdogSamples + 1);
}

TEST(UdpRig, LeavingActiveStateIsAFault) {
  for (const ControllerState state : {ControllerState::inactive, ControllerState::stopped, ControllerState::fault}) {
    Bench bench;
    bench.arm();
    ASSERT_EQ(bench.exchange(0.01), RigStatus::healthy);
    bench.controller.refuses_to_move = true;
    bench.controller.state = state;
    EXPECT_EQ(bench.exchange(0.02), RigStatus::fault);
    EXPECT_EQ(bench.feedback.displacement_m[0], 0.01);
  }
}

TEST(UdpRig, RejectsInvalidCommand) {
  Bench bench;
  bench.arm();
  const auto sent = bench.controller.commands.size();
  EXPECT_EQ(bench.exchange(std::numeric_limits<double>::quiet_NaN()), RigStatus::fault);
  bench.command.displacement_m = SiteVector{{0.01}};
  EXPECT_EQ(bench.rig->exchange(bench.command, bench.feedback), RigStatus::fault);
  EXPECT_EQ(bench.controller.commands.size(), sent);
}

TEST(UdpRig, PassesNonFiniteValuesToInterlocks) {
  Bench bench;
  bench.arm();
  bench.controller.deliver = [](auto answer, auto& arriving) {
    MeasurementDatagram measurement;
    static_cast<void>(decode(answer, measurement));
    measurement.force_n[1] = std::numeric_limits<double>::quiet_NaN();
    arriving.push_back(ScriptedController::bytes_of(measurement));
  };
  EXPECT_EQ(bench.exchange(0.01), RigStatus::healthy);
  EXPECT_TRUE(std::isnan(bench.feedback.force_n[1]));
}

// Every way to be refused says what to do about it.

TEST(UdpRig, ConnectReportsNoAnswer) {
  Bench bench;
  bench.controller.is_alive = false;
  EXPECT_THAT([&] { bench.rig->connect(); },
              ThrowsMessage<std::runtime_error>(AllOf(HasSubstr("no answer"), HasSubstr("rig.example:5000"))));
  EXPECT_EQ(bench.port->sent, 5) << "20 ms apart, for 100 ms";
  EXPECT_EQ(bench.exchange(0.0), RigStatus::fault);
}

TEST(UdpRig, ConnectReportsUnknownDatagrams) {
  Bench bench;
  bench.controller.deliver = [](auto answer, auto& arriving) {
    answer[4] = std::byte{9};
    arriving.push_back(std::move(answer));
  };
  EXPECT_THAT([&] { bench.rig->connect(); }, ThrowsMessage<std::runtime_error>(HasSubstr("another protocol version")));
}

TEST(UdpRig, ConnectReportsOtherActuatorCount) {
  Bench bench;
  bench.controller.deliver = [](const auto&, auto& arriving) {
    MeasurementDatagram one;
    one.command_sequence = 1;
    one.displacement_m = one.force_n = SiteVector::Zero(1);
    arriving.push_back(ScriptedController::bytes_of(one));
  };
  EXPECT_THAT([&] { bench.rig->connect(); },
              ThrowsMessage<std::runtime_error>(HasSubstr("another number of actuators, expected 2")));
}

TEST(UdpRig, ConnectReportsControllerInFault) {
  Bench bench;
  bench.controller.state = ControllerState::fault;
  bench.controller.status = kEmergencyStopped;
  EXPECT_THAT([&] { bench.rig->connect(); },
              ThrowsMessage<std::runtime_error>(AllOf(HasSubstr("its state is 3"), HasSubstr("status bits 8"))));
}

TEST(UdpRig, ConnectReportsOtherPace) {
  Bench bench;
  bench.controller.status = kFollowsDatagrams;
  EXPECT_THAT(
      [&] { bench.rig->connect(); },
      ThrowsMessage<std::runtime_error>(HasSubstr("follows the datagrams; expected a controller with its own clock")));
  UdpRig::Settings follower = settings();
  follower.follows_datagrams = true;
  Bench other{follower};
  EXPECT_THAT([&] { other.rig->connect(); },
              ThrowsMessage<std::runtime_error>(HasSubstr("has its own clock; expected a controller that follows")));
}

TEST(UdpRig, ArmStopsControllerThatStaysInactive) {
  Bench bench;
  bench.rig->connect();
  bench.controller.refuses_to_move = true;
  EXPECT_THAT([&] { bench.rig->arm(); }, ThrowsMessage<std::runtime_error>(HasSubstr("did not become active")));
  EXPECT_EQ(bench.controller.commands.back().request, ControllerRequest::stop);
}

TEST(UdpRig, ReportsPortThatCannotBeOpened) {
  Bench bench;
  bench.port->on_open = [] { throw std::runtime_error{"udp rig.example:5000: the address cannot be reached"}; };
  EXPECT_THAT([&] { bench.rig->connect(); },
              ThrowsMessage<std::runtime_error>(HasSubstr("the address cannot be reached")));
}

TEST(UdpRig, RejectsInvalidSettings) {
  const auto make = [](auto change) {
    UdpRig::Settings changed = settings();
    change(changed);
    Bench bench{changed};
  };
  EXPECT_NO_THROW(make([](auto&) {}));
  EXPECT_THROW(make([](auto& s) { s.watchdog = 1ms; }), ConfigError);
  EXPECT_THROW(make([](auto& s) { s.reply_wait = 1ms; }), ConfigError);
  EXPECT_NO_THROW(make([](auto& s) { s.reply_wait = 1ms, s.follows_datagrams = true; }));
  EXPECT_THROW(make([](auto& s) { s.control_period = 5s; }), ConfigError);
  EXPECT_THROW(make([](auto& s) { s.connect_timeout = 0s; }), ConfigError);
}

/// What a network does to answers, drawn by a seed: each is lost, doubled, or held back for up to three later ones.
class UnreliableNetwork {
 public:
  explicit UnreliableNetwork(std::uint64_t seed) : random_{seed} {}

  void operator()(const ScriptedPort::Datagram& answer, std::deque<ScriptedPort::Datagram>& arriving) {
    MeasurementDatagram measurement;
    static_cast<void>(decode(answer, measurement));
    if (random_.uniform() < 0.1) {
      ++lost;
    } else {
      const int copies = random_.uniform() < 0.1 ? 2 : 1;
      for (int copy = 0; copy < copies; ++copy) held_.push_back({answer, random_.below(4)});
    }
    for (auto held = held_.begin(); held != held_.end();) {
      if (held->second-- > 0) {
        ++held;
        continue;
      }
      arriving.push_back(held->first);
      ++delivered;
      held = held_.erase(held);
    }
  }

  int lost = 0;
  int delivered = 0;

 private:
  Random random_;
  std::deque<std::pair<ScriptedPort::Datagram, std::uint64_t>> held_;
};

TEST(UdpRig, TimeNeverRunsBackwards) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE(seed);
    Bench bench;
    bench.arm();
    const auto before = bench.rig->counts();
    UnreliableNetwork network{seed};
    bench.controller.deliver = [&](auto answer, auto& arriving) { network(answer, arriving); };
    double newest_m = 0.0;
    constexpr int kSamples = 500;
    for (int sample = 1; sample <= kSamples; ++sample) {
      // Rising, so that an older measurement would be seen as a step back.
      static_cast<void>(bench.exchange(1e-5 * sample));
      ASSERT_GE(bench.feedback.displacement_m[0], newest_m);
      newest_m = bench.feedback.displacement_m[0];
    }
    const auto& counts = bench.rig->counts();
    EXPECT_GT(newest_m, 0.9 * 1e-5 * kSamples);
    EXPECT_GT(counts.stale, 0U);
    EXPECT_EQ(counts.invalid, 0U);
    // Every one that was delivered is one of the two, and those passed over are lost or stale or under way.
    EXPECT_EQ(counts.received - before.received + counts.stale, static_cast<std::uint32_t>(network.delivered));
    EXPECT_GE(counts.skipped + 4U, static_cast<std::uint32_t>(network.lost));
    EXPECT_LE(counts.skipped, static_cast<std::uint32_t>(network.lost) + counts.stale);
  }
}

TEST(UdpRig, CountsAndIgnoresDamagedAndForeignDatagrams) {
  Bench bench;
  bench.arm();
  ASSERT_EQ(bench.exchange(0.01), RigStatus::healthy);
  Random random{7};
  constexpr int kDamaged = 300;
  bench.controller.deliver = [&](auto answer, auto& arriving) {
    const auto place = random.below(answer.size());
    answer[place] ^= static_cast<std::byte>(1U << random.below(8));
    arriving.push_back(std::move(answer));
  };
  for (int i = 0; i < kDamaged; ++i) {
    static_cast<void>(bench.exchange(0.02));
    ASSERT_EQ(bench.feedback.displacement_m[0], 0.01);
  }
  EXPECT_EQ(bench.rig->counts().invalid, static_cast<std::uint32_t>(kDamaged));
}

TEST(UdpRig, RejectsAnswerToCommandNeverSent) {
  Bench bench;
  bench.arm();
  MeasurementDatagram foreign;
  foreign.sequence = 1'000'000;
  foreign.command_sequence = 1'000'000;
  foreign.state = ControllerState::active;
  foreign.displacement_m = foreign.force_n = SiteVector{{0.9, 0.9}};
  bench.port->arriving.push_back(ScriptedController::bytes_of(foreign));
  ASSERT_EQ(bench.exchange(0.01), RigStatus::healthy);
  EXPECT_EQ(bench.feedback.displacement_m[0], 0.01);
  EXPECT_EQ(bench.rig->counts().invalid, 1U);
}

TEST(UdpRig, SkipsBacklogInOneExchange) {
  Bench bench;
  bench.arm();
  MeasurementDatagram old;
  bench.controller.deliver = [&](const auto& answer, auto&) { static_cast<void>(decode(answer, old)); };
  ASSERT_EQ(bench.exchange(0.01), RigStatus::healthy);
  for (int i = 0; i < 250; ++i, ++old.sequence) {
    bench.port->arriving.push_back(ScriptedController::bytes_of(old));
  }
  old.displacement_m[0] = 0.5;
  bench.port->arriving.push_back(ScriptedController::bytes_of(old));
  ASSERT_EQ(bench.exchange(0.02), RigStatus::healthy);
  EXPECT_EQ(bench.feedback.displacement_m[0], 0.5);
}

TEST(UdpRig, RecordsLinkStatistics) {
  Bench bench;
  KeptRows rows{UdpRig::link_layout()};
  bench.rig->record_to([&](std::string_view table) -> RowSink& {
    EXPECT_EQ(table, "rig_link");
    return rows;
  });
  bench.arm();
  ASSERT_EQ(bench.exchange(0.01), RigStatus::healthy);
  bench.controller.is_alive = false;
  ASSERT_EQ(bench.exchange(0.02), RigStatus::healthy);
  const auto value = [&](std::size_t row, std::string_view column) { return rows.at(row, rows.column(column)); };
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(value(0, "answered_sequence"), value(0, "command_sequence"));
  EXPECT_EQ(value(0, "silent_samples"), 0.0);
  EXPECT_EQ(value(1, "answered_sequence"), value(0, "command_sequence"));
  EXPECT_EQ(value(1, "silent_samples"), 1.0);
  EXPECT_EQ(value(1, "controller_state"), 1.0);
}

TEST(UdpRig, DoesNotAllocateWhenArmed) {
  UdpRig rig{settings(), std::make_unique<EchoPort>(kStiffness_n_per_m)};
  rig.connect();
  rig.arm();
  ActuatorCommand command;
  command.displacement_m = SiteVector{{0.01, 0.02}};
  RigFeedback feedback{SiteVector::Zero(2), SiteVector::Zero(2)};
  const std::size_t before = allocation_count();
  for (command.sample = 0; command.sample < 100; ++command.sample) {
    ASSERT_EQ(rig.exchange(command, feedback), RigStatus::healthy);
  }
  rig.stop_motion();
  EXPECT_EQ(allocation_count(), before);
}

}  // namespace
}  // namespace hybridtest
