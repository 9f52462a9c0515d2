#include "report/live/signal_history.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace hybridtest {
namespace {

/// Points that a page can catch up with one by one: some seconds at 160 points a second.
constexpr std::size_t kNewestPoints = 800;
constexpr double kRecent_s = 30.0;
constexpr std::size_t kRecentPoints = 1500;
constexpr std::size_t kWholePoints = 2000;
/// Finer than the steps of any test; it doubles as the test goes on.
constexpr double kFinest_s = 1e-4;

}  // namespace

BinnedPoints::BinnedPoints(double width_s, std::size_t points_max, double window_s)
    : width_s_{width_s}, points_max_{points_max}, window_s_{window_s} {}

void BinnedPoints::add(const LivePoint& point) {
  put(point);
  while (points_.front().model_time_s < point.model_time_s - window_s_) points_.pop_front();
  while (points_.size() > points_max_) {
    width_s_ *= 2.0;
    std::deque<LivePoint> finer;
    finer.swap(points_);
    for (const LivePoint& one : finer) put(one);
  }
}

void BinnedPoints::put(const LivePoint& point) {
  const auto bin = [this](const LivePoint& one) { return std::floor(one.model_time_s / width_s_); };
  if (points_.empty() || bin(points_.back()) != bin(point)) {
    points_.push_back(point);
    return;
  }
  LivePoint& merged = points_.back();
  // The extremes of numbers alone: fmin and fmax leave out NaN.
  merged = {point.model_time_s, std::fmin(merged.least, point.least), std::fmax(merged.most, point.most), point.last};
}

SignalHistory::SignalHistory()
    : recent_{kRecent_s / static_cast<double>(kRecentPoints), kRecentPoints + 2, kRecent_s},
      whole_{kFinest_s, kWholePoints} {}

std::uint64_t SignalHistory::add(std::uint64_t cursor, const LivePoint& point) {
  recent_.add(point);
  whole_.add(point);
  peak_ = std::fmax(peak_, std::fmax(std::abs(point.least), std::abs(point.most)));
  newest_.push_back({cursor, point});
  if (newest_.size() <= kNewestPoints) return 0;
  const std::uint64_t dropped = newest_.front().cursor;
  newest_.pop_front();
  return dropped;
}

void SignalHistory::amend(const LivePoint& point) {
  recent_.add(point);
  whole_.add(point);
  peak_ = std::fmax(peak_, std::fmax(std::abs(point.least), std::abs(point.most)));
  newest_.back().point = point;
}

std::vector<LivePoint> SignalHistory::since(std::uint64_t cursor) const {
  const auto first = std::ranges::upper_bound(newest_, cursor, {}, &Arrived::cursor);
  std::vector<LivePoint> points;
  for (auto one = first; one != newest_.end(); ++one) points.push_back(one->point);
  return points;
}

std::vector<LivePoint> SignalHistory::recent() const { return {recent_.points().begin(), recent_.points().end()}; }

std::vector<LivePoint> SignalHistory::whole() const { return {whole_.points().begin(), whole_.points().end()}; }

LivePoint SignalHistory::newest() const noexcept {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  return newest_.empty() ? LivePoint{kNone, kNone, kNone, kNone} : newest_.back().point;
}

}  // namespace hybridtest
