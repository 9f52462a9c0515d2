#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "core/records.hpp"

namespace hybridtest {

/// A recorded table in memory; a study reads it by the names of its columns.
class KeptTable final : public RowSink {
 public:
  explicit KeptTable(TableLayout layout) : layout_{std::move(layout)} {}

  void append(std::span<const double> row) noexcept override { values_.insert(values_.end(), row.begin(), row.end()); }

  /// @throws std::out_of_range without such a column.
  [[nodiscard]] std::vector<double> column(std::string_view name) const;

 private:
  TableLayout layout_;
  std::vector<double> values_;
};

}  // namespace hybridtest
