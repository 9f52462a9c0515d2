#include "report/live/test_view.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace hybridtest {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr std::uint64_t kFirst = 1000;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

Instant at(double seconds) { return Instant{from_seconds(seconds)}; }

/// What the participants of a test with one site would send.
class TestViewTest : public testing::Test {
 protected:
  void announce(Incarnation coordinator = 1) {
    TestAnnouncement announcement;
    announcement.test_name = "frame";
    announcement.coordinator = coordinator;
    announcement.mode = CouplingMode::paced;
    announcement.step_s = 0.01;
    announcement.duration_s = 10.0;
    announcement.substructures = {{"site", Role::experimental_site, 1}};
    view.learn(announcement);
  }
  void hear(const char* id, LifecycleState state, double now_s, Step step = kNoStep, std::size_t path = 0,
            Incarnation incarnation = 0) {
    ParticipantStatus status;
    status.id = id;
    status.role = status.id == ParticipantId{kCoordinatorId} ? Role::coordinator : Role::experimental_site;
    status.incarnation = incarnation != 0 ? incarnation : status.role == Role::coordinator ? 1 : 2;
    status.state = state;
    status.last_step = step;
    status.clock = from_seconds(now_s);
    status.faults = faults;
    view.learn(status, path, at(now_s));
  }
  void hear(EventCode code, double now_s, const char* source = "coordinator", Severity severity = Severity::information,
            double value = 0.0, const char* subject = "") {
    Event event;
    event.source = source;
    event.incarnation = std::string_view{source} == "coordinator" ? 1 : 2;
    event.code = code;
    event.severity = severity;
    event.subject = subject;
    event.values = {value, 1.0};
    event.clock = from_seconds(now_s);
    view.learn(event, at(now_s), "2026-01-01T00:00:00Z");
  }
  void run(double now_s = 1.0) {
    announce();
    hear("coordinator", LifecycleState::running, now_s, 0);
    hear("site", LifecycleState::running, now_s, 0);
  }
  static SignalBlock block(std::uint64_t sequence, std::vector<double> times_s, double value) {
    const std::vector<double> values(times_s.size(), value);
    SignalBlock block;
    block.participant = "site";
    block.incarnation = 2;
    block.group = "control";
    block.sequence = sequence;
    block.model_time_s = std::move(times_s);
    block.signals.push_back({"force", "dof", "N", kNone, values, values, values});
    return block;
  }
  [[nodiscard]] json head(double now_s, std::uint64_t since = 0) const { return view.news(since, at(now_s)).head; }
  [[nodiscard]] std::string phase(double now_s) const { return head(now_s)["test"]["phase"]; }
  [[nodiscard]] std::string state(const char* id, double now_s) const {
    const json participants = head(now_s)["participants"];
    for (const json& one : participants) {
      if (one["id"] == id) return one["state"];
    }
    return "absent";
  }

  TestView view{"frame", kFirst};
  FaultFlags faults = FaultFlags::none;
};

TEST_F(TestViewTest, PhaseFollowsTheLifeOfATest) {
  EXPECT_EQ(phase(0.0), "waiting");
  hear("coordinator", LifecycleState::joining, 0.1);
  EXPECT_EQ(phase(0.1), "assembling");
  announce();
  EXPECT_THAT(std::string{head(0.1)["test"]["verdict"]}, HasSubstr("waiting for site"));
  EXPECT_EQ(state("site", 0.1), "missing");
  hear("site", LifecycleState::ready, 0.2);
  hear("coordinator", LifecycleState::armed, 0.3);
  EXPECT_EQ(phase(0.3), "armed");
  hear("coordinator", LifecycleState::running, 0.4, 0);
  EXPECT_EQ(phase(0.4), "running");
  hear(EventCode::test_paused, 0.5);
  EXPECT_EQ(phase(0.5), "paused");
  hear(EventCode::test_resumed, 0.6);
  EXPECT_EQ(phase(0.6), "running");
  hear(EventCode::test_stopped, 0.7, "coordinator", Severity::warning, static_cast<double>(StopReason::interlock),
       "site");
  EXPECT_EQ(phase(0.7), "stopping");
  EXPECT_FALSE(view.is_over(at(0.7)));
  hear("coordinator", LifecycleState::finished, 0.8);
  EXPECT_EQ(phase(0.8), "stopped");
  EXPECT_TRUE(view.is_over(at(0.8)));
  EXPECT_EQ(head(0.8)["test"]["stop_reason"], "interlock");
  EXPECT_EQ(head(0.8)["test"]["verdict"], "Ended by an interlock (site).");
  EXPECT_EQ(phase(100.0), "stopped");  // stays readable
}

