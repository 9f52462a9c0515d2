#include "report/run_report/history_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <sstream>
#include <utility>

#include "core/config_error.hpp"

namespace hybridtest::run_report {

TableHistory::TableHistory(const RunFileReader& file, std::string_view table, std::span<const std::string> wanted)
    : rows_{file, table} {
  const auto layout = std::ranges::find(file.tables(), table, &TableLayout::name);
  if (layout == file.tables().end()) return;
  for (std::size_t i = 0; i < layout->columns.size(); ++i) {
    const std::string& name = layout->columns[i].name;
    if (name == "model_time_s") time_ = i;
    const bool is_wanted =
        std::ranges::any_of(wanted, [&](const std::string& begin) { return name.starts_with(begin); });
    if (is_wanted) columns_.push_back({name, i});
  }
  values_.resize(columns_.size());
}

bool TableHistory::next() {
  if (!time_) return false;
  const std::span<const double> row = rows_.next();
  if (row.empty()) return false;
  time_s_ = row[*time_];
  for (std::size_t i = 0; i < columns_.size(); ++i) values_[i] = row[columns_[i].position];
  return true;
}

CsvHistory::CsvHistory(std::filesystem::path path) : path_{std::move(path)}, stream_{path_} {
  std::string head;
  if (!std::getline(stream_, head)) throw ConfigError{path_.string() + ": cannot be read, or is empty"};
  std::istringstream cells{head};
  bool has_time = false;
  for (std::string cell; std::getline(cells, cell, ','); ++width_) {
    if (!cell.empty() && cell.back() == '\r') cell.pop_back();
    if (cell == "time_s") {
      has_time = true;
      time_ = width_;
    } else {
      columns_.push_back({cell, width_});
    }
  }
  if (!has_time) {
    throw ConfigError{path_.string() +
                      ":1: no column time_s; expected a CSV file as `hybridtest reference` writes it, such as "
                      "time_s,displacement_floor_1_m"};
  }
  values_.resize(columns_.size());
  numbers_.resize(width_);
}

bool CsvHistory::next() {
  std::string line;
  do {
    if (!std::getline(stream_, line)) return false;
    ++line_;
  } while (line.empty() || line == "\r");
  const char* at = line.data();
  const char* const end = line.data() + line.size();
  for (std::size_t i = 0; i < width_; ++i) {
    const auto [stop, error] = std::from_chars(at, end, numbers_[i]);
    const bool is_separated = i + 1 == width_ ? stop == end || *stop == '\r' : stop != end && *stop == ',';
    if (error != std::errc{} || !is_separated) {
      throw ConfigError{fmt::format("{}:{}: expected {} numbers separated by commas", path_.string(), line_, width_)};
    }
    at = stop + 1;
  }
  time_s_ = numbers_[time_];
  for (std::size_t i = 0; i < columns_.size(); ++i) values_[i] = numbers_[columns_[i].position];
  return true;
}

}  // namespace hybridtest::run_report
