#include "recording/hdf5/layout.hpp"

#include <algorithm>
#include <charconv>
#include <cstddef>

#include "core/time.hpp"
#include "recording/error.hpp"

namespace hybridtest::hdf5 {
namespace {

template <std::size_t Size>
void put(std::array<char, Size>& target, std::string_view text) {
  target.fill('\0');
  std::copy_n(text.data(), std::min(text.size(), Size), target.data());
}

template <std::size_t Size>
std::string_view get(const std::array<char, Size>& source) {
  return {source.data(), static_cast<std::size_t>(std::find(source.begin(), source.end(), '\0') - source.begin())};
}

void insert(const Handle& type, const char* name, std::size_t offset, hid_t member) {
  check(H5Tinsert(type.id(), name, offset, member), std::string{"describing "} + name);
}

Handle compound(std::size_t size) { return {checked(H5Tcreate(H5T_COMPOUND, size), "describing a record"), H5Tclose}; }

/// Members of a compound, in its order.
std::vector<Column> columns_of(const Handle& type, const std::vector<std::string>& units) {
  std::vector<Column> columns;
  for (std::size_t i = 0; i < units.size(); ++i) {
    char* const name = H5Tget_member_name(type.id(), static_cast<unsigned>(i));
    columns.push_back({name == nullptr ? std::string{} : name, units[i]});
    H5free_memory(name);
  }
  return columns;
}

Handle list_space(std::size_t size) {
  const hsize_t count = size;
  return {checked(H5Screate_simple(1, &count, nullptr), "describing an attribute"), H5Sclose};
}

}  // namespace

EventRow to_row(const Event& event, const std::string& text) {
  EventRow row{};
  row.time_s = to_seconds(event.clock);
  row.incarnation = event.incarnation;
  row.step = event.step;
  row.model_time_s = event.model_time_s;
  row.value_1 = event.values[0];
  row.value_2 = event.values[1];
  row.code = static_cast<std::uint16_t>(event.code);
  row.severity = static_cast<std::uint8_t>(event.severity);
  put(row.source, event.source.view());
  put(row.subject, event.subject.view());
  put(row.code_name, name(event.code));
  put(row.text, text);
  return row;
}

RecordedEvent from_row(const EventRow& row) {
  Event event;
  event.source = get(row.source);
  event.incarnation = row.incarnation;
  event.severity = static_cast<Severity>(row.severity);
  event.code = static_cast<EventCode>(row.code);
  event.step = row.step;
  event.model_time_s = row.model_time_s;
  event.subject = get(row.subject);
  event.values = {row.value_1, row.value_2};
  event.clock = from_seconds(row.time_s);
  return {event, std::string{get(row.text)}};
}

Handle text_type(std::size_t size) {
  Handle type{checked(H5Tcopy(H5T_C_S1), "describing text"), H5Tclose};
  check(H5Tset_size(type.id(), size), "describing text");
  check(H5Tset_strpad(type.id(), H5T_STR_NULLPAD), "describing text");
  check(H5Tset_cset(type.id(), H5T_CSET_UTF8), "describing text");
  return type;
}

Handle event_type() {
  Handle type = compound(sizeof(EventRow));
  insert(type, "time_s", HOFFSET(EventRow, time_s), H5T_NATIVE_DOUBLE);
  insert(type, "severity", HOFFSET(EventRow, severity), H5T_NATIVE_UINT8);
  insert(type, "code", HOFFSET(EventRow, code), H5T_NATIVE_UINT16);
  insert(type, "code_name", HOFFSET(EventRow, code_name), text_type(sizeof(EventRow::code_name)).id());
  insert(type, "step", HOFFSET(EventRow, step), H5T_NATIVE_INT64);
  insert(type, "model_time_s", HOFFSET(EventRow, model_time_s), H5T_NATIVE_DOUBLE);
  insert(type, "source", HOFFSET(EventRow, source), text_type(sizeof(EventRow::source)).id());
  insert(type, "incarnation", HOFFSET(EventRow, incarnation), H5T_NATIVE_UINT64);
  insert(type, "subject", HOFFSET(EventRow, subject), text_type(sizeof(EventRow::subject)).id());
  insert(type, "value_1", HOFFSET(EventRow, value_1), H5T_NATIVE_DOUBLE);
  insert(type, "value_2", HOFFSET(EventRow, value_2), H5T_NATIVE_DOUBLE);
  insert(type, "text", HOFFSET(EventRow, text), text_type(sizeof(EventRow::text)).id());
  return type;
}

Handle counter_type() {
  Handle type = compound(sizeof(CounterRow));
  insert(type, "table", HOFFSET(CounterRow, table), text_type(sizeof(CounterRow::table)).id());
  insert(type, "rows", HOFFSET(CounterRow, rows), H5T_NATIVE_UINT64);
  insert(type, "dropped_rows", HOFFSET(CounterRow, dropped_rows), H5T_NATIVE_UINT64);
  return type;
}

Handle state_type() {
  Handle type = compound(sizeof(StateRow));
  insert(type, "flushes", HOFFSET(StateRow, flushes), H5T_NATIVE_UINT64);
  insert(type, "closed_cleanly", HOFFSET(StateRow, closed_cleanly), H5T_NATIVE_UINT8);
  insert(type, "write_failed", HOFFSET(StateRow, write_failed), H5T_NATIVE_UINT8);
  return type;
}

Handle row_type(const std::vector<Column>& columns) {
  Handle type = compound(columns.size() * sizeof(double));
  for (std::size_t i = 0; i < columns.size(); ++i) {
    insert(type, columns[i].name.c_str(), i * sizeof(double), H5T_NATIVE_DOUBLE);
  }
  return type;
}

void write_attribute(hid_t object, const char* name, const std::string& value) {
  const Handle type = text_type(std::max<std::size_t>(value.size(), 1));
  const Handle space{checked(H5Screate(H5S_SCALAR), "describing an attribute"), H5Sclose};
  const Handle attribute{checked(H5Acreate2(object, name, type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT),
                                 std::string{"creating "} + name),
                         H5Aclose};
  // An empty text still has one byte, which c_str() ends with.
  check(H5Awrite(attribute.id(), type.id(), value.c_str()), std::string{"writing "} + name);
}

void write_attribute(hid_t object, const char* name, const std::vector<std::string>& values) {
  if (values.empty()) return;
  std::size_t size = 1;
  for (const std::string& value : values) size = std::max(size, value.size());
  std::vector<char> bytes(size * values.size(), '\0');
  for (std::size_t i = 0; i < values.size(); ++i)
    std::copy(values[i].begin(), values[i].end(), bytes.data() + i * size);
  const Handle type = text_type(size);
  const Handle space = list_space(values.size());
  const Handle attribute{checked(H5Acreate2(object, name, type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT),
                                 std::string{"creating "} + name),
                         H5Aclose};
  check(H5Awrite(attribute.id(), type.id(), bytes.data()), std::string{"writing "} + name);
}

void write_attribute(hid_t object, const char* name, double value) {
  const Handle space{checked(H5Screate(H5S_SCALAR), "describing an attribute"), H5Sclose};
  const Handle attribute{checked(H5Acreate2(object, name, H5T_IEEE_F64LE, space.id(), H5P_DEFAULT, H5P_DEFAULT),
                                 std::string{"creating "} + name),
                         H5Aclose};
  check(H5Awrite(attribute.id(), H5T_NATIVE_DOUBLE, &value), std::string{"writing "} + name);
}

std::vector<std::string> read_list_attribute(hid_t object, const char* name) {
  if (H5Aexists(object, name) == 0) return {};
  const Handle attribute{checked(H5Aopen(object, name, H5P_DEFAULT), std::string{"opening attribute "} + name),
                         H5Aclose};
  const Handle type{checked(H5Aget_type(attribute.id()), std::string{"reading attribute "} + name), H5Tclose};
  const Handle space{checked(H5Aget_space(attribute.id()), std::string{"reading attribute "} + name), H5Sclose};
  const hssize_t count = H5Sget_simple_extent_npoints(space.id());
  if (count <= 0) return {};
  if (H5Tget_class(type.id()) != H5T_STRING || H5Tis_variable_str(type.id()) != 0) {
    throw RecordingError{std::string{"attribute "} + name + " is not text of fixed size"};
  }
  const std::size_t size = H5Tget_size(type.id());
  std::vector<char> bytes(size * static_cast<std::size_t>(count));
  check(H5Aread(attribute.id(), type.id(), bytes.data()), std::string{"reading attribute "} + name);
  std::vector<std::string> values;
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    const auto first = bytes.begin() + static_cast<std::ptrdiff_t>(i * size);
    values.emplace_back(first, std::find(first, first + static_cast<std::ptrdiff_t>(size), '\0'));
  }
  return values;
}

