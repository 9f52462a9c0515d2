#include "report/run_report/signal_curve.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "report/run_report/tuning.hpp"

namespace hybridtest::run_report {
namespace {

/// A column `<begin><subject><end>`, and the signal that it is.
struct ColumnRule {
  std::string_view begin;
  std::string_view end;
  std::string_view name;
  std::string_view unit;
};

constexpr std::array<ColumnRule, 10> kColumnRules{{
    {"ground_acceleration", "_m_per_s2", "ground_acceleration", "m/s2"},
    {"displacement_", "_m", "displacement", "m"},
    {"restoring_force_", "_n", "restoring_force", "N"},
    {"force_", "_n", "force", "N"},
    {"target_displacement_m", "", "target_displacement", "m"},
    {"command_displacement_m", "", "command_displacement", "m"},
    {"measured_displacement_m", "", "measured_displacement", "m"},
    {"measured_force_n", "", "force", "N"},
    {"energy_error_j", "", "energy_error", "J"},
    {"tracking_lag_sine", "", "tracking_lag_sine", ""},
}};

class ColumnSignals final : public DerivedSignals {
 public:
  explicit ColumnSignals(const TableLayout& table) {
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
      const std::string_view column = table.columns[i].name;
      const auto rule = std::ranges::find_if(kColumnRules, [&](const ColumnRule& one) {
        return column.starts_with(one.begin) && column.ends_with(one.end) &&
               column.size() >= one.begin.size() + one.end.size();
      });
      if (rule == kColumnRules.end()) continue;
      std::string subject{column.substr(rule->begin.size(), column.size() - rule->begin.size() - rule->end.size())};
      if (subject.starts_with('_')) subject.erase(0, 1);
      columns_.push_back(i);
      names_.push_back({std::string{rule->name}, subject, std::string{rule->unit}});
    }
  }
  void read(std::span<const double> row, std::span<double> values) override {
    for (std::size_t i = 0; i < columns_.size(); ++i) values[i] = row[columns_[i]];
  }

 private:
  std::vector<std::size_t> columns_;
};

}  // namespace

CurveBuilder::CurveBuilder(std::unique_ptr<DerivedSignals> signals, double end_s)
    : signals_{std::move(signals)},
      values_(signals_->names().size()),
      thinners_(values_.size(), plot::HistoryThinner{0.0, end_s, kHistoryColumns}) {
  for (const SignalName& name : signals_->names()) curves_.push_back({.name = name, .points = {}});
}

void CurveBuilder::add(double model_time_s, std::span<const double> row) {
  signals_->read(row, values_);
  for (std::size_t i = 0; i < values_.size(); ++i) {
    thinners_[i].add(model_time_s, values_[i]);
    if (!std::isfinite(values_[i])) continue;
    SignalCurve& curve = curves_[i];
    ++curve.values;
    if (curve.values > 1 && std::abs(values_[i]) <= std::abs(curve.peak)) continue;
    curve.peak = values_[i];
    curve.peak_time_s = model_time_s;
  }
}

std::vector<SignalCurve> CurveBuilder::take() {
  for (std::size_t i = 0; i < curves_.size(); ++i) curves_[i].points = thinners_[i].take();
  std::erase_if(curves_, [](const SignalCurve& curve) { return curve.values == 0; });
  return std::exchange(curves_, {});
}

std::unique_ptr<DerivedSignals> column_signals(const TableLayout& table) {
  return std::make_unique<ColumnSignals>(table);
}

const SignalCurve* find_curve(const std::vector<SignalCurve>& curves, std::string_view name) {
  const auto found = std::ranges::find_if(curves, [&](const SignalCurve& curve) { return curve.name.name == name; });
  return found == curves.end() ? nullptr : &*found;
}

const SignalCurve* find_curve(const std::vector<SignalCurve>& curves, const SignalName& name) {
  const auto found = std::ranges::find_if(curves, [&](const SignalCurve& curve) { return curve.name == name; });
  return found == curves.end() ? nullptr : &*found;
}

}  // namespace hybridtest::run_report
