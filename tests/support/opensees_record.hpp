#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace hybridtest {

/// Columns of a file that OpenSees recorded: time, then displacements.
inline std::vector<std::vector<double>> columns_of(const std::filesystem::path& file) {
  std::vector<std::vector<double>> columns;
  std::ifstream text{file};
  for (std::string line; std::getline(text, line);) {
    std::istringstream words{line};
    std::size_t column = 0;
    for (double value = 0.0; words >> value; ++column) {
      if (column == columns.size()) columns.emplace_back();
      columns[column].push_back(value);
    }
  }
  return columns;
}

inline double peak_of(const std::vector<double>& values) {
  double peak = 0.0;
  for (const double value : values) peak = std::max(peak, std::abs(value));
  return peak;
}

/// Largest difference over the largest value.
inline double peak_error(const std::vector<double>& values, const std::vector<double>& reference) {
  double error = 0.0;
  for (std::size_t i = 0; i < reference.size(); ++i) error = std::max(error, std::abs(values.at(i) - reference[i]));
  return error / peak_of(reference);
}

}  // namespace hybridtest
