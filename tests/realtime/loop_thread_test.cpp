#include "runtime/loop_thread.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cmath>
#include <new>
#include <optional>
#include <thread>
#include <vector>

#include "tests/realtime/forbidden_calls.hpp"
#include "tests/realtime/ring_coupling.hpp"

/// The thread of a control loop beside the rest of a test, measured with the clock of the machine.
namespace hybridtest {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr double kCommandAge_s = 1.0;  // longer than a shared machine pauses
constexpr Step kEndless = 20000;

/// What the control loop recorded of one period.
struct Row {
  double sample = 0.0;
  double time_s = 0.0;
  double command_m = 0.0;
  FaultFlags faults = FaultFlags::none;
};

class LoopThreadTest : public testing::Test {
 protected:
  /// Everyone but the loop, until the loop has recorded so many periods more.
  void run_periods(std::size_t periods) {
    const std::size_t wanted = rows_.size() + periods;
    while (rows_.size() < wanted) {
      coupling_.advance_all_but_loop(clock_.now());
      take_rows();
      std::this_thread::sleep_for(microseconds{200});
    }
  }
  void take_rows() {
    for (std::vector<double> row = coupling_.take_control_row(); !row.empty(); row = coupling_.take_control_row()) {
      rows_.push_back({row[0], row[1], row[4], static_cast<FaultFlags>(static_cast<std::uint32_t>(row[10]))});
    }
  }
  [[nodiscard]] std::size_t first_row_with(FaultFlags fault) const {
    return static_cast<std::size_t>(
        std::ranges::find_if(rows_, [&](const Row& row) { return any(row.faults & fault); }) - rows_.begin());
  }

  /// All participants except the loop pause, or only the link: the loop still records twice as many periods as a
  /// command may be old, and its interlock holds.
  template <class Meanwhile>
  void expect_runs_on_and_holds(Meanwhile meanwhile) {
    run_periods(1000);
    const std::size_t before = rows_.size();
    ASSERT_FALSE(any(rows_.back().faults));
    LoopThread& loop = *thread_;
    const Instant stalled = clock_.now();
    while (rows_.size() < before + static_cast<std::size_t>(2.0 * kCommandAge_s / to_seconds(kControlPeriod))) {
      meanwhile();
      take_rows();
      ASSERT_LT(clock_.now() - stalled, std::chrono::seconds{60}) << "the loop stands still with the rest";
      std::this_thread::sleep_for(microseconds{200});
    }
    loop.stop();
    take_rows();
    for (std::size_t i = 0; i < rows_.size(); ++i) ASSERT_EQ(rows_[i].sample, static_cast<double>(i));
    // Had it waited for the stall to end, half of its starts would be that late.
    EXPECT_LE(loop.timing().start_lateness.quantile(0.5), from_seconds(0.1 * kCommandAge_s));
    const std::size_t tripped = first_row_with(FaultFlags::command_age);
    ASSERT_LT(tripped, rows_.size()) << "the interlock did not act";
    EXPECT_GT(tripped, before);
    for (std::size_t i = tripped; i < rows_.size(); ++i) ASSERT_EQ(rows_[i].command_m, rows_[tripped].command_m);
  }

  ProcessClock clock_;
  RingCoupling coupling_{CouplingMode::paced, kEndless, true, kCommandAge_s};
  std::optional<LoopThread> thread_;
  std::vector<Row> rows_;
};

TEST_F(LoopThreadTest, PausedLinkStopsNeitherLoopNorInterlock) {
  thread_.emplace(coupling_.control_loop(), clock_, RealTimeRequest{}, kControlPeriod);
  expect_runs_on_and_holds([] {});
  coupling_.advance_link(clock_.now());
  EXPECT_TRUE(any(coupling_.site_faults() & FaultFlags::command_age)) << "the link hears of it when it is back";
}

TEST_F(LoopThreadTest, HangingNetworkStopsNeitherLoopNorInterlock) {
  thread_.emplace(coupling_.control_loop(), clock_, RealTimeRequest{}, kControlPeriod);
  expect_runs_on_and_holds([this] { coupling_.advance_link(clock_.now()); });
  EXPECT_TRUE(any(coupling_.site_faults() & FaultFlags::command_age));
}

/// Delays its own thread once.
class HeldUp final : public Node {
 public:
  explicit HeldUp(Node& node) : node_{node} {}
  [[nodiscard]] Instant advance(Instant now) noexcept override {
    if (++runs_ == kHeldUp) std::this_thread::sleep_for(milliseconds{300});
    return node_.advance(now);
  }
  [[nodiscard]] bool was_held_up() const noexcept { return runs_ > kHeldUp + 100; }