TEST_F(TestViewTest, SiteThatWaitsForTheCoordinatorIsTold) {
  run(0.0);
  for (int i = 1; i <= 100; ++i) hear("site", LifecycleState::waiting, 0.5 * i, 0);
  EXPECT_EQ(phase(50.0), "lost");
  EXPECT_EQ(state("site", 50.0), "waiting for a resumed coordinator");
  EXPECT_THAT(std::string{head(50.0)["test"]["verdict"]}, HasSubstr("Holding and waiting for it: site."));
  EXPECT_FALSE(view.is_over(at(50.0)));
  EXPECT_THAT(std::string{head(500.0)["test"]["verdict"]}, HasSubstr("Look at its process and its network."));
  EXPECT_TRUE(view.is_over(at(500.0))) << "the site is not heard any more, either";
}

TEST_F(TestViewTest, SiteWhoseLinkIsAwaitedIsTold) {
  run(0.0);
  const auto go_on = [&](double until_s) {
    for (double now_s = 0.5; now_s <= until_s; now_s += 0.5) {
      hear("coordinator", LifecycleState::running, now_s, static_cast<Step>(10.0 * std::min(now_s, 2.0)));
    }
  };
  go_on(4.0);
  EXPECT_EQ(phase(4.0), "running");
  EXPECT_EQ(state("site", 4.0), "lost") << "to this observer; nobody has said that the test waits";
  hear(EventCode::link_silent, 4.0, "coordinator", Severity::warning, 2.0, "site");
  go_on(20.0);
  const json test = head(20.0)["test"];
  EXPECT_EQ(test["phase"], "held");
  EXPECT_EQ(test["verdict"], "Held: nothing from 'site' for 2 s: waiting up to 1 s for its link (timeouts.link_s).");
  EXPECT_EQ(test["steps_per_second"].dump(), "null") << "it stands still";
  EXPECT_EQ(state("site", 20.0), "not heard by the coordinator, which waits for its link");
  EXPECT_FALSE(view.is_over(at(20.0)));

  hear("site", LifecycleState::running, 20.2, 21);
  EXPECT_EQ(phase(20.2), "held") << "this observer hears the site; the coordinator does not";
  hear(EventCode::link_back, 20.3, "coordinator", Severity::information, 18.0, "site");
  EXPECT_EQ(phase(20.3), "running");
  EXPECT_EQ(state("site", 20.3), "running");
}

TEST_F(TestViewTest, LinkThatDoesNotComeBackEndsTheWaiting) {
  run();
  hear(EventCode::link_silent, 1.1, "coordinator", Severity::warning, 1.0, "site");
  EXPECT_EQ(phase(1.1), "held");
  hear(EventCode::participant_lost, 1.2, "coordinator", Severity::fault, 0.0, "site");
  EXPECT_EQ(state("site", 1.2), "running") << "what it last said";
  hear(EventCode::link_silent, 1.3, "coordinator", Severity::warning, 1.0, "site");
  hear(EventCode::test_stopped, 1.4, "coordinator", Severity::warning,
       static_cast<double>(StopReason::participant_lost), "site");
  EXPECT_EQ(phase(1.4), "stopping");
  EXPECT_EQ(state("site", 1.4), "running") << "nobody waits for it any more";
}

TEST_F(TestViewTest, OnlyTheCoordinatorSaysThatALinkIsAwaited) {
  run();
  hear(EventCode::link_silent, 1.1, "site", Severity::warning, 1.0, "site");
  EXPECT_EQ(phase(1.1), "running");
}

