#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "recording/run_file_reader.hpp"

namespace hybridtest {

/// The rows of a table one after the other, of which only a block is in memory.
class RowCursor {
 public:
  /// @param file    must outlive it.
  /// @param first   row to begin with.
  RowCursor(const RunFileReader& file, std::string_view table, std::size_t first = 0);
  /// Until the next call; empty at the end, and for a table that is not there.
  [[nodiscard]] std::span<const double> next();

 private:
  const RunFileReader& file_;
  std::string table_;
  std::size_t width_ = 0;
  std::size_t count_ = 0;
  std::size_t first_;  // of the block that comes next
  std::size_t at_ = 0;
  std::vector<double> block_;
};

/// Hands over the rows of a table one by one, of which only a block is in memory, until `visit` returns false. Nothing
/// for a table that is not there.
/// @param first   row to begin with.
void read_rows(const RunFileReader& file, std::string_view table,
               const std::function<bool(std::span<const double> row)>& visit, std::size_t first = 0);

}  // namespace hybridtest
