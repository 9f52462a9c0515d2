#include "recording/run_file_reader.hpp"

#include <algorithm>

#include "core/input_file.hpp"
#include "recording/error.hpp"
#include "recording/hdf5/layout.hpp"

namespace hybridtest {
namespace {

using hdf5::check;
using hdf5::checked;
using hdf5::Handle;

/// Rows in memory at once while a column is read.
constexpr std::size_t kBlockRows = 4096;

Handle open_file(const std::filesystem::path& path) {
  if (const auto why = why_unreadable(path)) throw RecordingError{"opening: " + *why};
  // SWMR reading opens files in order as well, and is the only way into one still marked as
  // being written.
  return {checked(H5Fopen(path.c_str(), H5F_ACC_RDONLY | H5F_ACC_SWMR_READ, H5P_DEFAULT), "opening"), H5Fclose};
}

Handle open_table(const Handle& file, const std::string& table) {
  return {checked(H5Dopen2(file.id(), table.c_str(), H5P_DEFAULT), "opening table " + table), H5Dclose};
}

std::vector<Column> columns_of(const Handle& dataset) {
  const Handle type{checked(H5Dget_type(dataset.id()), "reading columns"), H5Tclose};
  const int count = H5Tget_nmembers(type.id());
  const std::vector<std::string> units = hdf5::read_list_attribute(dataset.id(), hdf5::kUnitsName);
  std::vector<Column> columns;
  for (int i = 0; i < count; ++i) {
    char* name = H5Tget_member_name(type.id(), static_cast<unsigned>(i));
    if (name == nullptr) throw RecordingError{"reading columns: " + hdf5::last_error()};
    const auto position = static_cast<std::size_t>(i);
    columns.push_back({name, position < units.size() ? units[position] : std::string{}});
    (void)H5free_memory(name);
  }
  return columns;
}

std::size_t extent_of(const Handle& dataset) {
  const Handle space{checked(H5Dget_space(dataset.id()), "reading the size of a table"), H5Sclose};
  const hssize_t count = H5Sget_simple_extent_npoints(space.id());
  return count < 0 ? 0 : static_cast<std::size_t>(count);
}

void read_slab(const Handle& dataset, const Handle& type, std::size_t first, std::size_t count, void* target) {
  if (count == 0) return;
  const hsize_t start = first;
  const hsize_t length = count;
  const Handle file_space{checked(H5Dget_space(dataset.id()), "reading"), H5Sclose};
  const Handle memory_space{checked(H5Screate_simple(1, &length, nullptr), "reading"), H5Sclose};
  check(H5Sselect_hyperslab(file_space.id(), H5S_SELECT_SET, &start, nullptr, &length, nullptr), "reading");
  check(H5Dread(dataset.id(), type.id(), memory_space.id(), file_space.id(), H5P_DEFAULT, target), "reading");
}

template <class Work>
auto with_path(const std::filesystem::path& path, Work&& work) {
  const auto lock = hdf5::lock_library();
  try {
    return work();
  } catch (const RecordingError& error) {
    throw RecordingError{path.string() + ": " + error.what()};
  }
}

}  // namespace

struct RunFileReader::Impl {
  std::filesystem::path path;
  Handle file;
  RunFileHeader header;
  RunFileCounters counters;
  std::vector<TableLayout> tables;
  std::vector<std::size_t> row_counts;  // of `tables`
  std::size_t event_count = 0;