/// Seen from the side of the site, when the link to the coordinator is down.
TEST_F(TestViewTest, SiteThatHoldsWithoutTheCoordinatorIsTold) {
  run(0.0);
  hear(EventCode::command_overdue, 0.5, "site", Severity::fault, 0.5, "command_age");
  for (int i = 1; i <= 20; ++i) hear("site", LifecycleState::running, 0.5 * i);
  EXPECT_EQ(phase(10.0), "lost");
  EXPECT_THAT(std::string{head(10.0)["test"]["verdict"]},
              HasSubstr("Holding: site. Look at its process and its network."));
}

TEST_F(TestViewTest, TellsStepRateAndTimeLeft) {
  run(0.0);
  for (int i = 1; i <= 20; ++i) hear("coordinator", LifecycleState::running, 0.1 * i, 10 * i);
  const json test = head(2.0)["test"];
  EXPECT_EQ(test["step"], 200);
  EXPECT_EQ(test["last_step"], 1000.0);
  EXPECT_NEAR(test["model_time_s"], 2.0, 1e-12);
  EXPECT_NEAR(test["steps_per_second"], 100.0, 1e-6);
  EXPECT_NEAR(test["left_s"], 8.0, 1e-6);
  EXPECT_EQ(test["mode"], "paced");
}

TEST_F(TestViewTest, InterlockThatHoldsIsToldUntilItClears) {
  run();
  faults = FaultFlags::command_age | FaultFlags::force_limit;
  hear("site", LifecycleState::running, 1.1);
  hear(EventCode::command_overdue, 1.2, "site", Severity::fault, 0.5, "command_age");
  EXPECT_EQ(phase(1.2), "held");
  EXPECT_THAT(std::string{head(1.2)["test"]["why"]}, HasSubstr("site: no command for 0.5 s"));
  EXPECT_EQ(head(1.2)["participants"][1]["faults"], json({"force limit exceeded", "command age"}));
  hear(EventCode::interlock_cleared, 1.3, "site");
  EXPECT_EQ(phase(1.3), "running");
}

TEST_F(TestViewTest, ParticipantIsLostOnlyWhenNoPathHearsIt) {
  run();
  hear("site", LifecycleState::running, 1.1, 5, 1);
  hear("site", LifecycleState::lost, 1.1, 5, 0);
  EXPECT_EQ(state("site", 1.2), "running");
  hear("site", LifecycleState::lost, 1.1, 5, 1);
  EXPECT_EQ(state("site", 1.2), "lost");
  hear("site", LifecycleState::running, 1.1, 5, 1);  // late: the status from before the loss
  EXPECT_EQ(state("site", 1.2), "lost");
  hear("site", LifecycleState::running, 1.3, 6, 1);  // back
  EXPECT_EQ(state("site", 1.4), "running");
}

TEST_F(TestViewTest, SilentParticipantIsLost) {
  run();
  EXPECT_EQ(state("site", 2.9), "running");
  EXPECT_EQ(state("site", 3.2), "lost");
  EXPECT_EQ(phase(3.2), "lost");
  EXPECT_TRUE(view.is_over(at(3.2)));
}

TEST_F(TestViewTest, SlowStatusesAreNoLoss) {  // of a test with a long lease
  run();
  for (int i = 1; i <= 3; ++i) {
    hear("coordinator", LifecycleState::running, 1.0 + 1.5 * i, i);
  }
  EXPECT_EQ(state("coordinator", 5.5 + 3.0), "running");
  EXPECT_EQ(state("coordinator", 5.5 + 6.1), "lost");
}

TEST_F(TestViewTest, PageGetsOnlyWhatIsNewerThanItsCursor) {
  run();
  hear(EventCode::test_started, 1.0);
  view.learn(block(1, {0.01, 0.02}, 5.0), at(1.0));
  const LiveAnswer first = view.news(0, at(1.0));
  EXPECT_EQ(first.head["reset"], true);
  EXPECT_THAT(first.head["events"], SizeIs(1));
  ASSERT_THAT(first.signals, SizeIs(1));
  EXPECT_THAT(first.signals[0].points, SizeIs(2));
  const std::uint64_t cursor = first.head["cursor"];

  const LiveAnswer nothing = view.news(cursor, at(1.0));
  EXPECT_EQ(nothing.head["reset"], false);
  EXPECT_THAT(nothing.head["events"], IsEmpty());
  EXPECT_THAT(nothing.signals, IsEmpty());

  view.learn(block(2, {0.03}, 6.0), at(1.1));
  const LiveAnswer second = view.news(cursor, at(1.1));
  EXPECT_EQ(second.head["reset"], false);
  ASSERT_THAT(second.signals, SizeIs(1));
  ASSERT_THAT(second.signals[0].points, SizeIs(1));
  EXPECT_EQ(second.signals[0].points[0].last, 6.0);
  EXPECT_THAT(second.head["events"], IsEmpty());
}

