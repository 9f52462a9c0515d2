#include <algorithm>

#include "recording/error.hpp"
#include "recording/hdf5/layout.hpp"
#include "recording/run_file_reader.hpp"

namespace hybridtest {
namespace {

using hdf5::check;
using hdf5::checked;
using hdf5::Handle;

/// The two properties by which HDF5's own tool h5clear gets into a file whose writer died. They
/// are set by name through the public H5Pset(), but their names are the library's own affair.
constexpr const char* kClearStatusFlags = "clear_status_flags";
constexpr const char* kSkipEndCheck = "skip_eof_check";

bool opens_normally(const std::filesystem::path& path) {
  return Handle{H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose}.valid();
}

Handle open_for_repair(const std::filesystem::path& path) {
  const Handle access{checked(H5Pcreate(H5P_FILE_ACCESS), "preparing the repair"), H5Pclose};
  const hbool_t yes = true;
  check(H5Pset_libver_bounds(access.id(), H5F_LIBVER_LATEST, H5F_LIBVER_LATEST), "preparing the repair");
  check(H5Pset(access.id(), kClearStatusFlags, &yes), "preparing the repair");
  check(H5Pset(access.id(), kSkipEndCheck, &yes), "preparing the repair");
  return {checked(H5Fopen(path.c_str(), H5F_ACC_RDWR, access.id()), "opening for repair"), H5Fclose};
}

void cut_to(hid_t file, const TableCounter& counter) {
  const Handle dataset{checked(H5Dopen2(file, counter.table.c_str(), H5P_DEFAULT), "opening table " + counter.table),
                       H5Dclose};
  const Handle space{checked(H5Dget_space(dataset.id()), "measuring table " + counter.table), H5Sclose};
  const hssize_t extent = H5Sget_simple_extent_npoints(space.id());
  const hsize_t rows = counter.rows;
  if (extent >= 0 && static_cast<hsize_t>(extent) > rows) {
    check(H5Dset_extent(dataset.id(), &rows), "cutting table " + counter.table);
  }
}

void repair_open(const std::filesystem::path& path) {
  Handle file = open_for_repair(path);
  // The size noted in the file may be older or newer than what the dead process wrote.
  check(H5Fincrement_filesize(file.id(), 0), "setting the file's size");
  (void)hdf5::read_header(file.id());
  for (const TableCounter& counter : hdf5::read_counters(file.id()).tables) cut_to(file.id(), counter);
  if (!file.reset()) throw RecordingError{"closing: " + hdf5::last_error()};
}

}  // namespace

bool repair(const std::filesystem::path& path) {
  const auto lock = hdf5::lock_library();
  try {
    if (opens_normally(path)) return false;
    repair_open(path);
    return true;
  } catch (const RecordingError& error) {
    throw RecordingError{path.string() + ": " + error.what()};
  }
}

}  // namespace hybridtest
