#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <string>

#include "tests/realtime/forbidden_calls.hpp"
#include "tests/realtime/ring_coupling.hpp"

/// The nodes with deadlines do not allocate, lock, log or read a clock from their first to their last run: joining,
/// arming, stepping, faults and the return to zero included. forbidden_calls_test.cpp holds the controls of the guards.
namespace hybridtest {
namespace {

using std::chrono::microseconds;

constexpr ForbiddenCalls kNone{};

std::string text(const ForbiddenCalls& calls) {
  return std::to_string(calls.allocations) + " allocations, " + std::to_string(calls.locks) + " locks, " +
         std::to_string(calls.writes) + " writes, " + std::to_string(calls.clocks) + " looks at a clock";
}

/// A control loop alone, driven by the test.
class LoopOnRings {
 public:
  LoopOnRings(CouplingMode mode, bool compensates)
      : rig_{noisy_rig(kPeriod)},
        loop_{wide_limits(mode),
              *rig_,
              compensation(compensates, kPeriod),
              EnergyErrorMonitor{SiteMatrix::Constant(1, 1, 4.0e6), 0.01},
              ControlLoopPorts{requests_, reports_},
              record_} {}

  void ask(const LoopRequest& request) noexcept { requests_.send(request); }
  void target(Step step, double displacement_m) noexcept {
    TargetPoint point;
    point.step = step;
    point.model_time_s = RingCoupling::kStep_s * static_cast<double>(step);
    point.displacement_m.setConstant(1, displacement_m);
    point.velocity_m_per_s.setZero(1);
    point.acceleration_m_per_s2.setZero(1);
    requests_.send(loop_request::Target{point});
  }
  void advance() noexcept {
    static_cast<void>(loop_.advance(now_));
    now_ += kPeriod;
  }
  /// Reports that waited. @param fault   set when one of them is a fault.
  int take_reports(bool& fault) noexcept {
    int taken = 0;
    LoopReport report;
    while (reports_.take(report)) {
      fault = fault || std::holds_alternative<loop_report::Fault>(report);
      ++taken;
    }
    return taken;
  }
  [[nodiscard]] std::size_t rows() const noexcept { return record_.size(); }

 private:
  static constexpr Duration kPeriod = microseconds{500};

  RingPort<LoopRequest> requests_{64};
  RingPort<LoopReport> reports_{64};
  RowRing record_{ControlLoop::control_layout(1).columns.size(), 1U << 15U};
  std::unique_ptr<SimulatedRig> rig_;
  ControlLoop loop_;
  Instant now_{};
};

/// Ten thousand control periods with late targets, then an interlock and the return to zero.
struct LoopStory {
  int measured = 0;
  bool has_tripped = false;
};

LoopStory run(LoopOnRings& loop) noexcept {
  LoopStory story;
  loop.ask(loop_request::Arm{});
  loop.ask(loop_request::Start{});
  loop.target(0, 0.0);
  Step step = 0;
  int wait = -1;
  for (int period = 0; period < 10000; ++period) {
    loop.advance();
    if (const int taken = loop.take_reports(story.has_tripped); taken > 0) {
      story.measured += taken;
      step += taken;                                // in real time several may pass meanwhile
      if (wait < 0) wait = step % 50 == 0 ? 5 : 0;  // every fiftieth target is late
    }
    if (wait < 0 || wait-- != 0) continue;
    loop.target(step, 0.03 * (1.0 - std::cos(0.01 * static_cast<double>(step))));
  }
  loop.target(step + 1, 10.0);  // beyond every limit
  loop.target(step + 2, 10.0);  // in real time one of them is not too late
  for (int period = 0; period < 1000; ++period) loop.advance();
  static_cast<void>(loop.take_reports(story.has_tripped));
  loop.ask(loop_request::Stop{});
  loop.advance();
  return story;
}

struct PathCase {
  CouplingMode mode;
  bool compensates;
};

class ControlPath : public testing::TestWithParam<PathCase> {
 protected:
  void SetUp() override {
    if (!can_count_forbidden_calls()) GTEST_SKIP() << "a sanitizer has these functions for itself";
  }
};

TEST_P(ControlPath, ControlLoopMakesNoForbiddenCall) {
  LoopOnRings loop{GetParam().mode, GetParam().compensates};
  LoopStory story;
  ForbiddenCalls calls;
  {
    const ForbiddenCallCount count;
    story = run(loop);
    calls = count.calls();
  }
  EXPECT_EQ(calls, kNone) << text(calls);
  // Control: the loop did its work.
  EXPECT_GE(story.measured, 1000);
  EXPECT_TRUE(story.has_tripped);
  EXPECT_GE(loop.rows(), 5000U);
}

TEST_P(ControlPath, StepsOnQueuesMakeNoForbiddenCall) {
  constexpr Step kLastStep = 2000;
  constexpr Step kQueuesAreWarm = 100;  // each slot of each queue has held a message of this size
  RingCoupling coupling{GetParam().mode, kLastStep, GetParam().compensates};
  while (coupling.report().completed_steps < kQueuesAreWarm && !coupling.is_done()) coupling.advance(microseconds{500});
  // Only real time goes on without what is lost; the other modes would wait for its repetition.
  const bool loses = GetParam().mode == CouplingMode::real_time;
  if (loses) coupling.lose_commands(31);
  ForbiddenCalls calls;
  {
    const ForbiddenCallCount count;
    for (int i = 0; i < 20000 && !coupling.is_done(); ++i) coupling.advance(microseconds{500});
    calls = count.calls();
  }
  EXPECT_EQ(calls, kNone) << text(calls);
  EXPECT_EQ(coupling.report().reason, StopReason::completed);
  EXPECT_EQ(coupling.report().completed_steps, kLastStep + 1);
  EXPECT_GE(coupling.control_rows(), 2U * kLastStep);
  if (loses) {
    EXPECT_GE(coupling.bridged(), 50U);
  } else {
    EXPECT_EQ(coupling.bridged(), 0U);
  }
}

INSTANTIATE_TEST_SUITE_P(Paths, ControlPath,
                         testing::Values(PathCase{CouplingMode::lockstep, false},
                                         PathCase{CouplingMode::lockstep, true}, PathCase{CouplingMode::paced, false},
                                         PathCase{CouplingMode::paced, true}, PathCase{CouplingMode::real_time, true}),
                         [](const auto& path) {
                           return std::string{name(path.param.mode)} + (path.param.compensates ? "_compensated" : "");
                         });

/// Made before the child is: what it runs must find everything in place.
RingCoupling* watched_coupling = nullptr;
LoopOnRings* watched_loop = nullptr;

TEST(SystemCallsOfTheControlPath, AreNone) {
  for (const CouplingMode mode : {CouplingMode::lockstep, CouplingMode::paced, CouplingMode::real_time}) {
    RingCoupling coupling{mode, 500, true};
    LoopOnRings loop{mode, true};
    watched_coupling = &coupling;
    watched_loop = &loop;
    const auto calls = system_calls_of([] {
      static_cast<void>(run(*watched_loop));
      for (int i = 0; i < 20000 && !watched_coupling->is_done(); ++i) watched_coupling->advance(microseconds{500});
      // One system call when the test did not reach its end, so that the parent sees it.
      if (!watched_coupling->is_done()) std::abort();
    });
    if (!calls) GTEST_SKIP() << "this kernel does not let a process turn away its own system calls";
    std::string numbers;
    for (const int call : *calls) numbers += " " + std::to_string(call);
    EXPECT_TRUE(calls->empty()) << "system calls" << numbers;
  }
}

}  // namespace
}  // namespace hybridtest
