#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/records.hpp"

namespace hybridtest {

/// A recorded table in memory, read by the names of its columns.
class KeptRows final : public RowSink {
 public:
  explicit KeptRows(TableLayout layout) : layout_{std::move(layout)} {}

  void append(std::span<const double> row) noexcept override {
    if (row.size() != layout_.columns.size()) ADD_FAILURE() << "a row of another width in " << layout_.name;
    values_.insert(values_.end(), row.begin(), row.end());
  }

  [[nodiscard]] const TableLayout& layout() const noexcept { return layout_; }
  [[nodiscard]] std::size_t size() const noexcept { return values_.size() / layout_.columns.size(); }
  [[nodiscard]] std::span<const double> values() const noexcept { return values_; }
  [[nodiscard]] double& at(std::size_t row, std::size_t column) {
    return values_[row * layout_.columns.size() + column];
  }
  [[nodiscard]] std::size_t column(std::string_view name) const {
    const auto found = std::ranges::find(layout_.columns, name, &Column::name);
    if (found == layout_.columns.end()) throw std::out_of_range{"no column " + std::string{name}};
    return static_cast<std::size_t>(found - layout_.columns.begin());
  }
  /// Every value of one column.
  [[nodiscard]] std::vector<double> column_values(std::string_view name) const {
    std::vector<double> values;
    for (std::size_t i = column(name); i < values_.size(); i += layout_.columns.size()) values.push_back(values_[i]);
    return values;
  }
  void drop(std::size_t row) {
    const auto begin = values_.begin() + static_cast<std::ptrdiff_t>(row * layout_.columns.size());
    values_.erase(begin, begin + static_cast<std::ptrdiff_t>(layout_.columns.size()));
  }

 private:
  TableLayout layout_;
  std::vector<double> values_;
};

}  // namespace hybridtest
