#include "recording/run_file_writer.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <set>

#include "core/assert.hpp"
#include "recording/error.hpp"
#include "recording/hdf5/layout.hpp"

namespace hybridtest {
namespace {

using hdf5::check;
using hdf5::checked;
using hdf5::Handle;

/// A chunk is rewritten as a whole at every flush until it is full, so it should be no larger
/// than a few flushes' worth of rows.
constexpr std::size_t kChunkBytes = 32768;

/// A file descriptor of our own on the run file.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int descriptor) noexcept : descriptor_{descriptor} {}
  Descriptor(Descriptor&& other) noexcept : descriptor_{std::exchange(other.descriptor_, -1)} {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    return *this;
  }
  ~Descriptor() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  [[nodiscard]] int get() const noexcept { return descriptor_; }

 private:
  int descriptor_ = -1;
};

void require_usable(const std::vector<TableLayout>& tables) {
  std::set<std::string> names{hdf5::kEventsName, hdf5::kCountersName, hdf5::kStateName};
  for (const TableLayout& table : tables) {
    if (table.name.empty() || table.name.size() >= sizeof(hdf5::CounterRow::table) ||
        table.name.find('/') != std::string::npos || !names.insert(table.name).second) {
      throw RecordingError{"table name '" + table.name + "' is empty, too long, has a slash, or is taken"};
    }
    std::set<std::string> columns;
    for (const Column& column : table.columns) {
      if (column.name.empty() || !columns.insert(column.name).second) {
        throw RecordingError{"table '" + table.name + "': column name '" + column.name + "' is empty or taken"};
      }
    }
    if (columns.empty()) throw RecordingError{"table '" + table.name + "' has no columns"};
  }
}

/// An extensible dataset and how much of it is filled.
struct Dataset {
  Handle type;
  Handle id;
  std::size_t row_bytes = 0;
  hsize_t rows = 0;

  void append(const void* bytes, hsize_t count) {
    const hsize_t end = rows + count;
    check(H5Dset_extent(id.id(), &end), "extending a table");
    const Handle file_space{checked(H5Dget_space(id.id()), "extending a table"), H5Sclose};
    const Handle memory_space{checked(H5Screate_simple(1, &count, nullptr), "extending a table"), H5Sclose};
    check(H5Sselect_hyperslab(file_space.id(), H5S_SELECT_SET, &rows, nullptr, &count, nullptr), "extending a table");
    check(H5Dwrite(id.id(), type.id(), memory_space.id(), file_space.id(), H5P_DEFAULT, bytes), "writing rows");
    rows = end;
  }
};

Dataset create_extensible(hid_t file, const std::string& name, Handle type) {
  Dataset dataset;
  dataset.row_bytes = H5Tget_size(type.id());
  const hsize_t none = 0;
  const hsize_t unlimited = H5S_UNLIMITED;
  const hsize_t chunk = std::max<hsize_t>(1, kChunkBytes / dataset.row_bytes);
  const Handle space{checked(H5Screate_simple(1, &none, &unlimited), "creating " + name), H5Sclose};
  const Handle properties{checked(H5Pcreate(H5P_DATASET_CREATE), "creating " + name), H5Pclose};
  check(H5Pset_chunk(properties.id(), 1, &chunk), "creating " + name);
  dataset.id =
      Handle{checked(H5Dcreate2(file, name.c_str(), type.id(), space.id(), H5P_DEFAULT, properties.id(), H5P_DEFAULT),
                     "creating " + name),
             H5Dclose};
  dataset.type = std::move(type);
  return dataset;
}

/// A dataset whose bytes stand at a fixed place of the file, so that updating it needs no space.
struct FixedDataset {
  Handle type;
  Handle id;

  void write(const void* bytes) {
    check(H5Dwrite(id.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes), "writing counters");
    check(H5Dflush(id.id()), "writing counters");
  }
};

FixedDataset create_fixed(hid_t file, const char* name, Handle type, hsize_t count, const void* bytes) {
  const Handle space{checked(H5Screate_simple(1, &count, nullptr), std::string{"creating "} + name), H5Sclose};
  const Handle properties{checked(H5Pcreate(H5P_DATASET_CREATE), "creating counters"), H5Pclose};
  check(H5Pset_layout(properties.id(), H5D_CONTIGUOUS), "creating counters");
  check(H5Pset_alloc_time(properties.id(), H5D_ALLOC_TIME_EARLY), "creating counters");
  FixedDataset dataset;
  dataset.id = Handle{checked(H5Dcreate2(file, name, type.id(), space.id(), H5P_DEFAULT, properties.id(), H5P_DEFAULT),
                              "creating counters"),
                      H5Dclose};
  dataset.type = std::move(type);
  dataset.write(bytes);
  return dataset;
}

off_t place_of(const FixedDataset& dataset) {
  const haddr_t address = H5Dget_offset(dataset.id.id());
  if (address == HADDR_UNDEF) throw RecordingError{"creating counters: no place in the file"};
  return static_cast<off_t>(address);
}

/// HDF5 would truncate a file before it notices that another process is writing it.
void require_unused(const std::filesystem::path& path) {
  const Descriptor existing{::open(path.c_str(), O_RDWR | O_CLOEXEC)};
  if (existing.get() >= 0 && ::flock(existing.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    throw RecordingError{"another process is writing this file; write into another run directory"};
  }
}

/// The name of a file whose head is not written yet. A process that is killed in this time leaves no run file.
std::filesystem::path unfinished(const std::filesystem::path& path) {
  return path.parent_path() / ("." + path.filename().string() + ".unfinished");
}

Handle create_file(const std::filesystem::path& path) {
  require_unused(path);
  const Handle access{checked(H5Pcreate(H5P_FILE_ACCESS), "creating the file"), H5Pclose};
  check(H5Pset_libver_bounds(access.id(), H5F_LIBVER_LATEST, H5F_LIBVER_LATEST), "creating the file");
  return {checked(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.id()), "creating the file"), H5Fclose};
}

}  // namespace

