#include "diagnosis/localisation/time_windows.hpp"

#include <algorithm>
#include <cmath>

namespace hybridtest {

std::vector<TimeWindow> gap_over_time(const GapSignals& signals, std::size_t count) {
  const std::size_t size = signals.size();
  const double whole = mean_square(signals.residual) * static_cast<double>(size);
  const double output = mean_square(signals.measured);
  std::vector<TimeWindow> windows;
  for (std::size_t i = 0; i < std::min(count, size); ++i) {
    const std::size_t begin = i * size / std::min(count, size);
    const std::size_t end = (i + 1) * size / std::min(count, size);
    const double here = mean_square(signals.residual.subspan(begin, end - begin));
    TimeWindow window;
    window.begin_s = static_cast<double>(begin) * signals.period_s;
    window.end_s = static_cast<double>(end) * signals.period_s;
    window.share = whole > 0.0 ? here * static_cast<double>(end - begin) / whole : 0.0;
    window.nrmse = output > 0.0 ? std::sqrt(here / output) : 0.0;
    windows.push_back(window);
  }
  return windows;
}

std::vector<TimeWindow> windows_holding(const std::vector<TimeWindow>& windows, double share) {
  std::vector<std::size_t> order(windows.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::stable_sort(order, std::ranges::greater{}, [&](std::size_t i) { return windows[i].share; });
  double held = 0.0;
  std::size_t kept = 0;
  while (kept < order.size() && held < share && windows[order[kept]].share > 0.0) held += windows[order[kept++]].share;
  order.resize(kept);
  std::ranges::sort(order);
  std::vector<TimeWindow> joined;
  for (const std::size_t i : order) {
    const TimeWindow& next = windows[i];
    if (joined.empty() || joined.back().end_s != next.begin_s) {
      joined.push_back(next);
      continue;
    }
    TimeWindow& last = joined.back();
    const double last_s = last.end_s - last.begin_s;
    const double next_s = next.end_s - next.begin_s;
    last.nrmse = std::sqrt((last.nrmse * last.nrmse * last_s + next.nrmse * next.nrmse * next_s) / (last_s + next_s));
    last.end_s = next.end_s;
    last.share += next.share;
  }
  return joined;
}

}  // namespace hybridtest
