#include "validation/sweep/sweep_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "core/config_error.hpp"
#include "recording/csv_export.hpp"

namespace hybridtest {
namespace {

using Json = nlohmann::ordered_json;
using Cells = std::vector<std::pair<std::string, std::string>>;  // by column, in their order

std::string cell_of(const Json& value) {
  if (value.is_null()) return "";
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) return fmt::format("{:.10g}", value.get<double>());
  return value.dump();
}

void add_substructure(const Json& substructure, Cells& cells) {
  const std::string id = substructure.at("id");
  for (const Json& peak : substructure.at("peak_force")) {
    cells.emplace_back(fmt::format("peak_force_{}_{}_n", id, peak.at("dof").get<std::string>()),
                       cell_of(peak.at("force_n")));
  }
  for (const Json& tracking : substructure.at("tracking")) {
    const std::string dof = id + "_" + tracking.at("dof").get<std::string>();
    cells.emplace_back("tracking_rms_" + dof + "_m", cell_of(tracking.at("rms_m")));
    cells.emplace_back("tracking_rms_relative_" + dof, cell_of(tracking.at("rms_relative")));
    cells.emplace_back("tracking_delay_" + dof + "_s", cell_of(tracking.at("equivalent_delay_s")));
  }
  if (const Json& energy = substructure.at("energy_error"); !energy.is_null()) {
    cells.emplace_back("energy_error_peak_" + id + "_j", cell_of(energy.at("peak_j")));
  }
  if (const Json& exchange = substructure.at("exchange"); !exchange.is_null()) {
    for (const char* count : {"resent", "bridged", "lost", "late", "held"}) {
      cells.emplace_back(fmt::format("{}_{}", count, id), cell_of(exchange.at(count)));
    }
  }
}

/// Nothing that a second run of the case would tell in another way.
Cells cells_of(const Json& summary) {
  Cells cells;
  if (!summary.contains("completed_steps")) {  // the case did not run
    for (const char* key : {"exit_code", "stop_reason"}) cells.emplace_back(key, cell_of(summary.at(key)));
    return cells;
  }
  for (const char* key : {"exit_code", "stop_reason", "data_valid", "completed_steps", "model_time_s"}) {
    cells.emplace_back(key, cell_of(summary.at(key)));
  }
  const Json& interlocks = summary.at("interlocks");
  std::string tripped;
  if (!interlocks.empty()) {
    tripped = interlocks.front().at("participant").get<std::string>() + " " +
              interlocks.front().at("limit_name").get<std::string>();
  }
  cells.emplace_back("interlock", tripped);
  for (const Json& peak : summary.at("peak_displacement")) {
    cells.emplace_back("peak_displacement_" + peak.at("dof").get<std::string>() + "_m",
                       cell_of(peak.at("displacement_m")));
  }
  for (const Json& substructure : summary.at("substructures")) add_substructure(substructure, cells);
  return cells;
}

void append_cell(std::string& text, const std::string& cell) {
  if (cell.find_first_of(",\"\n") == std::string::npos) {
    text += cell;
  } else {
    append_quoted(text, cell);
  }
}

}  // namespace

std::size_t SweepTable::column(std::string_view name) const {
  const auto found = std::ranges::find(columns, name);
  if (found == columns.end()) {
    throw ConfigError{fmt::format("no column '{}' in the table; known here: {}", name, fmt::join(columns, ", "))};
  }
  return static_cast<std::size_t>(found - columns.begin());
}

SweepTable read_results(const SweepPlan& plan, const SweepFiles& files) {
  SweepTable table;
  table.columns = {"case", "seed"};
  for (const Varied& one : plan.varied) table.columns.push_back(one.key);
  std::map<std::string, std::size_t> positions;
  for (std::size_t number = 1; number <= plan.case_count(); ++number) {
    const SweepCase one = plan.case_at(number);
    std::vector<std::string> row{std::to_string(number), std::to_string(one.seed)};
    row.insert(row.end(), one.values.begin(), one.values.end());
    std::ifstream stream{files.result(number)};
    if (stream) {
      ++table.done;
      try {
        for (auto& [column, cell] : cells_of(Json::parse(stream))) {
          const auto [position, is_new] = positions.try_emplace(column, table.columns.size());
          if (is_new) table.columns.push_back(column);
          row.resize(std::max(row.size(), position->second + 1));
          row[position->second] = std::move(cell);
        }
      } catch (const Json::exception& error) {
        throw ConfigError{files.result(number).string() + ": cannot be read: " + error.what() +
                          "; delete it, and the case is run again"};
      }
    }
    table.rows.push_back(std::move(row));
  }
  for (auto& row : table.rows) row.resize(table.columns.size());
  return table;
}

std::string to_csv(const SweepTable& table) {
  std::string text;
  const auto add = [&](const std::vector<std::string>& cells) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (i > 0) text += ',';
      append_cell(text, cells[i]);
    }
    text += "\n";
  };
  add(table.columns);
  for (const auto& row : table.rows) add(row);
  return text;
}

}  // namespace hybridtest
