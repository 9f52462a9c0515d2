#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>

#include "recording/run_file_reader.hpp"

namespace hybridtest {

/// The rows of a site's table `control` that belong to the test: from its start to the end of the last step that the
/// site measured. The rows before are of a site that is armed and waits, with zero offsets still in the sensors. The
/// rows after it are of the return to zero, or of a hold, and follow no targets.
///
/// The model time of the rows tells them apart: it stands still before the start and after the last step.
class TestRows {
 public:
  /// Every row where the file has no model times or no measured step.
  explicit TestRows(const RunFileReader& file);

  /// Hands them over one by one; a block of them is in memory.
  void read(const std::function<void(std::span<const double> row)>& visit) const;

 private:
  const RunFileReader& file_;
  std::optional<std::size_t> time_;  // position of the model time; none: every row is of the test
  std::size_t first_ = 0;
  double end_s_ = 0.0;  // model time of the last step
};

}  // namespace hybridtest
