// What the transport does for each step, in the threads of the participants: sending, receiving, decoding.

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <thread>

#include "tests/contract/fast_dds/fast_dds_networks.hpp"
#include "tests/contract/networks.hpp"
#include "tests/contract/sample_messages.hpp"
#include "tests/realtime/forbidden_calls.hpp"

namespace hybridtest {
namespace {

using Clock = std::chrono::steady_clock;

/// Until the pools of Fast DDS have the size that they keep.
constexpr Step kWarmUp = 300;
constexpr Step kCounted = 500;

struct Allocations {
  int coordinator = 0;
  int substructure = 0;
};

/// Answers commands on a thread of its own.
class Answerer {
 public:
  explicit Answerer(std::unique_ptr<Transport> transport)
      : transport_{std::move(transport)},
        commands_{transport_->command_inbox(0)},
        measurements_{transport_->measurement_outbox(0)},
        thread_{[this] { answer(); }} {}
  ~Answerer() {
    ends_ = true;
    transport_->waker().signal();
    thread_.join();
  }
  Answerer(const Answerer&) = delete;
  Answerer& operator=(const Answerer&) = delete;

  [[nodiscard]] int allocations() const { return allocations_; }

 private:
  void answer() {
    DisplacementCommand command = sample_command(0, 0);
    ForceMeasurement measurement = sample_measurement(0, 0);
    std::optional<ForbiddenCallCount> count;
    while (!ends_) {
      static_cast<void>(transport_->waker().wait_until(Clock::time_point::max()));
      while (commands_->take(command)) {
        measurement.step = command.newest().step;
        if (measurement.step == kWarmUp && !count) count.emplace();
        measurements_->send(measurement);
        if (count && measurement.step < kWarmUp + kCounted) allocations_ = count->calls().allocations;
      }
    }
  }

  std::unique_ptr<Transport> transport_;
  std::unique_ptr<Inbox<DisplacementCommand>> commands_;
  std::unique_ptr<Outbox<ForceMeasurement>> measurements_;
  std::atomic<bool> ends_{false};
  std::atomic<int> allocations_{0};
  std::thread thread_;
};

/// Couples a coordinator and a substructure in two threads.
/// @param in_each_step   what the thread of the coordinator does besides.
template <class Network, class Work>
Allocations allocations_of_coupling(const Work& in_each_step) {
  const std::unique_ptr<Transport> transport = Network::join(unique_test_name());
  const auto commands = transport->command_outbox(1);
  const auto measurements = transport->measurement_inbox(1);
  Answerer substructure{Network::join(unique_test_name())};
  EXPECT_TRUE(eventually(*transport, [&] { return transport->reachable(0); }));
  DisplacementCommand command = sample_command(0, 0);
  ForceMeasurement measurement = sample_measurement(0, 0);
  Allocations allocations;
  std::optional<ForbiddenCallCount> count;
  for (Step step = 0; step < kWarmUp + kCounted; ++step) {
    if (step == kWarmUp) count.emplace();
    command.points[0].step = step;
    in_each_step();
    measurement.step = kNoStep;
    while (measurement.step != step) {
      commands->send(command);  // again when it was lost
      const Clock::time_point repeat = Clock::now() + std::chrono::milliseconds{200};
      while (measurement.step != step && transport->waker().wait_until(repeat)) {
        while (measurement.step != step && measurements->take(measurement)) {
        }
      }
    }
  }
  allocations.coordinator = count->calls().allocations;
  count.reset();
  allocations.substructure = substructure.allocations();
  return allocations;
}

class TransportPath : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!can_count_forbidden_calls()) GTEST_SKIP() << "a sanitizer replaces the allocator";
  }
};

TEST_F(TransportPath, BestEffortStepsDoNotAllocate) {
  const Allocations allocations = allocations_of_coupling<FastDdsBestEffortNetwork>([] {});
  EXPECT_EQ(allocations.coordinator, 0);
  EXPECT_EQ(allocations.substructure, 0);
}

TEST_F(TransportPath, CountsWhatAllocates) {
  const Allocations allocations = allocations_of_coupling<FastDdsBestEffortNetwork>([] {
    const std::unique_ptr<int> one = std::make_unique<int>(1);
    EXPECT_EQ(*one, 1);
  });
  EXPECT_EQ(allocations.coordinator, 2 * kCounted) << "taken and given back";
}

// Fast DDS 2.9 allocates ten times in a reliable write(), for functions that it hands around, and gives the memory
// back: 20 calls; a receipt costs 2 more at times. The tests above show that our own work adds nothing.
TEST_F(TransportPath, ReliableWriteAllocatesInFastDds) {
  const Allocations allocations = allocations_of_coupling<FastDdsUdpNetwork>([] {});
  RecordProperty("coordinator_per_step", std::to_string(static_cast<double>(allocations.coordinator) / kCounted));
  RecordProperty("substructure_per_step", std::to_string(static_cast<double>(allocations.substructure) / kCounted));
  EXPECT_LE(allocations.coordinator, 30 * kCounted);
  EXPECT_LE(allocations.substructure, 30 * kCounted);
}

}  // namespace
}  // namespace hybridtest
