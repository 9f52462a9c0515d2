#pragma once

#include <stdexcept>

namespace hybridtest {

/// A run file could not be created, written, read or repaired. The text names the file, what was
/// being done and the reason the system gave.
class RecordingError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace hybridtest
