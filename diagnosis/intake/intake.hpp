#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "diagnosis/recording.hpp"

namespace hybridtest {

/// One error in a recording and its place. Recordings are never repaired automatically.
struct IntakeFinding {
  std::size_t row = 0;       // line of the file, the header being 1; 0 when it belongs to no row
  std::string column;        // empty when it belongs to no column
  std::string value;         // as found; empty where there is none to show
  std::string what;          // what is wrong and what was expected
  std::size_t more = 0;      // later rows with the same error in the same column
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

/// A channel as it was read, before any check.
struct RawColumn {
  std::string name;  // as headed
  Channel channel{};
  std::size_t dof = 0;  // 0-based
  std::vector<double> values;
};

/// An input beside the motion as it was read.
struct RawInput {
  std::string column;  // as headed: `input_current_a`
  std::vector<double> values;
};

/// What time stamps mean: time as recorded, or nothing, because the test is slow and they were invented.
enum class TimeBase : std::uint8_t { recorded, quasi_static };

/// A recording as it was read: all columns have the same length.
struct RawRecording {
  std::string file;                // as the user named it
  std::size_t first_row = 1;       // row number of the first sample in findings
  std::vector<double> time_s;      // empty: a quasi-static recording
  std::vector<double> step;        // numbers of its points; may be empty
  double time_resolution_s = 0.0;  // of the last digit of the time stamps; 0 when they are not rounded
  std::vector<RawColumn> columns;
  std::vector<RawInput> inputs{};

  [[nodiscard]] std::size_t samples() const noexcept;
};

/// A column's place in a recording.
struct ChannelColumn {
  Channel channel{};
  std::size_t dof = 0;  // 0-based
};

inline constexpr std::string_view kTimeColumn = "time_s";
inline constexpr std::string_view kStepColumn = "step";

/// Channel and degree of freedom that a header names: `measured_force_n` or `measured_force_n_2`, counted from 1.
/// @return nothing for a header that names no channel.
[[nodiscard]] std::optional<ChannelColumn> channel_of_header(std::string_view header);

/// Whether a header names an input beside the motion: `input_` and a name in lower-case letters, digits and `_`.
[[nodiscard]] bool is_input_header(std::string_view header) noexcept;

/// Whether it is a known column of run tables or replays that the diagnosis does not use.
[[nodiscard]] bool is_left_aside(std::string_view header);

/// The message for an unknown header: the nearest known name, and all known names.
[[nodiscard]] std::string unknown_column_advice(std::string_view header);

/// Finds repeated, reversed and unevenly spaced time stamps, gaps, and a period that drifts.
///
/// An interval is accepted when it differs from the median interval by less than 1 % or, if the time stamps
/// are rounded (1/1024 s written as 0.000977), by less than the last digit. Digits coarser than a tenth of the
/// period do not widen the tolerance. All time stamps must be within half a period of a grid with a constant
/// period.
/// @param raw   at least two samples, times finite.
/// @return the period [s]: length over intervals; meaningless when something was found.
[[nodiscard]] double check_sampling(const RawRecording& raw, FindingList& findings);

/// Whether time stamps are those of a quasi-static test: most intervals are uneven, the stamps leave every even grid by
/// more than half a period (those of a jittery clock do not), and only measured displacement and force were recorded.
/// @param raw   at least two samples, times finite.
[[nodiscard]] bool has_invented_time(const RawRecording& raw);

/// The result of reading a recording: the recording, or all errors found in it.
struct Intake {
  std::optional<Recording> recording;  // without hash and role; the reader of the file fills them in
  std::vector<IntakeFinding> findings;
};

/// Reads a recording from CSV: a header of names and units (`time_s`, and any of column_name(), with
/// `_1`, `_2` … for several degrees of freedom, and inputs beside the motion), one row per sample, SI. Without
/// `time_s`, or with `step` in its place, it is quasi-static.
///
/// Columns of run tables that are not channels are ignored; any other unknown column is a finding.
/// All findings of check_recording() are added.
/// @param file   as the user named it.
/// @param time   quasi_static: the time column has no meaning.
[[nodiscard]] Intake read_csv_recording(std::string_view text, const std::string& file,
                                        TimeBase time = TimeBase::recorded);

/// Checks what was read: every value finite, sampling even and without gaps (check_sampling()) unless the recording is
/// quasi-static, units plausible (check_units()), no missing degree of freedom, enough samples.
[[nodiscard]] Intake check_recording(RawRecording raw, TimeBase time = TimeBase::recorded);

}  // namespace hybridtest
