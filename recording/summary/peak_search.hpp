#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "recording/summary/run_summary.hpp"

namespace hybridtest {

class RunFileReader;

/// The value of largest magnitude of every degree of freedom of a quantity, while the rows of a table are read.
class PeakSearch {
 public:
  /// The columns of the quantity, see dof_columns(). Without such columns it finds nothing.
  PeakSearch(const RunFileReader& file, std::string_view table, std::string_view quantity, std::string_view unit);

  void add(std::span<const double> row);
  /// Of those that had a finite value; without a column of model time the time is NaN.
  [[nodiscard]] std::vector<Peak> peaks() const;

 private:
  struct Search {
    std::size_t position = 0;
    Peak peak{};
    bool is_found = false;
  };

  std::optional<std::size_t> time_;
  std::vector<Search> searches_;
};

}  // namespace hybridtest