TEST_F(TestViewTest, CursorOfAnotherServerStartsAnew) {
  run();
  EXPECT_EQ(head(1.0, 5)["reset"], true);
  EXPECT_EQ(head(1.0, kFirst + 1'000'000)["reset"], true);
}

TEST_F(TestViewTest, PageThatWasAwayForLongStartsAnewWithPeaks) {
  run();
  view.learn(block(1, {0.0}, 0.0), at(1.0));
  const std::uint64_t cursor = head(1.0)["cursor"];
  for (std::uint64_t i = 1; i <= 2000; ++i) {
    view.learn(block(i + 1, {0.01 * static_cast<double>(i)}, i == 1500 ? 9.0 : 1.0), at(1.0));
  }
  const LiveAnswer answer = view.news(cursor, at(1.0));
  EXPECT_EQ(answer.head["reset"], true);
  double most = 0.0;
  for (const LivePoint& point : answer.signals.at(0).points) most = std::max(most, point.most);
  EXPECT_EQ(most, 9.0);
}

TEST_F(TestViewTest, RepeatedAndLateMessagesChangeNothing) {
  run();
  hear(EventCode::test_started, 1.0);
  view.learn(block(2, {0.01, 0.02}, 5.0), at(1.0));
  const std::uint64_t cursor = head(1.0)["cursor"];
  hear(EventCode::test_started, 1.0);  // on the other path
  view.learn(block(2, {0.01, 0.02}, 5.0), at(1.0));
  view.learn(block(1, {0.005}, 4.0), at(1.0));
  hear("coordinator", LifecycleState::armed, 0.5);
  EXPECT_EQ(head(1.0)["cursor"], cursor);
  EXPECT_EQ(phase(1.0), "running");
}

TEST_F(TestViewTest, RaggedBlocksAreLeftOut) {
  run();
  SignalBlock ragged = block(1, {0.01, 0.02}, 5.0);
  ragged.signals[0].least.pop_back();
  view.learn(ragged, at(1.0));
  view.learn(block(2, {0.02, 0.01}, 5.0), at(1.0));
  EXPECT_THAT(view.news(0, at(1.0)).signals, IsEmpty());
}

TEST_F(TestViewTest, TestThatBeginsAnewReplacesTheOneBefore) {
  run();
  hear(EventCode::test_started, 1.0);
  view.learn(block(1, {0.01}, 5.0), at(1.0));
  hear("coordinator", LifecycleState::finished, 1.1);
  const std::uint64_t cursor = head(1.1)["cursor"];
  hear("coordinator", LifecycleState::joining, 2.0, kNoStep, 0, 11);
  announce(11);
  EXPECT_EQ(head(2.0, cursor)["reset"], true);
  EXPECT_THAT(head(2.0)["events"], IsEmpty());
  EXPECT_THAT(view.news(0, at(2.0)).signals, IsEmpty());
  EXPECT_EQ(phase(2.0), "assembling");
  // What the first coordinator sent comes late.
  announce(1);
  hear("coordinator", LifecycleState::running, 3.0, 77);
  hear(EventCode::test_completed, 3.0);
  EXPECT_EQ(phase(2.0), "assembling");
  EXPECT_THAT(head(2.0)["events"], IsEmpty());
}

TEST_F(TestViewTest, SecondProcessWithOneIdChangesNothing) {
  run();
  hear("coordinator", LifecycleState::refused, 1.2, kNoStep, 0, 99);
  EXPECT_EQ(phase(1.2), "running");
}

