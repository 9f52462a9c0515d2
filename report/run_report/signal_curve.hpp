#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "recording/read_rows.hpp"
#include "recording/run_file_reader.hpp"
#include "report/plotting/thinning.hpp"
#include "runtime/live/derived_signals.hpp"

namespace hybridtest::run_report {

/// A signal over a whole test, thinned, with its peak. SI units.
struct SignalCurve {
  SignalName name;
  plot::Points points;       // x: model time [s]
  double peak = 0.0;         // the value of largest magnitude, with its sign
  double peak_time_s = 0.0;  // of model time
  std::size_t values = 0;    // finite ones, before thinning
};

/// Thins the signals of one table while its rows are read.
class CurveBuilder {
 public:
  /// @param end_s   model time that the curves reach to.
  CurveBuilder(std::unique_ptr<DerivedSignals> signals, double end_s);

  /// @param row   of the signals' table.
  void add(double model_time_s, std::span<const double> row);
  /// Of the row added last, one per signal.
  [[nodiscard]] std::span<const double> values() const noexcept { return values_; }
  [[nodiscard]] const std::vector<SignalName>& names() const noexcept { return signals_->names(); }
  /// Those that had a value.
  [[nodiscard]] std::vector<SignalCurve> take();

 private:
  std::unique_ptr<DerivedSignals> signals_;
  std::vector<double> values_;
  std::vector<plot::HistoryThinner> thinners_;
  std::vector<SignalCurve> curves_;
};

/// Signals that are columns, by the names of the columns alone: for a recording without a scenario that can be read.
/// Knows the coordinator's and the numerical substructures' tables `steps` and the sites' tables `control`.
[[nodiscard]] std::unique_ptr<DerivedSignals> column_signals(const TableLayout& table);

/// The first with that name (and subject); nullptr when there is none.
[[nodiscard]] const SignalCurve* find_curve(const std::vector<SignalCurve>& curves, std::string_view name);
[[nodiscard]] const SignalCurve* find_curve(const std::vector<SignalCurve>& curves, const SignalName& name);

}  // namespace hybridtest::run_report
