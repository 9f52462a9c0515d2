#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/duration_histogram.hpp"
#include "core/messages.hpp"
#include "core/ports.hpp"
#include "recording/recorder.hpp"
#include "runtime/live/derived_signals.hpp"

namespace hybridtest {

/// Most signals of one group that are published; further ones are only recorded.
inline constexpr std::size_t kLiveSignalsOfGroup = 128;

/// Thins rows to a few points without losing a peak: when there is no room for another point, neighbours become one
/// point with the extremes of both.
class PointThinner {
 public:
  /// @param signals   values per row.
  /// @param points    most that are kept, even.
  PointThinner(std::size_t signals, std::size_t points);

  void add(double model_time_s, std::span<const double> values);
  [[nodiscard]] const std::vector<double>& model_time_s() const noexcept { return model_time_s_; }
  /// [signal] one entry per point.
  [[nodiscard]] const std::vector<double>& least(std::size_t signal) const { return signals_[signal].least; }
  [[nodiscard]] const std::vector<double>& most(std::size_t signal) const { return signals_[signal].most; }
  [[nodiscard]] const std::vector<double>& last(std::size_t signal) const { return signals_[signal].last; }
  void clear() noexcept;

 private:
  struct Points {
    std::vector<double> least, most, last;
  };

  void halve();

  std::size_t points_max_;
  std::size_t rows_per_point_ = 1;
  std::size_t rows_in_last_ = 0;
  std::vector<double> model_time_s_;
  std::vector<Points> signals_;
};

/// Publishes what a participant records, for live views: after each drain of the recorder one block per group of
/// signals, with at most eight points in which no peak is lost. Runs on the thread of the recorder.
class LiveSignals final : public RowObserver {
 public:
  /// @param outbox   used by the thread of the recorder alone.
  LiveSignals(std::string_view participant, Incarnation incarnation, std::unique_ptr<Outbox<SignalBlock>> outbox);

  /// Publishes derived signals of a table, the first kLiveSignalsOfGroup of them.
  /// @param table         position among the recorder's tables, whose layout has a column model_time_s.
  void add(std::string_view group, std::size_t table, const TableLayout& layout,
           std::unique_ptr<DerivedSignals> signals);
  /// Publishes twice a second, for each substructure (the subject) the quantiles of its round trips `round_trip_p50`
  /// and `round_trip_p99` [us] over the last whole second, and since the start `answered`, `resent` (commands sent
  /// again), `bridged` (steps completed without an answer) and `lost`.
  /// @param table    of the exchanges.
  void add_exchanges(std::size_t table, const TableLayout& layout, std::vector<std::string> substructures,
                     double step_s);

  void see(std::size_t table, std::span<const double> rows) noexcept override;
  void end_of_drain() noexcept override;

 private:
  struct Group {
    FixedText<32> name;
    std::size_t table = 0;
    std::size_t columns = 0;
    std::size_t time_column = 0;
    std::unique_ptr<DerivedSignals> signals;
    std::vector<double> values;
    PointThinner points;
    std::vector<std::uint64_t> sequence;  // by part
  };
  /// Exchanges with one substructure.
  struct Exchange {
    std::string substructure;
    DurationHistogram now;   // of the present window
    DurationHistogram last;  // of the window before
    double answered = 0.0;
    double resent = 0.0;
    double unanswered = 0.0;
    double last_unanswered_step = -1.0;
  };
  struct Exchanges {
    std::size_t table = 0;
    std::size_t columns = 0;
    std::size_t step = 0, substructure = 0, round_trip = 0, attempts = 0;  // positions of columns
    double step_s = 0.0;
    double newest_step = 0.0;
    std::vector<Exchange> each;
    std::uint64_t drains = 0;
    std::vector<std::uint64_t> sequence;
  };

  void read(Group& group, std::span<const double> rows);
  void read_exchanges(std::span<const double> rows);
  void publish(Group& group);
  void publish_exchanges();
  /// Fills the block with signals and sends it when it is full.
  void send(FixedText<32> group, std::vector<std::uint64_t>& sequence, const std::vector<double>& model_time_s,
            std::vector<LiveSignal> signals);

  ParticipantId participant_;
  Incarnation incarnation_;
  std::unique_ptr<Outbox<SignalBlock>> outbox_;
  std::vector<Group> groups_;
  std::optional<Exchanges> exchanges_;
};

}  // namespace hybridtest
