#include "runtime/live/live_signals.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <utility>

#include "core/assert.hpp"

namespace hybridtest {
namespace {

constexpr std::size_t kPoints = 8;
/// The exchanges are published after this many drains, of which there are twenty in a second.
constexpr std::uint64_t kDrainsPerExchange = 10;
constexpr std::uint64_t kDrainsPerWindow = 20;
constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();

std::size_t column_of(const TableLayout& layout, std::string_view name) {
  const auto position = layout.position(name);
  HYBRIDTEST_ASSERT(position.has_value());
  return *position;
}

LiveSignal figure(std::string_view name, std::string_view subject, std::string_view unit, double value) {
  return {.name = name, .subject = subject, .unit = unit, .least = {value}, .most = {value}, .last = {value}};
}

double microseconds(Duration duration) { return to_seconds(duration) * 1e6; }

}  // namespace

PointThinner::PointThinner(std::size_t signals, std::size_t points) : points_max_{points}, signals_(signals) {}

void PointThinner::add(double model_time_s, std::span<const double> values) {
  if (!model_time_s_.empty() && rows_in_last_ < rows_per_point_) {
    model_time_s_.back() = model_time_s;
    for (std::size_t i = 0; i < signals_.size(); ++i) {
      Points& points = signals_[i];
      // fmin and fmax prefer numbers to NaN.
      points.least.back() = std::fmin(points.least.back(), values[i]);
      points.most.back() = std::fmax(points.most.back(), values[i]);
      points.last.back() = values[i];
    }
    ++rows_in_last_;
    return;
  }
  if (model_time_s_.size() == points_max_) halve();
  model_time_s_.push_back(model_time_s);
  for (std::size_t i = 0; i < signals_.size(); ++i) {
    signals_[i].least.push_back(values[i]);
    signals_[i].most.push_back(values[i]);
    signals_[i].last.push_back(values[i]);
  }
  rows_in_last_ = 1;
}

void PointThinner::halve() {
  const std::size_t half = model_time_s_.size() / 2;
  for (std::size_t i = 0; i < half; ++i) {
    model_time_s_[i] = model_time_s_[2 * i + 1];
    for (Points& points : signals_) {
      points.least[i] = std::fmin(points.least[2 * i], points.least[2 * i + 1]);
      points.most[i] = std::fmax(points.most[2 * i], points.most[2 * i + 1]);
      points.last[i] = points.last[2 * i + 1];
    }
  }
  model_time_s_.resize(half);
  for (Points& points : signals_) {
    points.least.resize(half);
    points.most.resize(half);
    points.last.resize(half);
  }
  rows_per_point_ *= 2;
}

void PointThinner::clear() noexcept {
  model_time_s_.clear();
  for (Points& points : signals_) {
    points.least.clear();
    points.most.clear();
    points.last.clear();
  }
  rows_per_point_ = 1;
  rows_in_last_ = 0;
}

LiveSignals::LiveSignals(std::string_view participant, Incarnation incarnation,
                         std::unique_ptr<Outbox<SignalBlock>> outbox)
    : participant_{participant}, incarnation_{incarnation}, outbox_{std::move(outbox)} {}

void LiveSignals::add(std::string_view group, std::size_t table, const TableLayout& layout,
                      std::unique_ptr<DerivedSignals> signals) {
  const std::size_t count = signals->names().size();
  if (count == 0) return;
  groups_.push_back({.name = FixedText<32>{group},
                     .table = table,
                     .columns = layout.columns.size(),
                     .time_column = column_of(layout, "model_time_s"),
                     .signals = std::move(signals),
                     .values = std::vector<double>(count),
                     .points = PointThinner{std::min(count, kLiveSignalsOfGroup), kPoints},
                     .sequence = {}});
}

void LiveSignals::add_exchanges(std::size_t table, const TableLayout& layout, std::vector<std::string> substructures,
                                double step_s) {
  Exchanges exchanges{.table = table,
                      .columns = layout.columns.size(),
                      .step = column_of(layout, "step"),
                      .substructure = column_of(layout, "substructure"),
                      .round_trip = column_of(layout, "round_trip_us"),
                      .attempts = column_of(layout, "attempts"),
                      .step_s = step_s,
                      .each = {},
                      .sequence = {}};
  for (std::string& id : substructures)
    exchanges.each.push_back({.substructure = std::move(id), .now = {}, .last = {}});
  exchanges_ = std::move(exchanges);
}

void LiveSignals::see(std::size_t table, std::span<const double> rows) noexcept {
  try {
    for (Group& group : groups_) {
      if (group.table == table) read(group, rows);
    }
    if (exchanges_ && exchanges_->table == table) read_exchanges(rows);
  } catch (const std::exception&) {  // out of memory: the view misses rows, the recording does not
  }
}

void LiveSignals::read(Group& group, std::span<const double> rows) {
  for (std::size_t begin = 0; begin < rows.size(); begin += group.columns) {
    const std::span<const double> row = rows.subspan(begin, group.columns);
    group.signals->read(row, group.values);
    group.points.add(row[group.time_column], group.values);
  }
}

void LiveSignals::read_exchanges(std::span<const double> rows) {
  for (std::size_t begin = 0; begin < rows.size(); begin += exchanges_->columns) {
    const std::span<const double> row = rows.subspan(begin, exchanges_->columns);
    exchanges_->newest_step = row[exchanges_->step];
    const auto index = static_cast<std::size_t>(row[exchanges_->substructure]);
    if (index >= exchanges_->each.size()) continue;
    Exchange& exchange = exchanges_->each[index];
    exchange.resent += std::max(0.0, row[exchanges_->attempts] - 1.0);
    const double round_trip_us = row[exchanges_->round_trip];
    if (std::isfinite(round_trip_us)) {
      exchange.answered += 1.0;
      exchange.now.record(from_seconds(round_trip_us * 1e-6));
    } else {
      exchange.unanswered += 1.0;
      exchange.last_unanswered_step = row[exchanges_->step];
    }
  }
}

void LiveSignals::end_of_drain() noexcept {
  try {
    for (Group& group : groups_) publish(group);
    if (!exchanges_) return;
    const std::uint64_t drain = ++exchanges_->drains;
    if (drain % kDrainsPerWindow == 0) {
      for (Exchange& exchange : exchanges_->each) exchange.last = std::exchange(exchange.now, {});
    }
    if (drain % kDrainsPerExchange == 0) publish_exchanges();
  } catch (const std::exception&) {  // as above
  }
}

void LiveSignals::publish(Group& group) {
  if (group.points.model_time_s().empty()) return;
  std::vector<LiveSignal> signals;
  const std::size_t count = std::min(group.signals->names().size(), kLiveSignalsOfGroup);
  for (std::size_t i = 0; i < count; ++i) {
    const SignalName& name = group.signals->names()[i];
    signals.push_back({.name = name.name,
                       .subject = name.subject,
                       .unit = name.unit,
                       .limit = name.limit,
                       .least = group.points.least(i),
                       .most = group.points.most(i),
                       .last = group.points.last(i)});
  }
  send(group.name, group.sequence, group.points.model_time_s(), std::move(signals));
  group.points.clear();
}

void LiveSignals::publish_exchanges() {
  std::vector<LiveSignal> signals;
  for (const Exchange& exchange : exchanges_->each) {
    if (exchange.answered + exchange.unanswered == 0.0) continue;
    const DurationHistogram& window = exchange.last.count() > 0 ? exchange.last : exchange.now;
    const auto quantile = [&](double share) {
      return window.count() > 0 ? microseconds(window.quantile(share)) : kNoValue;
    };
    // A step without an answer that others followed was bridged; the newest one is lost if the test ends with it.
    const double lost = exchange.last_unanswered_step == exchanges_->newest_step ? 1.0 : 0.0;
    const std::string& id = exchange.substructure;
    signals.push_back(figure("round_trip_p50", id, "us", quantile(0.5)));
    signals.push_back(figure("round_trip_p99", id, "us", quantile(0.99)));
    signals.push_back(figure("answered", id, "", exchange.answered));
    signals.push_back(figure("resent", id, "", exchange.resent));
    signals.push_back(figure("bridged", id, "", exchange.unanswered - lost));
    signals.push_back(figure("lost", id, "", lost));
  }
  if (signals.empty()) return;
  send(FixedText<32>{"exchange"}, exchanges_->sequence, {exchanges_->newest_step * exchanges_->step_s},
       std::move(signals));
}

void LiveSignals::send(FixedText<32> group, std::vector<std::uint64_t>& sequence,
                       const std::vector<double>& model_time_s, std::vector<LiveSignal> signals) {
  const std::size_t parts = (signals.size() + kMaxLiveSignals - 1) / kMaxLiveSignals;
  sequence.resize(std::max(sequence.size(), parts));
  for (std::size_t part = 0; part < parts; ++part) {
    SignalBlock block{.participant = participant_,
                      .incarnation = incarnation_,
                      .group = group,
                      .part = static_cast<std::uint16_t>(part),
                      .sequence = sequence[part]++,
                      .model_time_s = model_time_s};
    const auto begin = signals.begin() + static_cast<std::ptrdiff_t>(part * kMaxLiveSignals);
    const auto end =
        signals.begin() + static_cast<std::ptrdiff_t>(std::min(signals.size(), (part + 1) * kMaxLiveSignals));
    block.signals.assign(std::make_move_iterator(begin), std::make_move_iterator(end));
    outbox_->send(block);
  }
}

}  // namespace hybridtest
