// Every queue between two threads, used by two threads: order and completeness here, and the thread sanitizer looks at
// the memory orders. tests/sanitizers shows that it reports a ring whose orders are too weak.

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "core/ring_port.hpp"
#include "core/spsc_ring.hpp"
#include "recording/event_ring.hpp"
#include "recording/recorder_thread.hpp"
#include "recording/row_ring.hpp"
#include "recording/run_file_reader.hpp"
#include "tests/unit/recording/run_file_fixture.hpp"
#include "tests/unit/recording/temporary_directory.hpp"
#include "transport/bounded_queue.hpp"

namespace hybridtest {
namespace {

/// How many a producer sends: 50 000, or what it gets through in a second. On a busy machine each of the two threads
/// may have to wait for a processor whenever the other has filled or emptied a small ring.
class Supply {
 public:
  /// @return whether there is a next number; `number` is then that.
  [[nodiscard]] bool next(std::int64_t& number) {
    if (sent_ == kSentMax || (sent_ > 0 && Clock::now() > end_)) return false;
    number = sent_++;
    return true;
  }
  [[nodiscard]] std::int64_t sent() const { return sent_; }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::int64_t kSentMax = 50'000;

  Clock::time_point end_ = Clock::now() + std::chrono::seconds{1};
  std::int64_t sent_ = 0;
};

/// Wider than what a processor writes at once: a value that is read while it is written shows.
struct Wide {
  std::array<std::int64_t, 16> copies{};

