#include "recording/summary/exchanges.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "recording/read_rows.hpp"
#include "recording/summary/columns.hpp"

namespace hybridtest {
namespace {

constexpr std::string_view kExchanges = "exchanges";
constexpr std::string_view kBridges = "bridges";

bool has_flag(double flags, MeasurementFlags flag) {
  if (!(flags >= 0.0 && flags <= 4294967295.0)) return false;
  return any(static_cast<MeasurementFlags>(static_cast<std::uint32_t>(flags)) & flag);
}

void count_flags(ExchangeSummary& summary, double flags) {
  summary.extrapolated += has_flag(flags, MeasurementFlags::extrapolated);
  summary.held += has_flag(flags, MeasurementFlags::held);
  summary.saturated += has_flag(flags, MeasurementFlags::saturated);
  summary.late += has_flag(flags, MeasurementFlags::late);
  summary.missed += has_flag(flags, MeasurementFlags::missed);
  summary.repeated += has_flag(flags, MeasurementFlags::repeated);
}

/// Where the columns are in a row; their values are NaN where there is no such column.
struct ExchangeColumns {
  std::optional<std::size_t> step, substructure, round_trip_us, turnaround_us, attempts, flags;

  explicit ExchangeColumns(const RunFileReader& file)
      : step{column_position(file, kExchanges, "step")},
        substructure{column_position(file, kExchanges, "substructure")},
        round_trip_us{column_position(file, kExchanges, "round_trip_us")},
        turnaround_us{column_position(file, kExchanges, "turnaround_us")},
        attempts{column_position(file, kExchanges, "attempts")},
        flags{column_position(file, kExchanges, "flags")} {}

  [[nodiscard]] static double value(std::span<const double> row, std::optional<std::size_t> position) {
    return position ? row[*position] : std::numeric_limits<double>::quiet_NaN();
  }
};

/// The exchanges with one substructure, while the rows are read.
struct ExchangeSearch {
  ExchangeSummary summary;
  PercentileSearch round_trip_us;
  PercentileSearch turnaround_us;
  bool has_rows = false;

  void count(std::span<const double> row, const ExchangeColumns& columns, double last_step) {
    has_rows = true;
    const double attempts = ExchangeColumns::value(row, columns.attempts);
    if (attempts > 1.0) summary.resent += static_cast<std::uint64_t>(attempts) - 1;
    if (std::isfinite(ExchangeColumns::value(row, columns.round_trip_us))) {
      ++summary.answered;
      count_flags(summary, ExchangeColumns::value(row, columns.flags));
    } else {
      const bool went_on = ExchangeColumns::value(row, columns.step) <= last_step;
      ++(went_on ? summary.bridged : summary.lost);
    }
  }
  void add_times(std::span<const double> row, const ExchangeColumns& columns) {
    const double us = ExchangeColumns::value(row, columns.round_trip_us);
    if (!std::isfinite(us)) return;
    round_trip_us.add(us);
    turnaround_us.add(ExchangeColumns::value(row, columns.turnaround_us));
  }
  bool end_pass() {
    const bool goes_on = round_trip_us.end_pass();
    return turnaround_us.end_pass() || goes_on;
  }
};

/// Adds what the coordinator's table `bridges` tells.
void add_bridges(const RunFileReader& file, std::vector<ExchangeSearch>& searches) {
  const auto substructure = column_position(file, kBridges, "substructure");
  const auto in_a_row = column_position(file, kBridges, "in_a_row");
  const auto energy_j = column_position(file, kBridges, "energy_added_j");
  if (!substructure || !in_a_row || !energy_j) return;
  read_rows(file, kBridges, [&](std::span<const double> row) {
    const double index = row[*substructure];
    if (!(index >= 0.0 && index < static_cast<double>(searches.size()))) return true;
    ExchangeSummary& summary = searches[static_cast<std::size_t>(index)].summary;
    summary.bridged_in_a_row = std::max(summary.bridged_in_a_row, static_cast<int>(row[*in_a_row]));
    if (!std::isfinite(row[*energy_j])) return true;
    summary.bridged_energy_j += row[*energy_j];
    summary.bridged_energy_magnitude_j += std::abs(row[*energy_j]);
    return true;
  });
}

}  // namespace

std::vector<std::optional<ExchangeSummary>> exchanges_of(const RunFileReader& file, std::size_t substructures,
                                                         double last_step) {
  std::vector<std::optional<ExchangeSummary>> summaries(substructures);
  const ExchangeColumns columns{file};
  if (!columns.substructure) return summaries;
  std::vector<ExchangeSearch> searches(substructures);
  bool is_first_pass = true;
  for (bool goes_on = true; goes_on;) {
    read_rows(file, kExchanges, [&](std::span<const double> row) {
      const double index = row[*columns.substructure];
      if (!(index >= 0.0 && index < static_cast<double>(substructures)) || index != std::floor(index)) return true;
      ExchangeSearch& search = searches[static_cast<std::size_t>(index)];
      if (is_first_pass) search.count(row, columns, last_step);
      search.add_times(row, columns);
      return true;
    });
    is_first_pass = false;
    goes_on = false;
    for (ExchangeSearch& search : searches) goes_on = search.end_pass() || goes_on;
  }
  add_bridges(file, searches);
  for (std::size_t i = 0; i < substructures; ++i) {
    if (!searches[i].has_rows) continue;
    summaries[i] = searches[i].summary;
    summaries[i]->round_trip_us = searches[i].round_trip_us.result();
    summaries[i]->turnaround_us = searches[i].turnaround_us.result();
  }
  return summaries;
}

}  // namespace hybridtest
