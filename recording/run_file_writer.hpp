#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/messages.hpp"
#include "core/records.hpp"
#include "recording/run_file.hpp"

namespace hybridtest {

/// Writes one participant's run file: HDF5, single writer, multiple readers (SWMR).
///
/// Every table is an extensible one-dimensional dataset of a compound with one double per column;
/// `/events` the same with texts of fixed size; `/counters` and `/state` say what is safely in
/// the file. A process killed at any instant leaves a file that a SWMR reader opens, with every
/// row up to the last flush; repair() makes it an ordinary file again. (A power cut may lose what
/// the operating system had not written out yet.)
///
/// When a write fails (disk full), the file is left as it stands after the failure is noted in
/// `/state`, and the writer only counts losses from then on.
///
/// Use from one thread at a time, not a real-time one: everything here may block and allocate.
class RunFileWriter {
 public:
  /// Creates the file, replacing an older one of that name.
  /// @param tables   names and columns unique, non-empty, at most 63 bytes; `events`, `counters`
  ///                 and `state` are taken.
  /// @throws RecordingError when it cannot be created or a table is not as above.
  RunFileWriter(const std::filesystem::path& path, const RunFileHeader& header, std::vector<TableLayout> tables);
  /// Closes cleanly if that is still possible.
  ~RunFileWriter();
  RunFileWriter(const RunFileWriter&) = delete;
  RunFileWriter& operator=(const RunFileWriter&) = delete;

  /// @param table   position in the constructor's list.
  /// @param rows    whole rows, one after the other.
  /// @throws RecordingError when writing failed, now or before.
  void append(std::size_t table, std::span<const double> rows);
  /// @param texts   one sentence per event.
  /// @throws RecordingError as above.
  void append_events(std::span<const Event> events, std::span<const std::string> texts);

  /// Rows of a table that never reached append(), so far. @param table   as in append(); the
  /// number of tables stands for the events. Goes into the file with the next flush, or at once
  /// after a failure.
  void set_dropped(std::size_t table, std::uint64_t rows) noexcept;

  /// Makes everything appended safe against the end of this process and visible to readers.
  /// @throws RecordingError as above.
  void flush();
  /// Flushes and marks the file as closed cleanly. Nothing may be appended afterwards.
  /// @throws RecordingError as above.
  void close();

  [[nodiscard]] bool failed() const noexcept;
  /// Rows safe at the last flush. @param table   as in set_dropped().
  [[nodiscard]] std::uint64_t rows_flushed(std::size_t table) const noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hybridtest
