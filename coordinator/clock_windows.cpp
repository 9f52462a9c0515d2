#include "coordinator/clock_windows.hpp"

#include <array>

namespace hybridtest {

void ClockWindows::add(const ForceMeasurement& answer, Instant now) noexcept {
  const Duration there = answer.receive_time - answer.command_send_time;
  const Duration back = now.time_since_epoch() - answer.send_time;
  ClockWindow& window = windows_[answer.substructure];
  ++window.exchanges;
  window.sum_there_s += to_seconds(there);
  window.sum_back_s += to_seconds(back);
  if (there < window.least_there) {
    window.least_there = there;
    window.there_at = answer.command_send_time;
  }
  if (back < window.least_back) {
    window.least_back = back;
    window.back_at = now.time_since_epoch();
  }
  if (window_end_ == kNever) window_end_ = now + kLength;
}

void ClockWindows::record(Instant now, bool at_end, RowSink& rows) noexcept {
  if (now < window_end_ && !at_end) return;
  window_end_ = kNever;
  for (std::size_t i = 0; i < windows_.size(); ++i) {
    ClockWindow& window = windows_[i];
    if (window.exchanges == 0) continue;
    const auto count = static_cast<double>(window.exchanges);
    const std::array<double, 8> row{static_cast<double>(i),        count,
                                    to_seconds(window.there_at),   to_seconds(window.least_there),
                                    window.sum_there_s / count,    to_seconds(window.back_at),
                                    to_seconds(window.least_back), window.sum_back_s / count};
    rows.append(row);
    window = {};
  }
}

TableLayout ClockWindows::layout() {
  return {"clocks",
          {{"substructure", ""},
           {"exchanges", ""},
           {"there_at_s", "s"},
           {"least_there_s", "s"},
           {"mean_there_s", "s"},
           {"back_at_s", "s"},
           {"least_back_s", "s"},
           {"mean_back_s", "s"}}};
}

}  // namespace hybridtest
