#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/records.hpp"
#include "recording/event_ring.hpp"
#include "recording/row_ring.hpp"
#include "recording/run_file_writer.hpp"

namespace hybridtest {

/// A table and the number of rows that may wait for the disk.
struct RecordedTable {
  TableLayout layout;
  std::size_t ring_rows = 8192;
};

/// Sees what is recorded, on the thread that drains the rings: never on the path of a step.
class RowObserver {
 public:
  virtual ~RowObserver() = default;

  /// @param table   position in the list of tables that the recorder was made with.
  /// @param rows    row after row, every column; at least one row.
  virtual void see(std::size_t table, std::span<const double> rows) noexcept = 0;
  /// After each drain, with or without rows.
  virtual void end_of_drain() noexcept = 0;
};

/// Everything one participant records: a ring per table and per event source, and the run file
/// that they are drained into.
///
/// Producers call append() and send() on what sink() and events() return, one thread each, and
/// never wait. One other thread calls drain(); RecorderThread does so, or a simulation between
/// its steps. After a write error the recorder stays usable: failed() turns true, rings are
/// still emptied, and every row is counted as dropped.
class Recorder {
 public:
  /// @param event_sources   producers of events, each with a queue of its own.
  /// @throws RecordingError when the file cannot be created.
  Recorder(const std::filesystem::path& path, const RunFileHeader& header, std::vector<RecordedTable> tables,
           std::size_t event_sources = 1, std::size_t events_per_source = 1024);
  /// Closes, if close() was not called.
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// The named table must exist. Lives as long as the recorder.
  [[nodiscard]] RowSink& sink(std::string_view table);
  /// @param source   below `event_sources`.
  [[nodiscard]] Outbox<Event>& events(std::size_t source = 0);
  /// @param observer   must outlive the drains; nullptr for none. Not while another thread drains.
  void set_observer(RowObserver* observer) noexcept { observer_ = observer; }

  /// Whether a ring is at least half full, so that a caller without RecorderThread should drain().
  [[nodiscard]] bool should_drain() const noexcept;
  /// Writes all rows that wait in the rings and flushes the file.
  void drain() noexcept;
  /// Drains the rings and closes the file cleanly. Producers must have stopped; drain() does
  /// nothing afterwards.
  void close() noexcept;

  /// Any thread.
  [[nodiscard]] bool failed() const noexcept { return failed_.load(std::memory_order_acquire); }
  /// Any thread; why recording failed, empty when it did not.
  [[nodiscard]] std::string error_text() const { return failed() ? error_text_ : std::string{}; }
  /// Any thread; the errno of the file system that error_text() names, 0 when it names none.
  [[nodiscard]] int error_number() const;
  /// Any thread; rows and events that will never be in the file, as of the last drain().
  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }

 private:
  void drain_table(std::size_t table);
  void drain_events();
  void count_losses();
  void fail(std::string text) noexcept;
  /// Runs `work` and turns its error into failed().
  template <class Work>
  void attempt(Work&& work) noexcept;

  std::size_t events_per_source_;
  std::vector<std::string> table_names_;
  std::vector<std::unique_ptr<RowRing>> rings_;
  std::vector<std::unique_ptr<EventRing>> event_rings_;
  std::vector<std::uint64_t> taken_;  // rows taken out of each ring, then events
  std::vector<double> rows_;          // on their way from ring to file
  std::unique_ptr<RunFileWriter> writer_;
  RowObserver* observer_ = nullptr;
  bool closed_ = false;
  std::string error_text_;  // written once, before failed_ turns true
  std::atomic<bool> failed_{false};
  std::atomic<std::uint64_t> dropped_{0};
};

}  // namespace hybridtest
