#pragma once

#include <hdf5.h>

#include <mutex>
#include <string>
#include <utility>

/// Shared by all callers of the HDF5 C library in this folder. Only sources include this.
namespace hybridtest::hdf5 {

/// Debian's serial HDF5 is not thread-safe: every function of this folder that calls it holds
/// this lock during the call. It also keeps the library from printing its error stack.
[[nodiscard]] std::unique_lock<std::recursive_mutex> lock_library();

/// The reasons in the error stack of the library, innermost first.
[[nodiscard]] std::string last_error();

/// Owns one HDF5 identifier.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);

  Handle() = default;
  Handle(hid_t id, Close close) noexcept : id_{id}, close_{close} {}
  Handle(Handle&& other) noexcept : id_{std::exchange(other.id_, H5I_INVALID_HID)}, close_{other.close_} {}
  Handle& operator=(Handle&& other) noexcept {
    if (this != &other) {
      (void)reset();
      id_ = std::exchange(other.id_, H5I_INVALID_HID);
      close_ = other.close_;
    }
    return *this;
  }
  ~Handle() { (void)reset(); }

  [[nodiscard]] hid_t id() const noexcept { return id_; }
  [[nodiscard]] bool valid() const noexcept { return id_ >= 0; }
  /// Closes now. @return false when the library could not write what it still held.
  bool reset() noexcept {
    const hid_t id = std::exchange(id_, H5I_INVALID_HID);
    return id < 0 || close_(id) >= 0;
  }

 private:
  hid_t id_ = H5I_INVALID_HID;
  Close close_ = nullptr;
};

/// @throws RecordingError `what: reason` when `result` reports a failure; else returns it.
hid_t checked(hid_t result, const std::string& what);
void check(herr_t result, const std::string& what);

}  // namespace hybridtest::hdf5
