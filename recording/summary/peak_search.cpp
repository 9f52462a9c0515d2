#include "recording/summary/peak_search.hpp"

#include <cmath>
#include <limits>

#include "recording/summary/columns.hpp"

namespace hybridtest {

PeakSearch::PeakSearch(const RunFileReader& file, std::string_view table, std::string_view quantity,
                       std::string_view unit)
    : time_{column_position(file, table, "model_time_s")} {
  for (const DofColumn& column : dof_columns(file, table, quantity, unit)) {
    searches_.push_back({.position = *column_position(file, table, column.name), .peak = {.dof = column.dof}});
  }
}

void PeakSearch::add(std::span<const double> row) {
  for (Search& search : searches_) {
    const double value = row[search.position];
    if (!std::isfinite(value) || (search.is_found && std::abs(value) <= std::abs(search.peak.value))) continue;
    search.is_found = true;
    search.peak.value = value;
    search.peak.model_time_s = time_ ? row[*time_] : std::numeric_limits<double>::quiet_NaN();
  }
}

std::vector<Peak> PeakSearch::peaks() const {
  std::vector<Peak> peaks;
  for (const Search& search : searches_) {
    if (search.is_found) peaks.push_back(search.peak);
  }
  return peaks;
}

}  // namespace hybridtest
