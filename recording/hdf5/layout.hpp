#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/records.hpp"
#include "recording/hdf5/handle.hpp"
#include "recording/run_file.hpp"

/// How run files lay out events, counters and attributes; one place for writer, reader, repair.
namespace hybridtest::hdf5 {

inline constexpr const char* kEventsName = "events";
inline constexpr const char* kCountersName = "counters";
inline constexpr const char* kStateName = "state";
inline constexpr const char* kUnitsName = "units";
inline constexpr const char* kColumnNamesName = "column_names";

/// `/events`, one row each. Texts are padded with zero bytes.
struct EventRow {
  double time_s;  // sender's clock
  std::uint64_t incarnation;
  std::int64_t step;
  double model_time_s;
  double value_1;
  double value_2;
  std::uint16_t code;
  std::uint8_t severity;
  std::array<char, 48> source;
  std::array<char, 48> subject;
  std::array<char, 32> code_name;
  std::array<char, 192> text;
};

/// `/counters`, one row per table.
struct CounterRow {
  std::array<char, 64> table;
  std::uint64_t rows;
  std::uint64_t dropped_rows;
};

/// `/state`, one row.
struct StateRow {
  std::uint64_t flushes;
  std::uint8_t closed_cleanly;
  std::uint8_t write_failed;
};

[[nodiscard]] EventRow to_row(const Event& event, const std::string& text);
[[nodiscard]] RecordedEvent from_row(const EventRow& row);

[[nodiscard]] Handle event_type();
[[nodiscard]] Handle counter_type();
[[nodiscard]] Handle state_type();
/// A compound with one double per column.
[[nodiscard]] Handle row_type(const std::vector<Column>& columns);
/// Text of fixed size, zero-padded UTF-8. @param size   at least 1.
[[nodiscard]] Handle text_type(std::size_t size);

void write_attribute(hid_t object, const char* name, const std::string& value);
/// An empty list writes nothing: not every reader copes with empty attributes.
void write_attribute(hid_t object, const char* name, const std::vector<std::string>& values);
void write_attribute(hid_t object, const char* name, double value);
/// An attribute that is not there reads as empty, a number as 0.
[[nodiscard]] std::string read_text_attribute(hid_t object, const char* name);
[[nodiscard]] std::vector<std::string> read_list_attribute(hid_t object, const char* name);
[[nodiscard]] double read_number_attribute(hid_t object, const char* name);

/// Names and units of the columns, for tools that cannot tell them from the type of the rows.
void write_columns(hid_t table, const std::vector<Column>& columns);
/// The columns of `/events`, `/counters` and `/state`.
[[nodiscard]] std::vector<Column> event_columns();
[[nodiscard]] std::vector<Column> counter_columns();
[[nodiscard]] std::vector<Column> state_columns();

void write_note(hid_t table, const TableNote& note);
/// @return without a description when the file has none, as of older versions.
[[nodiscard]] TableNote read_note(hid_t table, const std::string& name);

void write_header(hid_t file, const RunFileHeader& header);
/// @throws RecordingError when the schema is another one.
[[nodiscard]] RunFileHeader read_header(hid_t file);

/// `/counters` and `/state` of an open file.
[[nodiscard]] RunFileCounters read_counters(hid_t file);

}  // namespace hybridtest::hdf5
