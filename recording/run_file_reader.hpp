#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/records.hpp"
#include "recording/run_file.hpp"

namespace hybridtest {

/// Reads one participant's run file: finished, being written, left by a killed process, or
/// repaired. Shows the rows that were complete in the file when it was opened or last refreshed.
class RunFileReader {
 public:
  /// @throws RecordingError when it is not there or not a run file of a known schema.
  explicit RunFileReader(const std::filesystem::path& path);
  ~RunFileReader();
  RunFileReader(RunFileReader&&) noexcept;
  RunFileReader& operator=(RunFileReader&&) noexcept;

  [[nodiscard]] const std::filesystem::path& path() const noexcept;
  [[nodiscard]] const RunFileHeader& header() const noexcept;
  [[nodiscard]] const RunFileCounters& counters() const noexcept;

  /// The tables but for events, in the order in which they were declared.
  [[nodiscard]] const std::vector<TableLayout>& tables() const noexcept;
  [[nodiscard]] bool has_table(std::string_view table) const noexcept;
  [[nodiscard]] bool has_column(std::string_view table, std::string_view column) const noexcept;
  /// 0 for a table that is not there.
  [[nodiscard]] std::size_t row_count(std::string_view table) const noexcept;

  /// All rows of one column. @throws RecordingError when there is no such column.
  [[nodiscard]] std::vector<double> column(std::string_view table, std::string_view column) const;
  /// Rows `first` to `first + count - 1` (or to the end), row after row, every column.
  [[nodiscard]] std::vector<double> rows(std::string_view table, std::size_t first, std::size_t count) const;
  [[nodiscard]] std::vector<RecordedEvent> events() const;

  /// Reads what a writer has flushed in the meantime. @throws RecordingError as the constructor.
  void refresh();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Makes the file of a killed process, or one whose disk was full, an ordinary HDF5 file that every
/// tool opens, and cuts rows off that were not completely written. It keeps saying that it was not
/// closed cleanly. A file in order is left alone.
/// @return whether there was anything to repair.
/// @throws RecordingError when it is not a run file, cannot be repaired, or is being written.
bool repair(const std::filesystem::path& path);

}  // namespace hybridtest
