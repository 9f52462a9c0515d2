#pragma once

#include <stdexcept>

namespace hybridtest {

/// A run file could not be created, written, read or repaired. The text gives the file, the
/// operation and the reason of the system.
class RecordingError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace hybridtest
