#include "validation/studies/founding_study/kept_table.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace hybridtest {

std::vector<double> KeptTable::column(std::string_view name) const {
  const auto found = std::ranges::find(layout_.columns, name, &Column::name);
  if (found == layout_.columns.end()) {
    throw std::out_of_range{"table " + layout_.name + " has no column " + std::string{name}};
  }
  std::vector<double> values;
  const auto width = layout_.columns.size();
  for (auto i = static_cast<std::size_t>(found - layout_.columns.begin()); i < values_.size(); i += width) {
    values.push_back(values_[i]);
  }
  return values;
}

}  // namespace hybridtest
