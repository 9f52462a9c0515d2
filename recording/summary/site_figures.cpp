#include "recording/summary/site_figures.hpp"

#include <cmath>
#include <functional>

#include "recording/read_rows.hpp"
#include "recording/summary/columns.hpp"
#include "recording/summary/peak_search.hpp"
#include "recording/summary/test_rows.hpp"

namespace hybridtest {
namespace {

constexpr std::string_view kStepRows = "steps";
constexpr std::string_view kControlRows = "control";

/// Hands over the rows of a table, all of them or those of the test.
using Pass = std::function<void(const std::function<void(std::span<const double> row)>&)>;

/// Target against measured displacement of every degree of freedom of a table.
class SiteTracking {
 public:
  SiteTracking(const RunFileReader& file, std::string_view table, std::string_view time)
      : time_{column_position(file, table, time)} {
    if (!time_) return;
    for (const DofColumn& target : dof_columns(file, table, "target_displacement", "m")) {
      const auto measured = column_position(file, table, "measured_displacement" + target.rest);
      if (!measured) continue;
      dofs_.push_back({*column_position(file, table, target.name), *measured, TrackingSearch{target.dof}});
    }
  }

  /// In the first pass.
  void add(std::span<const double> row) {
    if (dofs_.empty()) return;
    interval_.add(row[*time_]);
    for (Dof& dof : dofs_) dof.search.add_error(row[dof.target], row[dof.measured]);
  }
  /// After the first pass. @param pass   for the others.
  [[nodiscard]] std::vector<TrackingError> result(const Pass& pass) {
    if (dofs_.empty()) return {};
    while (interval_.end_pass()) pass([&](std::span<const double> row) { interval_.add(row[*time_]); });
    for (Dof& dof : dofs_) dof.search.begin_delay(interval_.result());
    pass([&](std::span<const double> row) {
      for (Dof& dof : dofs_) dof.search.add_delay(row[*time_], row[dof.target], row[dof.measured]);
    });
    std::vector<TrackingError> errors;
    for (Dof& dof : dofs_) {
      if (auto error = dof.search.result()) errors.push_back(std::move(*error));
    }
    return errors;
  }

 private:
  struct Dof {
    std::size_t target = 0;
    std::size_t measured = 0;
    TrackingSearch search;
  };

  std::optional<std::size_t> time_;
  UsualInterval interval_;
  std::vector<Dof> dofs_;
};

void add_energy(std::optional<EnergyError>& error, double energy_j) {
  if (!std::isfinite(energy_j)) return;
  if (!error) error = EnergyError{energy_j, energy_j};
  if (std::abs(energy_j) > std::abs(error->peak_j)) error->peak_j = energy_j;
  error->final_j = energy_j;
}

void read_control_rows(const RunFileReader& file, SiteFigures& figures) {
  const TestRows rows{file};
  const Pass pass = [&](const auto& visit) { rows.read(visit); };
  PeakSearch force{file, kControlRows, "measured_force", "n"};
  SiteTracking tracking{file, kControlRows, "time_s"};
  const auto energy = column_position(file, kControlRows, "energy_error_j");
  pass([&](std::span<const double> row) {
    force.add(row);
    tracking.add(row);
    if (energy) add_energy(figures.energy_error, row[*energy]);
  });
  figures.peak_force_n = force.peaks();
  figures.tracking = tracking.result(pass);
}

void read_step_rows(const RunFileReader& file, bool with_tracking, SiteFigures& figures) {
  const Pass pass = [&](const auto& visit) {
    read_rows(file, kStepRows, [&](std::span<const double> row) {
      visit(row);
      return true;
    });
  };
  PeakSearch measured{file, kStepRows, "measured_force", "n"};
  PeakSearch computed{file, kStepRows, "force", "n"};
  SiteTracking tracking{file, kStepRows, with_tracking ? "model_time_s" : ""};
  pass([&](std::span<const double> row) {
    measured.add(row);
    computed.add(row);
    tracking.add(row);
  });
  if (figures.peak_force_n.empty()) figures.peak_force_n = measured.peaks();
  if (figures.peak_force_n.empty()) figures.peak_force_n = computed.peaks();
  if (with_tracking) figures.tracking = tracking.result(pass);
}

}  // namespace

SiteFigures site_figures(const RunFileReader& file) {
  SiteFigures figures;
  const bool has_control = file.row_count(kControlRows) > 0;
  if (has_control) read_control_rows(file, figures);
  const bool has_times = has_control && file.has_column(kControlRows, "time_s");
  if (figures.peak_force_n.empty() || !has_times) read_step_rows(file, !has_times, figures);
  return figures;
}

}  // namespace hybridtest
