#include "runtime/loop_thread.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace hybridtest {
namespace {

double microseconds_of(Duration duration) noexcept { return 1e6 * to_seconds(duration); }

}  // namespace

LoopThread::LoopThread(Node& loop, const ProcessClock& clock, const RealTimeRequest& request, Duration control_period) {
  std::promise<RealTimeGrant> granted;
  std::future<RealTimeGrant> grant = granted.get_future();
  thread_ = std::thread{[this, &loop, &clock, request, control_period, granted = std::move(granted)]() mutable {
    granted.set_value(enter_real_time(request));
    run(loop, clock, control_period);
  }};
  grant_ = grant.get();
}

LoopThread::~LoopThread() { stop(); }

void LoopThread::stop() {
  is_stopped_ = true;
  if (thread_.joinable()) thread_.join();
}

void LoopThread::run(Node& loop, const ProcessClock& clock, Duration control_period) noexcept {
  constexpr Duration kLookForRequests = std::chrono::milliseconds{1};
  Instant due = kNever;
  while (!is_stopped_.load(std::memory_order_relaxed)) {
    const Instant start = clock.now();
    const bool is_period = due != kNever && start >= due;
    if (is_period) {
      timing_.start_lateness.record(start - due);
      timing_.overruns += (start - due) / control_period;
    }
    due = loop.advance(start);
    const Instant end = clock.now();
    if (is_period) timing_.busy.record(end - start);
    if (due > end) rest_until(clock, std::min(due, end + kLookForRequests));
  }
}

std::vector<TableLayout> loop_timing_tables() {
  return {{"loop_timing",
           {{"starts", ""},
            {"start_lateness_p50_us", "us"},
            {"start_lateness_p99_us", "us"},
            {"start_lateness_max_us", "us"},
            {"busy_p50_us", "us"},
            {"busy_p99_us", "us"},
            {"busy_max_us", "us"},
            {"overruns", ""},
            {"memory_locked", ""},
            {"fifo_priority", ""},
            {"cpu", ""}}},
          {"loop_start_lateness", {{"begin_us", "us"}, {"end_us", "us"}, {"count", ""}}}};
}

void record_loop_timing(const LoopTiming& timing, const RealTimeRequest& request, const RealTimeGrant& grant,
                        RowSink& summary, RowSink& histogram) {
  const bool is_pinned = request.cpu && grant.affinity_error == 0;
  const std::array<double, 11> row{static_cast<double>(timing.start_lateness.count()),
                                   microseconds_of(timing.start_lateness.quantile(0.5)),
                                   microseconds_of(timing.start_lateness.quantile(0.99)),
                                   microseconds_of(timing.start_lateness.max()),
                                   microseconds_of(timing.busy.quantile(0.5)),
                                   microseconds_of(timing.busy.quantile(0.99)),
                                   microseconds_of(timing.busy.max()),
                                   static_cast<double>(timing.overruns),
                                   grant.memory_error == 0 ? 1.0 : 0.0,
                                   grant.scheduling_error == 0 ? static_cast<double>(request.priority) : 0.0,
                                   is_pinned ? static_cast<double>(*request.cpu) : -1.0};
  summary.append(row);
  for (int bin = 0; bin < DurationHistogram::kBins; ++bin) {
    if (timing.start_lateness.count_in(bin) == 0) continue;
    const std::array<double, 3> counted{microseconds_of(DurationHistogram::begin_of(bin)),
                                        microseconds_of(DurationHistogram::begin_of(bin + 1)),
                                        static_cast<double>(timing.start_lateness.count_in(bin))};
    histogram.append(counted);
  }
}

}  // namespace hybridtest