 private:
  static constexpr int kHeldUp = 1000;
  Node& node_;
  std::atomic<int> runs_{0};
};

TEST_F(LoopThreadTest, DelayedLoopShowsInItsTiming) {
  HeldUp held_up{coupling_.control_loop()};
  LoopThread thread{held_up, clock_, RealTimeRequest{}, kControlPeriod};
  while (!held_up.was_held_up()) {
    coupling_.advance_all_but_loop(clock_.now());
    std::this_thread::sleep_for(microseconds{200});
  }
  thread.stop();
  EXPECT_GE(thread.timing().busy.max(), Duration{milliseconds{300}});
  // Busy for that long, the period after it was over 598 times by then.
  EXPECT_GE(thread.timing().start_lateness.max(), Duration{milliseconds{299}});
  EXPECT_GE(thread.timing().overruns, 598);
}

/// Counts the calls of its thread from the second run to the last.
class Watched final : public Node {
 public:
  explicit Watched(Node& node, bool allocates) : node_{node}, allocates_{allocates} {}
  [[nodiscard]] Instant advance(Instant now) noexcept override {
    if (++runs_ == 2) count_.emplace();
    if (runs_ == kWatched) {
      calls_ = count_->calls();
      count_.reset();
    }
    if (allocates_) delete new (std::nothrow) int{runs_};
    const Instant wake = node_.advance(now);
    return wake;
  }
  [[nodiscard]] bool is_watched() const noexcept { return runs_ > kWatched; }
  [[nodiscard]] ForbiddenCalls calls() const noexcept { return calls_; }

 private:
  static constexpr int kWatched = 2000;
  Node& node_;
  bool allocates_;
  std::atomic<int> runs_{0};
  std::optional<ForbiddenCallCount> count_;
  ForbiddenCalls calls_;
};

TEST_F(LoopThreadTest, PeriodMakesNoAllocationLockOrWrite) {
  if (!can_count_forbidden_calls()) GTEST_SKIP() << "a sanitizer has these functions for itself";
  for (const bool allocates : {false, true}) {
    RingCoupling coupling{CouplingMode::paced, kEndless, true, 10.0};
    Watched watched{coupling.control_loop(), allocates};
    LoopThread thread{watched, clock_, RealTimeRequest{}, kControlPeriod};
    while (!watched.is_watched()) {
      coupling.advance_all_but_loop(clock_.now());
      std::this_thread::sleep_for(microseconds{200});
    }
    thread.stop();
    EXPECT_EQ(watched.calls().locks, 0);
    EXPECT_EQ(watched.calls().writes, 0);
    EXPECT_GT(watched.calls().clocks, 1000) << "it does look at the clock, and sleep";
    if (allocates) {
      EXPECT_GE(watched.calls().allocations, 1000) << "the guard would see it";
    } else {
      EXPECT_EQ(watched.calls().allocations, 0);
    }
  }
}

TEST(RealTimeGrantTest, ReportsWhatWasRefusedAndWhy) {
  RealTimeGrant impossible;
  std::thread{[&] { impossible = enter_real_time({.priority = 100, .cpu = 1023, .allow_degraded = true}); }}.join();
  EXPECT_EQ(impossible.scheduling_error, EINVAL) << "99 is the highest there is";
  EXPECT_EQ(impossible.affinity_error, EINVAL) << "no machine of ours has so many";
  EXPECT_FALSE(impossible.is_complete());
  RealTimeGrant plain;
  std::thread{[&] { plain = enter_real_time({.priority = 1, .cpu = std::nullopt, .allow_degraded = true}); }}.join();
  EXPECT_FALSE(plain.affinity_error.has_value());
  EXPECT_EQ(plain.is_complete(), plain.scheduling_error == 0 && plain.memory_error == 0);
}

}  // namespace
}  // namespace hybridtest
