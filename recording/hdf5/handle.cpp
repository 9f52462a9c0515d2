#include "recording/hdf5/handle.hpp"

#include <string_view>

#include "recording/error.hpp"

namespace hybridtest::hdf5 {
namespace {

herr_t keep_first(unsigned, const H5E_error2_t* entry, void* context) {
  auto& text = *static_cast<std::string*>(context);
  if (text.empty() && entry->desc != nullptr) text = entry->desc;
  return 0;
}

/// HDF5 names file, descriptor, sizes and pointers besides what the operating system says: `errno = 28, error message =
/// 'No space left on device'`.
std::string without_internals(const std::string& text) {
  constexpr std::string_view kNumber = "errno = ";
  constexpr std::string_view kMessage = ", error message = '";
  const std::size_t number = text.find(kNumber);
  const std::size_t message = text.find(kMessage);
  if (number == std::string::npos || message == std::string::npos || message < number) return text;
  const std::size_t begin = message + kMessage.size();
  return text.substr(0, text.find_first_of(":,")) + ": " + text.substr(begin, text.find('\'', begin) - begin) + " (" +
         text.substr(number, message - number) + ")";
}

}  // namespace

std::unique_lock<std::recursive_mutex> lock_library() {
  static std::recursive_mutex mutex;
  std::unique_lock lock{mutex};
  static const bool quiet = H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr) >= 0;
  (void)quiet;
  return lock;
}

std::string last_error() {
  std::string text;
  (void)H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_first, &text);
  return text.empty() ? "no reason given" : without_internals(text);
}

hid_t checked(hid_t result, const std::string& what) {
  if (result < 0) throw RecordingError{what + ": " + last_error()};
  return result;
}

void check(herr_t result, const std::string& what) {
  if (result < 0) throw RecordingError{what + ": " + last_error()};
}

}  // namespace hybridtest::hdf5
