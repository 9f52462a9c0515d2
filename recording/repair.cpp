#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "core/input_file.hpp"
#include "recording/error.hpp"
#include "recording/hdf5/layout.hpp"
#include "recording/run_file_reader.hpp"

namespace hybridtest {
namespace {

using hdf5::check;
using hdf5::checked;
using hdf5::Handle;

/// The two properties with which h5clear, a tool of HDF5, opens the file of a killed writer. They are
/// set by name through the public H5Pset(), but HDF5 does not document the names.
constexpr const char* kClearStatusFlags = "clear_status_flags";
constexpr const char* kSkipEndCheck = "skip_eof_check";

bool opens_normally(const std::filesystem::path& path) {
  return Handle{H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose}.valid();
}

/// Extends the file to the size that is noted in it, as HDF5 does when it closes it. Without space on the disk
/// HDF5 would abort the process at its end.
void fill_up(const std::filesystem::path& path) {
  hsize_t noted = 0;
  {
    const Handle file{H5Fopen(path.c_str(), H5F_ACC_RDONLY | H5F_ACC_SWMR_READ, H5P_DEFAULT), H5Fclose};
    if (!file.valid() || H5Fget_filesize(file.id(), &noted) < 0) return;  // opening for repair says why
  }
  const int descriptor = ::open(path.c_str(), O_RDWR | O_CLOEXEC);
  if (descriptor < 0) return;
  // Only under a lock: a file that another process is writing must not be changed.
  const bool is_ours = ::flock(descriptor, LOCK_EX | LOCK_NB) == 0;
  const off_t size = ::lseek(descriptor, 0, SEEK_END);
  const bool is_short = is_ours && size >= 0 && static_cast<hsize_t>(size) < noted;
  const int error = is_short && ::ftruncate(descriptor, static_cast<off_t>(noted)) != 0 ? errno : 0;
  ::close(descriptor);
  if (error != 0)
    throw RecordingError{std::string{"not enough space on the disk to repair it: "} + std::strerror(error)};
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
  // The size noted in the file may be older or newer than the data of the killed process.
  check(H5Fincrement_filesize(file.id(), 0), "setting the file's size");
  (void)hdf5::read_header(file.id());
  for (const TableCounter& counter : hdf5::read_counters(file.id()).tables) cut_to(file.id(), counter);
  if (!file.reset()) throw RecordingError{"closing: " + hdf5::last_error()};
}

}  // namespace

bool repair(const std::filesystem::path& path) {
  const auto lock = hdf5::lock_library();
  try {
    if (const auto why = why_unreadable(path)) throw RecordingError{"opening: " + *why};
    if (opens_normally(path)) return false;
    fill_up(path);
    repair_open(path);
    return true;
  } catch (const RecordingError& error) {
    throw RecordingError{path.string() + ": " + error.what()};
  }
}

}  // namespace hybridtest
