#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "diagnosis/result/diagnosis_report.hpp"
#include "diagnosis/signals/signals.hpp"
#include "report/plotting/line_figure.hpp"

namespace hybridtest::report {

/// The series of one interface prepared for drawing: residuals, and suitable units.
class SeriesView {
 public:
  /// @param series   not empty; must outlive the view.
  explicit SeriesView(const InterfaceSeries& series);

  [[nodiscard]] const InterfaceSeries& series() const noexcept { return *series_; }
  [[nodiscard]] bool has_augmented() const noexcept { return !series_->augmented.empty(); }
  [[nodiscard]] bool gives_force() const noexcept { return series_->unit == "N"; }
  [[nodiscard]] GapSignals before() const noexcept;
  [[nodiscard]] GapSignals after() const noexcept;  // has_augmented()
  /// Axis label of the output: `force [kN]`.
  [[nodiscard]] const std::string& output_label() const noexcept { return output_label_; }

  /// Of what takes the place of time in a quasi-static recording, or of time.
  [[nodiscard]] std::string time_label() const {
    return series_->is_quasi_static ? "path [cycles over the whole range]" : "time [s]";
  }

  /// The range of samples to draw.
  struct Range {
    std::size_t begin = 0;
    std::size_t end = 0;
  };
  [[nodiscard]] Range whole() const noexcept { return {0, series_->measured.size()}; }
  /// About four cycles, where the gap is largest.
  [[nodiscard]] Range close_up() const;

  /// Values of a range over time in seconds, or over path.
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

/// The parts of diagnosis.html, each a piece of HTML; empty where the report has nothing for it.

/// Width of a figure when two stand side by side.
inline constexpr double kHalfWidth = 560.0;  // [px]

/// The interfaces from the coordinator to the force sensor with their shares of the gap; faults are marked.
[[nodiscard]] std::string chain_part(const DiagnosisReport& report);
/// Gap before and after, floor and unknown share, at the interface and in the whole test.
[[nodiscard]] std::string shrink_part(const DiagnosisReport& report);
/// Causes and alternatives with probabilities and parameters, indistinguishable effects, next experiment.
[[nodiscard]] std::string causes_part(const DiagnosisReport& report);
/// Measured and modelled output before and after, residuals, loops or synchronisation subspace.
[[nodiscard]] std::string curves_part(const DiagnosisReport& report);
/// Where inside the interface: time, frequency, motion, distance since reversal, drifting parameters.
[[nodiscard]] std::string location_part(const DiagnosisReport& report);
/// Steps, clipping, rest readings and lag of the measured channels.
[[nodiscard]] std::string sensors_part(const DiagnosisReport& report);
/// Recordings with hashes, every interface in figures, notes.
[[nodiscard]] std::string facts_part(const DiagnosisReport& report);

}  // namespace hybridtest::report
