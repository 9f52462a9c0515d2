#pragma once

#include <filesystem>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "recording/read_rows.hpp"
#include "recording/run_file_reader.hpp"

namespace hybridtest::run_report {

/// A signal of a history, by the name of its column: `displacement_floor_1_m`.
struct HistoryColumn {
  std::string name;
  std::size_t position = 0;  // in its table
};

/// Histories that are read step by step, so that an hour does not have to fit into memory.
class HistorySource {
 public:
  virtual ~HistorySource() = default;

  [[nodiscard]] const std::vector<HistoryColumn>& columns() const noexcept { return columns_; }
  /// The next step; false at the end.
  virtual bool next() = 0;
  [[nodiscard]] double time_s() const noexcept { return time_s_; }
  /// One per column.
  [[nodiscard]] std::span<const double> values() const noexcept { return values_; }

 protected:
  std::vector<HistoryColumn> columns_;
  double time_s_ = 0.0;
  std::vector<double> values_;
};

/// The columns of a table of a run file whose names begin with one of `wanted`, over its model time.
class TableHistory final : public HistorySource {
 public:
  /// @param file   must outlive it.
  TableHistory(const RunFileReader& file, std::string_view table, std::span<const std::string> wanted);
  bool next() override;

 private:
  RowCursor rows_;
  std::optional<std::size_t> time_;
};

/// A CSV file with a head, whose column `time_s` is the time and whose other columns are histories.
class CsvHistory final : public HistorySource {
 public:
  /// @throws ConfigError when it cannot be read or has no column `time_s`.
  explicit CsvHistory(std::filesystem::path path);
  /// @throws ConfigError for a line that does not hold one number per column.
  bool next() override;

 private:
  std::filesystem::path path_;
  std::ifstream stream_;
  std::size_t line_ = 1;
  std::size_t time_ = 0;
  std::size_t width_ = 0;
  std::vector<double> numbers_;
};

}  // namespace hybridtest::run_report