std::string read_text_attribute(hid_t object, const char* name) {
  const std::vector<std::string> values = read_list_attribute(object, name);
  return values.empty() ? std::string{} : values.front();
}

double read_number_attribute(hid_t object, const char* name) {
  if (H5Aexists(object, name) <= 0) return 0.0;
  const Handle attribute{checked(H5Aopen(object, name, H5P_DEFAULT), std::string{"opening attribute "} + name),
                         H5Aclose};
  const Handle space{checked(H5Aget_space(attribute.id()), std::string{"reading attribute "} + name), H5Sclose};
  if (H5Sget_simple_extent_npoints(space.id()) != 1) {
    throw RecordingError{std::string{"attribute "} + name + " is not one number"};
  }
  double value = 0.0;
  check(H5Aread(attribute.id(), H5T_NATIVE_DOUBLE, &value), std::string{"reading attribute "} + name);
  return value;
}

void write_columns(hid_t table, const std::vector<Column>& columns) {
  std::vector<std::string> names;
  std::vector<std::string> units;
  for (const Column& column : columns) {
    names.push_back(column.name);
    units.push_back(column.unit);
  }
  write_attribute(table, kColumnNamesName, names);
  write_attribute(table, kUnitsName, units);
}

std::vector<Column> event_columns() {
  return columns_of(event_type(), {"s", "", "", "", "", "s", "", "", "", "", "", ""});
}

