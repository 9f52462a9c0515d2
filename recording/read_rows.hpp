#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string_view>

#include "recording/run_file_reader.hpp"

namespace hybridtest {

/// Rows of a table in memory at once: an hour at 1 kHz is read in pieces of a few seconds.
inline constexpr std::size_t kRowsInMemory = 8192;

/// Hands over the rows of a table one by one, of which only a block is in memory, until `visit` returns false. Nothing
/// for a table that is not there.
/// @param first   row to begin with.
void read_rows(const RunFileReader& file, std::string_view table,
               const std::function<bool(std::span<const double> row)>& visit, std::size_t first = 0);

}  // namespace hybridtest
