#pragma once

#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/records.hpp"
#include "scenario/scenario.hpp"

namespace hybridtest {

/// A signal that users look at. Its name, unit and subject are those of LiveSignal.
struct SignalName {
  std::string name;
  std::string subject;  // degree of freedom or substructure; may be empty
  std::string unit;
  double limit = std::numeric_limits<double>::quiet_NaN();  // [unit] of its interlock
  bool operator==(const SignalName& other) const noexcept {
    return name == other.name && subject == other.subject && unit == other.unit;
  }
};

/// What users look at, read from the rows of one recorded table: the same for live views, while the rows are written,
/// and for reports, when they are read back. The rows are given in order, from the first.
class DerivedSignals {
 public:
  virtual ~DerivedSignals() = default;

  [[nodiscard]] const std::vector<SignalName>& names() const noexcept { return names_; }
  /// @param row      one value per column of the table.
  /// @param values   one per name; NaN where there is none.
  virtual void read(std::span<const double> row, std::span<double> values) = 0;

 protected:
  std::vector<SignalName> names_;
};

/// Of the coordinator's table `steps`: `displacement` of each recorded degree of freedom; `drift` of each interface
/// degree of freedom between recorded ones, the displacement that the substructure is given (subject: id and name);
/// `ground_acceleration`; `velocity` and `restoring_force` of each recorded degree of freedom. Where all degrees of
/// freedom are recorded and the mass is known also `base_shear`, the sum of the restoring forces along the first ground
/// motion, and `kinetic_energy`, `damping_energy`, `restoring_energy`, `input_energy`, `energy_balance_error` of
/// EnergyBalance.
[[nodiscard]] std::unique_ptr<DerivedSignals> structure_signals(const Scenario& scenario, const TableLayout& steps);

/// Of the coordinator's table `steps`: `step` and `wall_time` since the start [s].
[[nodiscard]] std::unique_ptr<DerivedSignals> pace_signals(const TableLayout& steps);

/// Of the table `control` of a site, for each interface degree of freedom: `target_displacement`,
/// `command_displacement`, `measured_displacement`, `force` (measured), `tracking_error` (target - measured) and
/// `estimated_delay`, the equivalent delay of the measured motion behind the target [s] of site time: the least squares
/// of the tracking error over the velocity of the target, with weights that fade over two seconds; NaN while the
/// target moves at less than a thousandth of the velocity limit. Without subject
/// `energy_error` [J] and `tracking_lag_sine`, see TrackingIndicator.
[[nodiscard]] std::unique_ptr<DerivedSignals> site_signals(const SubstructureScenario& substructure,
                                                           const TableLayout& control);

/// Of the table `control` of a site: what each interlock compares with its limit, by the name of the interlock; those
/// without a limit are left out. NaN while there is nothing to judge.
[[nodiscard]] std::unique_ptr<DerivedSignals> interlock_signals(const SubstructureScenario& substructure,
                                                                const TableLayout& control);

/// Of the table `steps` of a numerical substructure: `displacement` and `force` of each recorded interface degree of
/// freedom.
[[nodiscard]] std::unique_ptr<DerivedSignals> numerical_signals(const SubstructureScenario& substructure,
                                                                const TableLayout& steps);

}  // namespace hybridtest