TEST_F(TestViewTest, InterlockTellsItsShareAndItsPeak) {
  run();
  for (std::uint64_t i = 1; i <= 3; ++i) {
    SignalBlock interlocks = block(i, {0.01 * static_cast<double>(i)}, i == 2 ? -8.0 : 5.0);
    interlocks.group = "interlocks";
    interlocks.signals[0].limit = 10.0;
    view.learn(interlocks, at(1.0));
  }
  const json interlock = head(1.0)["interlocks"].at(0);
  EXPECT_EQ(interlock["observed"], 5.0);
  EXPECT_EQ(interlock["limit"], 10.0);
  EXPECT_EQ(interlock["share"], 0.5);
  EXPECT_EQ(interlock["peak_share"], 0.8);
}

TEST_F(TestViewTest, InterlockIsWatchedWhileModelTimeStandsStill) {
  run();
  for (std::uint64_t i = 1; i <= 1000; ++i) {  // a paused test whose specimen creeps
    SignalBlock interlocks = block(i, {0.5}, 0.009 * static_cast<double>(i));
    interlocks.group = "interlocks";
    interlocks.signals[0].limit = 10.0;
    view.learn(interlocks, at(1.0));
  }
  const LiveAnswer answer = view.news(0, at(1.0));
  EXPECT_NEAR(answer.head["interlocks"].at(0)["share"], 0.9, 1e-12);
  EXPECT_NEAR(answer.head["interlocks"].at(0)["peak_share"], 0.9, 1e-12);
  ASSERT_THAT(answer.signals.at(0).points, SizeIs(1));
  EXPECT_NEAR(answer.signals[0].points[0].least, 0.009, 1e-12);
  EXPECT_NEAR(answer.signals[0].points[0].most, 9.0, 1e-12);
}

TEST_F(TestViewTest, ExchangeStandsWithItsSubstructure) {
  run();
  SignalBlock exchange = block(1, {1.0}, 0.0);
  exchange.participant = "coordinator";
  exchange.incarnation = 1;
  exchange.group = "exchange";
  exchange.signals = {{"round_trip_p50", "site", "us", kNone, {700.0}, {700.0}, {700.0}},
                      {"resent", "site", "", kNone, {3.0}, {3.0}, {3.0}}};
  view.learn(exchange, at(1.0));
  const json participants = head(1.0)["participants"];
  EXPECT_EQ(participants[1]["exchange"], json({{"round_trip_p50_us", 700.0}, {"resent", 3.0}}));
  EXPECT_TRUE(participants[0]["exchange"].is_null());
}

TEST_F(TestViewTest, MemoryIsBoundedWhateverArrives) {
  run();
  for (int i = 0; i < 2000; ++i) hear(EventCode::command_repeated, 1.0 + i);
  for (int group = 0; group < 400; ++group) {
    SignalBlock one = block(1, {0.01}, 1.0);
    one.group = "group " + std::to_string(group);
    view.learn(one, at(1.0));
  }
  for (int i = 0; i < 200; ++i) hear(("site " + std::to_string(i)).c_str(), LifecycleState::running, 1.0);
  const LiveAnswer answer = view.news(0, at(1.0));
  EXPECT_LE(answer.head["events"].size(), 500U);
  EXPECT_LE(answer.signals.size(), 256U);
  EXPECT_LE(answer.head["participants"].size(), 64U);
}

TEST_F(TestViewTest, AnswerIsJsonAlsoWithWhatIsNotFiniteOrNotText) {
  run();
  SignalBlock odd = block(1, {0.01}, kNone);
  odd.signals[0].subject = "\xff\"";
  view.learn(odd, at(1.0));
  const json answer = json::parse(to_text(view.news(0, at(1.0))));
  EXPECT_TRUE(answer["signals"][0]["last"][0].is_null());
  EXPECT_TRUE(answer["signals"][0]["limit"].is_null());
  EXPECT_EQ(answer["signals"][0]["t"][0], 0.01);
  const json whole = json::parse(to_text(view.whole()));
  EXPECT_THAT(whole["signals"][0]["t"], SizeIs(1));
}

}  // namespace
}  // namespace hybridtest