  static Wide of(std::int64_t number) {
    Wide wide;
    wide.copies.fill(number);
    return wide;
  }
  [[nodiscard]] bool is_torn() const {
    for (const std::int64_t copy : copies) {
      if (copy != copies.front()) return true;
    }
    return false;
  }
};

/// `produce` on a thread of its own. Meanwhile, and once more when it has ended, `consume` takes what there is.
template <class Produce, class Consume>
void run_both(Produce produce, Consume consume) {
  std::atomic<bool> has_ended{false};
  std::thread producer{[&] {
    produce();
    has_ended.store(true);
  }};
  while (!has_ended.load()) {
    consume();
    std::this_thread::yield();
  }
  producer.join();
  consume();
}

/// Numbers that must come one after another.
struct Sequence {
  std::int64_t next = 0;
  std::int64_t misplaced = 0;
  void take(std::int64_t number) {
    if (number != next) ++misplaced;
    next = number + 1;
  }
};

/// Numbers that must rise; some may be missing.
struct Rising {
  std::int64_t last = -1;
  std::int64_t count = 0;
  std::int64_t misplaced = 0;
  void take(std::int64_t number) {
    if (number <= last) ++misplaced;
    last = number;
    ++count;
  }
};

class RingCapacity : public testing::TestWithParam<std::size_t> {};

TEST_P(RingCapacity, SpscRingKeepsOrderBetweenTwoThreads) {
  SpscRing<Wide> ring{GetParam()};
  Supply supply;
  Sequence taken;
  std::int64_t torn = 0;
  run_both(
      [&] {
        for (std::int64_t number = 0; supply.next(number);) {
          while (!ring.push(Wide::of(number))) std::this_thread::yield();
        }
      },
      [&] {
        Wide value;
        while (ring.pop(value)) {
          torn += value.is_torn() ? 1 : 0;
          taken.take(value.copies.front());
        }
      });
  EXPECT_EQ(taken.next, supply.sent());
  EXPECT_EQ(taken.misplaced, 0);
  EXPECT_EQ(torn, 0);
}

TEST_P(RingCapacity, RingPortKeepsOrderBetweenTwoThreads) {
  RingPort<DisplacementCommand> port{GetParam()};
  Outbox<DisplacementCommand>& outbox = port;
  Inbox<DisplacementCommand>& inbox = port;
  Supply supply;
  Sequence taken;
  run_both(
      [&] {
        DisplacementCommand command;
        for (Step step = 0; supply.next(step);) {
          command.points[0].step = step;
          command.send_time = Duration{step};
          while (!outbox.send(command)) std::this_thread::yield();
        }
      },
      [&] {
        DisplacementCommand command;
        while (inbox.take(command)) {
          taken.take(command.send_time == Duration{command.points[0].step} ? command.points[0].step : -1);
        }
      });
  EXPECT_EQ(taken.next, supply.sent());
  EXPECT_EQ(taken.misplaced, 0);
}

TEST_P(RingCapacity, RowRingDropsWholeRowsAndCountsThem) {
  constexpr std::size_t kWidth = 12;
  RowRing ring{kWidth, GetParam()};
  Supply supply;
  Rising taken;
  std::int64_t torn = 0;
  std::vector<double> rows(kWidth * 5);
  run_both(
      [&] {
        std::array<double, kWidth> row{};
        for (std::int64_t number = 0; supply.next(number);) {
          row.fill(static_cast<double>(number));
          ring.append(row);
          if (number % 7 == 0) std::this_thread::yield();
        }
      },
      [&] {
        EXPECT_LE(ring.size(), ring.capacity());
        for (std::size_t count = ring.take(rows); count > 0; count = ring.take(rows)) {
          for (std::size_t i = 0; i < count; ++i) {
            const auto row = std::span{rows}.subspan(i * kWidth, kWidth);
            for (const double value : row) torn += value != row.front() ? 1 : 0;
            taken.take(static_cast<std::int64_t>(row.front()));
          }
        }
      });
  EXPECT_EQ(static_cast<std::uint64_t>(taken.count) + ring.dropped(), static_cast<std::uint64_t>(supply.sent()));
  EXPECT_GT(taken.count, 0);
  EXPECT_EQ(taken.misplaced, 0);
  EXPECT_EQ(torn, 0);
}

TEST_P(RingCapacity, EventRingDropsWholeEventsAndCountsThem) {
  EventRing ring{GetParam()};
  Supply supply;
  Rising taken;
  std::int64_t torn = 0;
  std::uint64_t refused = 0;
  run_both(
      [&] {
        Event event;
        for (Step step = 0; supply.next(step);) {
          event.step = step;
          event.clock = Duration{step};
          if (!ring.send(event)) ++refused;
          if (step % 7 == 0) std::this_thread::yield();
        }
      },
      [&] {
        Event event;
        while (ring.take(event)) {
          torn += event.clock != Duration{event.step} ? 1 : 0;
          taken.take(event.step);
        }
      });
  EXPECT_EQ(ring.dropped(), refused);
  EXPECT_EQ(static_cast<std::uint64_t>(taken.count) + refused, static_cast<std::uint64_t>(supply.sent()));
  EXPECT_GT(taken.count, 0);
  EXPECT_EQ(taken.misplaced, 0);
  EXPECT_EQ(torn, 0);
}

TEST_P(RingCapacity, BoundedQueueKeepsTheOrderOfEachOfTwoSenders) {
  BoundedQueue<Wide> queue{GetParam()};
  std::array<Supply, 2> supplies;
  std::array<Sequence, 2> taken;
  std::int64_t torn = 0;
  std::array<std::uint64_t, 2> refused{};
  const auto send_all = [&](std::int64_t sender) {
    for (std::int64_t number = 0; supplies[static_cast<std::size_t>(sender)].next(number);) {
      while (!queue.push(Wide::of(2 * number + sender))) {
        ++refused[static_cast<std::size_t>(sender)];
        std::this_thread::yield();
      }
    }
  };
  run_both(
      [&] {
        std::thread other{[&] { send_all(1); }};
        send_all(0);
        other.join();
      },
      [&] {
        Wide value;
        while (queue.pop(value)) {
          torn += value.is_torn() ? 1 : 0;
          taken[static_cast<std::size_t>(value.copies.front() % 2)].take(value.copies.front() / 2);
        }
      });
  for (std::size_t sender = 0; sender < taken.size(); ++sender) {
    EXPECT_EQ(taken[sender].next, supplies[sender].sent());
    EXPECT_EQ(taken[sender].misplaced, 0);
  }
  EXPECT_EQ(queue.turned_away(), refused[0] + refused[1]);
  EXPECT_EQ(torn, 0);
}

// One slot: full after every push. Three: wraps at every alignment. Many: the two threads rarely meet.
INSTANTIATE_TEST_SUITE_P(Rings, RingCapacity, testing::Values(1, 3, 1000),
                         [](const auto& capacity) { return "holds_" + std::to_string(capacity.param); });

TEST(RecorderThread, WritesAllRowsOfTwoProducersInOrder) {
  constexpr std::size_t kRows = 20'000;
  const TemporaryDirectory directory;
  const auto path = directory / "a.h5";
  const TableLayout layout{"first", {{"number", "-"}, {"again", "-"}}};
  Recorder recorder{path, example_header(), {{layout, kRows}, {{"second", layout.columns}, kRows}}, 2, 1000};
  {
    RecorderThread thread{recorder, Duration{1'000'000}};
    const auto produce = [&recorder](const char* table, std::size_t source) {
      RowSink& sink = recorder.sink(table);
      Outbox<Event>& events = recorder.events(source);
      Event event;
      for (std::size_t i = 0; i < kRows; ++i) {
        sink.append(std::array{static_cast<double>(i), static_cast<double>(i)});
        event.step = static_cast<Step>(i);
        if (i % 100 == 0) events.send(event);
        if (i % 1000 == 0) std::this_thread::yield();
      }
    };
    std::thread first{[&] { produce("first", 0); }};
    std::thread second{[&] { produce("second", 1); }};
    first.join();
    second.join();
    thread.stop();
  }
  EXPECT_EQ(recorder.error_text(), "");
  EXPECT_EQ(recorder.dropped(), 0U);
  const RunFileReader reader{path};
  for (const char* table : {"first", "second"}) {
    const std::vector<double> number = reader.column(table, "number");
    ASSERT_EQ(number.size(), kRows);
    for (std::size_t i = 0; i < kRows; ++i) ASSERT_EQ(number[i], static_cast<double>(i));
    EXPECT_EQ(reader.column(table, "again"), number);
  }
  EXPECT_EQ(reader.events().size(), 2 * kRows / 100);
}

}  // namespace
}  // namespace hybridtest
