#pragma once

#include <atomic>
#include <cstdint>
#include <future>
#include <thread>
#include <vector>

#include "core/duration_histogram.hpp"
#include "core/node.hpp"
#include "core/real_time_thread.hpp"
#include "core/records.hpp"
#include "runtime/executor.hpp"

namespace hybridtest {

/// Timing of a control loop.
struct LoopTiming {
  DurationHistogram start_lateness;  // from the time at which a control period is due to its start
  DurationHistogram busy;            // from its start to its end
  std::int64_t overruns = 0;         // control periods that had already ended when they were started
};

/// The thread of a control loop, with absolute deadlines and, when granted, real-time scheduling. It
/// takes requests in every control period, and every millisecond while there are no control periods.
class LoopThread {
 public:
  /// Starts the thread. The loop and the clock must outlive it.
  LoopThread(Node& loop, const ProcessClock& clock, const RealTimeRequest& request, Duration control_period);
  ~LoopThread();
  LoopThread(const LoopThread&) = delete;
  LoopThread& operator=(const LoopThread&) = delete;

  [[nodiscard]] const RealTimeGrant& grant() const noexcept { return grant_; }
  /// Ends the thread after the present control period.
  void stop();
  /// Valid after stop().
  [[nodiscard]] const LoopTiming& timing() const noexcept { return timing_; }

 private:
  void run(Node& loop, const ProcessClock& clock, Duration control_period) noexcept;

  LoopTiming timing_;
  RealTimeGrant grant_;
  std::atomic<bool> is_stopped_{false};
  std::thread thread_;
};

/// Tables of a site whose loop has a thread: `loop_timing`, one row, and `loop_start_lateness`,
/// one row for each bin of the histogram that is not empty.
[[nodiscard]] std::vector<TableLayout> loop_timing_tables();
void record_loop_timing(const LoopTiming& timing, const RealTimeRequest& request, const RealTimeGrant& grant,
                        RowSink& summary, RowSink& histogram);

}  // namespace hybridtest
