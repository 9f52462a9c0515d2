#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace hybridtest {

/// Adds a cell in quotes to a line, its own quotes doubled.
void append_quoted(std::string& text, std::string_view value);

/// Writes every table of every run file of a run directory as `<participant's file>.<table>.csv`,
/// and its events as `<participant's file>.events.csv`. `clocks.csv` says how the clocks of the participants stand to
/// the coordinator's, see ClockRelation; it is absent where nothing was exchanged.
///
/// The first line names the columns, units included (`time_s,target_displacement_m,…`); numbers are
/// the shortest text that reads back as the same double, `nan` and `inf` as such. The table `control`
/// of a site is a recording that the diagnosis takes.
/// @return the files written, sorted.
/// @throws RecordingError when there is no run file, one cannot be read, or writing fails.
std::vector<std::filesystem::path> export_csv(const std::filesystem::path& run_directory,
                                              const std::filesystem::path& out_directory);

}  // namespace hybridtest
