#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

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

  /// These rows of a column; empty when there is no such column.
  [[nodiscard]] std::vector<double> column(std::string_view name) const;

 private:
  const RunFileReader& file_;
  std::size_t first_ = 0;
  std::size_t end_ = 0;
};

}  // namespace hybridtest
