#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "diagnosis/localisation/gap_signals.hpp"
#include "diagnosis/result/diagnosis_report.hpp"
#include "report/plotting/line_figure.hpp"

namespace hybridtest::report {

/// The series of one interface made ready for drawing: residuals, and units of handy size.
class SeriesView {
 public:
  /// @param series   not empty; must outlive the view.
  explicit SeriesView(const InterfaceSeries& series);

  [[nodiscard]] const InterfaceSeries& series() const noexcept { return *series_; }
  [[nodiscard]] bool has_augmented() const noexcept { return !series_->augmented.empty(); }
  [[nodiscard]] bool gives_force() const noexcept { return series_->unit == "N"; }
  [[nodiscard]] GapSignals before() const noexcept;
  [[nodiscard]] GapSignals after() const noexcept;  // has_augmented()
  /// Of the output, as drawn: `force [kN]`, and what a value is multiplied by.
  [[nodiscard]] const std::string& output_label() const noexcept { return output_label_; }

  /// A range of samples, both ends of a drawing.
  struct Range {
    std::size_t begin = 0;
    std::size_t end = 0;
  };
  [[nodiscard]] Range whole() const noexcept { return {0, series_->measured.size()}; }
  /// About four cycles, where the gap is largest.
  [[nodiscard]] Range close_up() const;

  /// Values of a range over time in seconds.
  [[nodiscard]] plot::Line over_time(std::string name, const std::vector<double>& values, Range range) const;
  /// Output over input in mm.
  [[nodiscard]] plot::Line over_input(std::string name, const std::vector<double>& values, Range range) const;

 private:
  const InterfaceSeries* series_;
  std::vector<double> before_;
  std::vector<double> after_;
  std::string output_label_;
  double output_scale_ = 1.0;
};

inline constexpr double kMillimetres = 1e3;  // per metre

}  // namespace hybridtest::report
