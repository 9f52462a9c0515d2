#include "recording/summary/clock_relation.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "recording/read_rows.hpp"
#include "recording/summary/columns.hpp"

namespace hybridtest {
namespace {

constexpr std::string_view kTable = "clocks";
/// No quartz is worse.
constexpr double kDriftMax = 1e-3;
/// A node reads its clock when its turn begins; what it takes and sends in that turn may be so much later.
constexpr double kReadingError_s = 20e-6;
constexpr double kPart_s = 120.0;
/// Halvings and thirds of a range of drifts: to the last digit.
constexpr int kRounds = 80;

/// What the bounds leave for the offset at a time, if the drift is known.
class OffsetRange {
 public:
  OffsetRange(std::span<const ClockBounds> bounds, double at_s) : bounds_{bounds}, at_s_{at_s} {}

  [[nodiscard]] double high(double drift) const {
    double high = std::numeric_limits<double>::infinity();
    for (const ClockBounds& one : bounds_) high = std::min(high, high_of(one, drift));
    return high;
  }
  [[nodiscard]] double low(double drift) const {
    double low = -std::numeric_limits<double>::infinity();
    for (const ClockBounds& one : bounds_) low = std::max(low, low_of(one, drift));
    return low;
  }
  [[nodiscard]] double high_of(const ClockBounds& one, double drift) const noexcept {
    return one.there_s - drift * (one.there_at_s - at_s_);
  }
  [[nodiscard]] double low_of(const ClockBounds& one, double drift) const noexcept {
    return -one.back_s - drift * (one.back_at_s - at_s_);
  }
  [[nodiscard]] double width(double drift) const { return high(drift) - low(drift); }