  void open();
  [[nodiscard]] std::size_t position(std::string_view table) const;
};

void RunFileReader::Impl::open() {
  (void)file.reset();
  tables.clear();
  row_counts.clear();
  event_count = 0;
  file = open_file(path);
  header = hdf5::read_header(file.id());
  counters = hdf5::read_counters(file.id());
  for (const TableCounter& counter : counters.tables) {
    const Handle dataset = open_table(file, counter.table);
    // Rows beyond the counted ones may not be completely there.
    const std::size_t rows = std::min(extent_of(dataset), static_cast<std::size_t>(counter.rows));
    if (counter.table == hdf5::kEventsName) {
      event_count = rows;
    } else {
      tables.push_back({counter.table, columns_of(dataset)});
      TableNote note = hdf5::read_note(dataset.id(), counter.table);
      if (!note.description.empty()) header.table_notes.push_back(std::move(note));
      row_counts.push_back(rows);
    }
  }
}

std::size_t RunFileReader::Impl::position(std::string_view table) const {
  const auto found =
      std::find_if(tables.begin(), tables.end(), [&](const auto& layout) { return layout.name == table; });
  return static_cast<std::size_t>(found - tables.begin());
}

RunFileReader::RunFileReader(const std::filesystem::path& path) : impl_{std::make_unique<Impl>()} {
  impl_->path = path;
  refresh();
}

RunFileReader::~RunFileReader() {
  const auto lock = hdf5::lock_library();
  impl_.reset();
}
RunFileReader::RunFileReader(RunFileReader&&) noexcept = default;
RunFileReader& RunFileReader::operator=(RunFileReader&& other) noexcept {
  std::swap(impl_, other.impl_);
  return *this;
}

const std::filesystem::path& RunFileReader::path() const noexcept { return impl_->path; }
const RunFileHeader& RunFileReader::header() const noexcept { return impl_->header; }
const RunFileCounters& RunFileReader::counters() const noexcept { return impl_->counters; }
const std::vector<TableLayout>& RunFileReader::tables() const noexcept { return impl_->tables; }

bool RunFileReader::has_table(std::string_view table) const noexcept {
  return impl_->position(table) < impl_->tables.size();
}

bool RunFileReader::has_column(std::string_view table, std::string_view column) const noexcept {
  return has_table(table) && impl_->tables[impl_->position(table)].position(column).has_value();
}

std::size_t RunFileReader::row_count(std::string_view table) const noexcept {
  return has_table(table) ? impl_->row_counts[impl_->position(table)] : 0;
}

std::vector<double> RunFileReader::column(std::string_view table, std::string_view column) const {
  if (!has_column(table, column)) {
    throw RecordingError{impl_->path.string() + ": no column '" + std::string{column} + "' in a table '" +
                         std::string{table} + "'"};
  }
  return with_path(impl_->path, [&] {
    // Whole rows in blocks, of which one value each is kept: they come as they are in the file, while HDF5 converts the
    // values of a single column one by one, which takes three times as long.
    const TableLayout& layout = impl_->tables[impl_->position(table)];
    const std::vector<Column>& columns = layout.columns;
    const std::size_t at = *layout.position(column);
    const Handle dataset = open_table(impl_->file, std::string{table});
    const Handle type = hdf5::row_type(columns);
    const std::size_t count = row_count(table);
    std::vector<double> block(std::min(count, kBlockRows) * columns.size());
    std::vector<double> values;
    values.reserve(count);
    for (std::size_t first = 0; first < count; first += kBlockRows) {
      const std::size_t rows = std::min(kBlockRows, count - first);
      read_slab(dataset, type, first, rows, block.data());
      for (std::size_t row = 0; row < rows; ++row) values.push_back(block[row * columns.size() + at]);
    }
    return values;
  });
}

std::vector<double> RunFileReader::rows(std::string_view table, std::size_t first, std::size_t count) const {
  if (!has_table(table)) {
    throw RecordingError{impl_->path.string() + ": no table '" + std::string{table} + "'"};
  }
  return with_path(impl_->path, [&] {
    const TableLayout& layout = impl_->tables[impl_->position(table)];
    const std::size_t available = row_count(table) - std::min(first, row_count(table));
    std::vector<double> values(std::min(count, available) * layout.columns.size());
    read_slab(open_table(impl_->file, layout.name), hdf5::row_type(layout.columns), first, std::min(count, available),
              values.data());
    return values;
  });
}

std::vector<RecordedEvent> RunFileReader::events() const {
  return with_path(impl_->path, [&] {
    std::vector<hdf5::EventRow> rows(impl_->event_count);
    read_slab(open_table(impl_->file, hdf5::kEventsName), hdf5::event_type(), 0, rows.size(), rows.data());
    std::vector<RecordedEvent> events;
    for (const hdf5::EventRow& row : rows) events.push_back(hdf5::from_row(row));
    return events;
  });
}

void RunFileReader::refresh() {
  with_path(impl_->path, [&] { impl_->open(); });
}

}  // namespace hybridtest
