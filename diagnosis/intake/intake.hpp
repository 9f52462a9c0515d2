#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "diagnosis/recording.hpp"

namespace hybridtest {

/// One thing wrong with a recording, by its place. Nothing of a recording is ever repaired.
struct IntakeFinding {
  std::size_t row = 0;       // line of the file, the header being 1; 0 when it belongs to no row
  std::string column;        // empty when it belongs to no column
  std::string value;         // as found; empty where there is none to show
  std::string what;          // what is wrong and what was expected
  std::size_t more = 0;      // rows further down with the same in the same column
  std::size_t last_row = 0;  // the last of them

  /// `FILE:ROW: column 'C': 'VALUE': WHAT (and in 12 more rows, the last 400)`
  [[nodiscard]] std::string text(const std::string& file) const;
};

/// Collects findings; the same kind in the same column becomes one finding that counts its rows.
class FindingList {
 public:
  void add(std::size_t row, const std::string& column, const std::string& value, const std::string& what);
  [[nodiscard]] bool empty() const noexcept { return findings_.empty(); }
  /// In the order of the rows, those without a row first; last, how many were too many to list.
  [[nodiscard]] std::vector<IntakeFinding> sorted() const;

 private:
  std::vector<IntakeFinding> findings_;
  std::size_t left_out_ = 0;
};

/// A channel as it was found, before anything is checked.
struct RawColumn {
  std::string name;  // as headed
  Channel channel{};
  std::size_t dof = 0;  // 0-based
  std::vector<double> values;
};

/// A recording as it was found: all columns of one length.
struct RawRecording {
  std::string file;           // as the user named it
  std::size_t first_row = 1;  // how the first sample is counted in findings
  std::vector<double> time_s;
  double time_resolution_s = 0.0;  // of the last digit of the time stamps; 0 when they are not rounded
  std::vector<RawColumn> columns;
};

/// A column's place in a recording.
struct ChannelColumn {
  Channel channel{};
  std::size_t dof = 0;  // 0-based
};

inline constexpr std::string_view kTimeColumn = "time_s";

/// What a column is by its header: `measured_force_n` or `measured_force_n_2`, counted from 1.
/// @return nothing for a header that names no channel.
[[nodiscard]] std::optional<ChannelColumn> channel_of_header(std::string_view header);

/// Whether it is a column that a run's own tables and replays have and the diagnosis has no use for.
[[nodiscard]] bool is_left_aside(std::string_view header);

/// What to say of a header that is unknown: the nearest known name, and all of them.
[[nodiscard]] std::string unknown_column_advice(std::string_view header);

/// Finds repeated, reversed and unevenly spaced time stamps, gaps, and a period that drifts.
///
/// An interval is even when it differs from the median interval by less than a hundredth or, where
/// the stamps were rounded to digits (1/1024 s written as 0.000977), by the last digit; digits
/// coarser than a tenth of the period cannot excuse anything. The whole must follow an even grid
/// within half a period.
/// @param raw   at least two samples, times finite.
/// @return the period [s]: length over intervals; meaningless when something was found.
[[nodiscard]] double check_sampling(const RawRecording& raw, FindingList& findings);

/// What became of a recording: itself, or everything that is wrong with it.
struct Intake {
  std::optional<Recording> recording;  // without its hash and role, which the reader of the file knows
  std::vector<IntakeFinding> findings;
};

/// Takes a recording from CSV: a header of names and units (`time_s`, and any of column_name(), with
/// `_1`, `_2` … for several degrees of freedom), one row per sample, SI.
///
/// Columns of a run's own tables that are no channel are left aside; any other unknown one is a
/// finding, and so is everything of check_recording().
/// @param file   as the user named it.
[[nodiscard]] Intake read_csv_recording(std::string_view text, const std::string& file);

/// Checks what was read: every value finite, sampling even and without gaps (check_sampling()),
/// units plausible (check_units()), degrees of freedom without a hole, samples enough.
[[nodiscard]] Intake check_recording(RawRecording raw);

}  // namespace hybridtest