std::vector<Column> counter_columns() { return columns_of(counter_type(), {"", "", ""}); }

std::vector<Column> state_columns() { return columns_of(state_type(), {"", "", ""}); }

void write_note(hid_t table, const TableNote& note) {
  write_attribute(table, "description", note.description);
  if (note.sample_interval_s <= 0.0) return;
  write_attribute(table, "time_column", note.time_column);
  write_attribute(table, "sample_interval_s", note.sample_interval_s);
  write_attribute(table, "sample_rate_hz", 1.0 / note.sample_interval_s);
}

TableNote read_note(hid_t table, const std::string& name) {
  return {name, read_text_attribute(table, "description"), read_text_attribute(table, "time_column"),
          read_number_attribute(table, "sample_interval_s")};
}

void write_header(hid_t file, const RunFileHeader& header) {
  write_attribute(file, "schema", std::string{kRunFileSchema});
  write_attribute(file, "participant", header.participant);
  write_attribute(file, "role", std::string{name(header.role)});
  write_attribute(file, "test_name", header.test_name);
  write_attribute(file, "scenario_digest", hex(header.scenario_digest));
  // As text: MATLAB's doubles would round a 64-bit number.
  write_attribute(file, "incarnation", std::to_string(header.incarnation));
  write_attribute(file, "start_time_utc", header.start_time_utc);
  write_attribute(file, "software_version", header.software_version);
  write_attribute(file, "substructure_ids", header.substructure_ids);
  write_attribute(file, "structure_dofs", header.structure_dofs);
  write_attribute(file, "interface_dofs", header.interface_dofs);
  write_attribute(file, "t0_utc", header.t0_utc);
  write_attribute(file, "t0_unix_s", header.t0_unix_s);
  write_attribute(file, "model_time_step_s", header.model_time_step_s);
}

RunFileHeader read_header(hid_t file) {
  const std::string schema = read_text_attribute(file, "schema");
  if (schema != kRunFileSchema) {
    throw RecordingError{"schema is '" + schema + "', expected '" + std::string{kRunFileSchema} + "'"};
  }
  RunFileHeader header;
  header.participant = read_text_attribute(file, "participant");
  header.role = role_from_name(read_text_attribute(file, "role"));
  header.test_name = read_text_attribute(file, "test_name");
  header.scenario_digest = digest_from_hex(read_text_attribute(file, "scenario_digest"));
  const std::string incarnation = read_text_attribute(file, "incarnation");
  (void)std::from_chars(incarnation.data(), incarnation.data() + incarnation.size(), header.incarnation);
  header.start_time_utc = read_text_attribute(file, "start_time_utc");
  header.software_version = read_text_attribute(file, "software_version");
  header.substructure_ids = read_list_attribute(file, "substructure_ids");
  header.structure_dofs = read_list_attribute(file, "structure_dofs");
  header.interface_dofs = read_list_attribute(file, "interface_dofs");
  header.t0_utc = read_text_attribute(file, "t0_utc");
  header.t0_unix_s = read_number_attribute(file, "t0_unix_s");
  header.model_time_step_s = read_number_attribute(file, "model_time_step_s");
  return header;
}

RunFileCounters read_counters(hid_t file) {
  const Handle counters{checked(H5Dopen2(file, kCountersName, H5P_DEFAULT), "opening counters"), H5Dclose};
  const Handle space{checked(H5Dget_space(counters.id()), "opening counters"), H5Sclose};
  const hssize_t count = H5Sget_simple_extent_npoints(space.id());
  if (count < 0) throw RecordingError{"counters have no size"};
  std::vector<CounterRow> rows(static_cast<std::size_t>(count));
  check(H5Dread(counters.id(), counter_type().id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, rows.data()), "reading counters");
  const Handle state_set{checked(H5Dopen2(file, kStateName, H5P_DEFAULT), "opening state"), H5Dclose};
  StateRow state{};
  check(H5Dread(state_set.id(), state_type().id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, &state), "reading state");

  RunFileCounters result;
  for (const CounterRow& row : rows) {
    result.tables.push_back({std::string{get(row.table)}, row.rows, row.dropped_rows});
  }
  result.flushes = state.flushes;
  result.closed_cleanly = state.closed_cleanly != 0;
  result.write_failed = state.write_failed != 0;
  return result;
}

}  // namespace hybridtest::hdf5