struct RunFileWriter::Impl {
  std::filesystem::path path;
  std::vector<TableLayout> layouts;
  Handle file;
  std::vector<Dataset> tables;  // in the order of `layouts`, then the events
  FixedDataset counters;
  FixedDataset state;
  std::vector<hdf5::CounterRow> counter_rows;  // as last written, but for dropped_rows
  hdf5::StateRow state_row{};
  off_t counters_offset = 0;  // bytes from the start of the file
  off_t state_offset = 0;
  Descriptor own;
  bool failed = false;
  bool closed = false;

  void create(const RunFileHeader& header);
  void write_counters();
  void require_open() const;
  void flush();
  void fail() noexcept;
  void patch_counters() noexcept;
  void release() noexcept;

  /// Runs `work`; when it throws, gives the file up and passes the error on.
  template <class Work>
  void guarded(Work&& work) {
    const auto lock = hdf5::lock_library();
    require_open();
    try {
      work();
    } catch (const RecordingError& error) {
      fail();
      throw RecordingError{path.string() + ": " + error.what()};
    }
  }
};

void RunFileWriter::Impl::create(const RunFileHeader& header) {
  require_usable(layouts);
  require_unused(path);
  file = create_file(unfinished(path));
  hdf5::write_header(file.id(), header);
  for (const TableLayout& layout : layouts) {
    tables.push_back(create_extensible(file.id(), layout.name, hdf5::row_type(layout.columns)));
    hdf5::write_columns(tables.back().id.id(), layout.columns);
    const auto note = std::ranges::find(header.table_notes, layout.name, &TableNote::table);
    if (note != header.table_notes.end()) hdf5::write_note(tables.back().id.id(), *note);
  }
  tables.push_back(create_extensible(file.id(), hdf5::kEventsName, hdf5::event_type()));
  hdf5::write_columns(tables.back().id.id(), hdf5::event_columns());
  hdf5::write_attribute(tables.back().id.id(), "description",
                        "What happened, in this participant and heard from others; time_s is the clock of the sender.");

  for (std::size_t i = 0; i < tables.size(); ++i) {
    hdf5::CounterRow row{};
    const std::string name = i < layouts.size() ? layouts[i].name : hdf5::kEventsName;
    std::copy(name.begin(), name.end(), row.table.begin());
    counter_rows.push_back(row);
  }
  counters =
      create_fixed(file.id(), hdf5::kCountersName, hdf5::counter_type(), counter_rows.size(), counter_rows.data());
  hdf5::write_columns(counters.id.id(), hdf5::counter_columns());
  hdf5::write_attribute(counters.id.id(), "description",
                        "Rows that are safe in each table, and rows that were lost before they were written.");
  state = create_fixed(file.id(), hdf5::kStateName, hdf5::state_type(), 1, &state_row);
  hdf5::write_columns(state.id.id(), hdf5::state_columns());
  hdf5::write_attribute(state.id.id(), "description", "Whether the file is complete.");
  counters_offset = place_of(counters);
  state_offset = place_of(state);
  check(H5Fstart_swmr_write(file.id()), "starting to write for concurrent readers");

  // HDF5 gives up its lock on the file when SWMR writing starts. A shared lock of our own lets
  // readers in and keeps repair(), which wants an exclusive one, away from a file in use.
  own = Descriptor{::open(unfinished(path).c_str(), O_RDWR | O_CLOEXEC)};
  if (own.get() < 0) throw RecordingError{std::string{"opening the file again: "} + std::strerror(errno)};
  if (::flock(own.get(), LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    throw RecordingError{"another process uses this file; write into another run directory"};
  }
  if (::rename(unfinished(path).c_str(), path.c_str()) != 0) {
    throw RecordingError{std::string{"giving the file its name: "} + std::strerror(errno)};
  }
}

void RunFileWriter::Impl::require_open() const {
  if (failed) throw RecordingError{path.string() + ": an earlier write failed"};
  HYBRIDTEST_ASSERT(!closed);
}

void RunFileWriter::Impl::write_counters() {
  ++state_row.flushes;
  for (std::size_t i = 0; i < tables.size(); ++i) counter_rows[i].rows = tables[i].rows;
  counters.write(counter_rows.data());
  state.write(&state_row);
}

void RunFileWriter::Impl::flush() {
  // First the rows, then the count of them: a counted row is in the file.
  check(H5Fflush(file.id(), H5F_SCOPE_LOCAL), "flushing");
  write_counters();
}

/// Leaves the file as it is now. HDF5 still holds bytes that could not be written. Closing its handles would
/// write some of them and fail on the rest, so its descriptor is first redirected to /dev/null.
void RunFileWriter::Impl::fail() noexcept {
  failed = true;
  void* hdf5_descriptor = nullptr;
  if (file.valid() && H5Fget_vfd_handle(file.id(), H5P_DEFAULT, &hdf5_descriptor) >= 0) {
    const Descriptor nothing{::open("/dev/null", O_RDWR | O_CLOEXEC)};
    if (nothing.get() >= 0) (void)::dup2(nothing.get(), *static_cast<const int*>(hdf5_descriptor));
  }
  state_row.write_failed = 1;
  state_row.closed_cleanly = 0;
  patch_counters();
  release();
}

/// Overwrites existing bytes of the file, which also works on a full disk. An error cannot be
/// reported and is ignored.
void RunFileWriter::Impl::patch_counters() noexcept {
  if (own.get() < 0 || counters_offset == 0 || state_offset == 0) return;
  const auto size = counter_rows.size() * sizeof(hdf5::CounterRow);
  (void)!::pwrite(own.get(), counter_rows.data(), size, counters_offset);
  (void)!::pwrite(own.get(), &state_row, sizeof state_row, state_offset);
}

void RunFileWriter::Impl::release() noexcept {
  tables.clear();
  counters = {};
  state = {};
  (void)file.reset();
}

RunFileWriter::RunFileWriter(const std::filesystem::path& path, const RunFileHeader& header,
                             std::vector<TableLayout> tables)
    : impl_{std::make_unique<Impl>()} {
  const auto lock = hdf5::lock_library();
  impl_->path = path;
  impl_->layouts = std::move(tables);
  try {
    impl_->create(header);
  } catch (const RecordingError& error) {
    const bool is_ours = impl_->file.valid();
    impl_->fail();
    std::error_code ignored;
    if (is_ours) std::filesystem::remove(unfinished(path), ignored);
    throw RecordingError{path.string() + ": " + error.what()};
  }
}

RunFileWriter::~RunFileWriter() {
  try {
    if (!impl_->failed && !impl_->closed) close();
  } catch (const RecordingError&) {
    // The error is noted in the file; a destructor cannot report it.
  }
  const auto lock = hdf5::lock_library();
  impl_.reset();
}

void RunFileWriter::append(std::size_t table, std::span<const double> rows) {
  HYBRIDTEST_ASSERT(table < impl_->layouts.size());
  const std::size_t width = impl_->layouts[table].columns.size();
  HYBRIDTEST_ASSERT(rows.size() % width == 0);
  if (rows.empty()) return;
  impl_->guarded([&] { impl_->tables[table].append(rows.data(), rows.size() / width); });
}

void RunFileWriter::append_events(std::span<const Event> events, std::span<const std::string> texts) {
  HYBRIDTEST_ASSERT(events.size() == texts.size());
  if (events.empty()) return;
  std::vector<hdf5::EventRow> rows;
  for (std::size_t i = 0; i < events.size(); ++i) rows.push_back(hdf5::to_row(events[i], texts[i]));
  impl_->guarded([&] { impl_->tables.back().append(rows.data(), rows.size()); });
}

void RunFileWriter::set_dropped(std::size_t table, std::uint64_t rows) noexcept {
  HYBRIDTEST_ASSERT(table < impl_->counter_rows.size());
  if (impl_->counter_rows[table].dropped_rows == rows) return;
  impl_->counter_rows[table].dropped_rows = rows;
  if (impl_->failed) impl_->patch_counters();
}

void RunFileWriter::flush() {
  impl_->guarded([&] { impl_->flush(); });
}

void RunFileWriter::close() {
  impl_->guarded([&] {
    impl_->state_row.closed_cleanly = 1;
    impl_->flush();
    for (Dataset& table : impl_->tables) {
      if (!table.id.reset()) throw RecordingError{"closing a table: " + hdf5::last_error()};
    }
    impl_->counters = {};
    impl_->state = {};
    // Give up the shared lock last: until then nobody may repair the file.
    if (!impl_->file.reset()) throw RecordingError{"closing: " + hdf5::last_error()};
    impl_->closed = true;
    impl_->own = Descriptor{};
  });
}

bool RunFileWriter::failed() const noexcept { return impl_->failed; }

std::uint64_t RunFileWriter::rows_flushed(std::size_t table) const noexcept {
  HYBRIDTEST_ASSERT(table < impl_->counter_rows.size());
  return impl_->counter_rows[table].rows;
}

}  // namespace hybridtest