 private:
  std::span<const ClockBounds> bounds_;
  double at_s_;
};

/// Where a concave function is largest in [low, high].
double argmax(const std::function<double(double)>& function, double low, double high) {
  for (int i = 0; i < kRounds; ++i) {
    const double third = (high - low) / 3.0;
    if (function(low + third) < function(high - third)) {
      low += third;
    } else {
      high -= third;
    }
  }
  return 0.5 * (low + high);
}

/// Where a function that is positive at `inside` changes its sign towards `outside`; `outside` when it does not.
double edge(const std::function<double(double)>& function, double inside, double outside) {
  if (function(outside) >= 0.0) return outside;
  for (int i = 0; i < kRounds; ++i) {
    const double middle = 0.5 * (inside + outside);
    (function(middle) >= 0.0 ? inside : outside) = middle;
  }
  return inside;
}

double widest_drift(const OffsetRange& range) {
  return argmax([&](double drift) { return range.width(drift); }, -kDriftMax, kDriftMax);
}

/// Without those that contradict each other. Of two, one is false and nobody knows which: both go, and what is left
/// holds the truth as long as no more are false than are true.
std::vector<ClockBounds> without_contradictions(std::span<const ClockBounds> bounds, double at_s) {
  std::vector<ClockBounds> left{bounds.begin(), bounds.end()};
  while (!left.empty()) {
    const OffsetRange range{left, at_s};
    const double drift = widest_drift(range);
    const double high = range.high(drift);
    const double low = range.low(drift);
    if (high - low + 2.0 * kReadingError_s >= 0.0) break;
    std::erase_if(left, [&](const ClockBounds& one) {
      return range.high_of(one, drift) <= high || range.low_of(one, drift) >= low;
    });
  }
  return left;
}

/// Weighted by the exchanges, over the bounds.
double mean(std::span<const ClockBounds> bounds, const std::function<double(const ClockBounds&)>& value) {
  double sum = 0.0;
  double count = 0.0;
  for (const ClockBounds& one : bounds) {
    sum += one.exchanges * value(one);
    count += one.exchanges;
  }
  return count > 0.0 ? sum / count : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

double ClockRelation::to_coordinator_s(double clock_s) const noexcept {
  return (clock_s - offset_s + drift * at_s) / (1.0 + drift);
}

double ClockRelation::uncertainty_s(double coordinator_s) const noexcept {
  return offset_uncertainty_s + drift_uncertainty * std::abs(coordinator_s - at_s);
}

std::optional<ClockRelation> relate_clocks(std::span<const ClockBounds> bounds) {
  ClockRelation relation;
  relation.begin_s = std::numeric_limits<double>::infinity();
  relation.end_s = -relation.begin_s;
  for (const ClockBounds& one : bounds) {
    relation.begin_s = std::min({relation.begin_s, one.there_at_s, one.back_at_s});
    relation.end_s = std::max({relation.end_s, one.there_at_s, one.back_at_s});
  }
  relation.at_s = 0.5 * (relation.begin_s + relation.end_s);
  const std::vector<ClockBounds> consistent = without_contradictions(bounds, relation.at_s);
  if (consistent.empty()) return std::nullopt;
  const OffsetRange range{consistent, relation.at_s};
  const double widest = widest_drift(range);
  const auto is_possible = [&](double drift) { return range.width(drift) + 2.0 * kReadingError_s; };
  const double least = edge(is_possible, widest, -kDriftMax);
  const double most = edge(is_possible, widest, kDriftMax);
  const double high =
      range.high(argmax([&](double drift) { return range.high(drift); }, least, most)) + kReadingError_s;
  const double low = range.low(argmax([&](double drift) { return -range.low(drift); }, least, most)) - kReadingError_s;
  relation.drift = 0.5 * (least + most);
  relation.drift_uncertainty = 0.5 * (most - least);
  relation.offset_s = 0.5 * (high + low);
  relation.offset_uncertainty_s = 0.5 * (high - low);
  const auto offset_at = [&](double time_s) { return relation.offset_s + relation.drift * (time_s - relation.at_s); };
  relation.latency_there_s =
      mean(bounds, [&](const ClockBounds& one) { return one.mean_there_s - offset_at(one.there_at_s); });
  relation.latency_back_s =
      mean(bounds, [&](const ClockBounds& one) { return one.mean_back_s + offset_at(one.back_at_s); });
  return relation;
}

const ClockRelation& ParticipantClock::at(double clock_s) const noexcept {
  const auto later = std::ranges::find_if(
      parts, [&](const ClockRelation& part) { return part.to_coordinator_s(clock_s) <= part.end_s; });
  return later == parts.end() ? parts.back() : *later;
}

std::vector<ParticipantClock> participant_clocks(const RunFileReader& coordinator) {
  std::vector<ParticipantClock> clocks;
  std::vector<std::optional<std::size_t>> at;
  for (const char* column : {"substructure", "exchanges", "there_at_s", "least_there_s", "mean_there_s", "back_at_s",
                             "least_back_s", "mean_back_s"}) {
    at.push_back(column_position(coordinator, kTable, column));
    if (!at.back()) return clocks;
  }
  const std::vector<std::string>& ids = coordinator.header().substructure_ids;
  std::vector<std::vector<ClockBounds>> part(ids.size());
  std::vector<ParticipantClock> all(ids.size());
  const auto close = [&](std::size_t index) {
    if (const auto relation = relate_clocks(part[index])) all[index].parts.push_back(*relation);
    part[index].clear();
  };
  read_rows(coordinator, kTable, [&](std::span<const double> row) {
    const double who = row[*at[0]];
    if (!(who >= 0.0 && who < static_cast<double>(ids.size()))) return true;
    const auto index = static_cast<std::size_t>(who);
    const ClockBounds bounds{row[*at[2]], row[*at[3]], row[*at[5]], row[*at[6]], row[*at[1]], row[*at[4]], row[*at[7]]};
    if (!part[index].empty() && bounds.there_at_s - part[index].front().there_at_s > kPart_s) close(index);
    part[index].push_back(bounds);
    return true;
  });
  for (std::size_t i = 0; i < ids.size(); ++i) {
    close(i);
    all[i].participant = ids[i];
    if (!all[i].parts.empty()) clocks.push_back(std::move(all[i]));
  }
  return clocks;
}

}  // namespace hybridtest
