#include "diagnosis/page/series_view.hpp"

#include <algorithm>
#include <cmath>

#include "diagnosis/localisation/reversals.hpp"

namespace hybridtest::report {
namespace {

constexpr double kCloseUpCycles = 4.0;
constexpr double kCloseUpSteps = 8.0;  // per close-up, in looking for the worst
/// More points than a curve of a loop needs on a screen.
constexpr std::size_t kMostLoopPoints = 2000;

std::vector<double> difference(const std::vector<double>& measured, const std::vector<double>& model) {
  std::vector<double> residual(measured.size());
  for (std::size_t i = 0; i < residual.size(); ++i) residual[i] = measured[i] - model[i];
  return residual;
}

double largest_magnitude(const std::vector<double>& values) {
  double largest = 0.0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  return largest;
}

/// Samples of a cycle on average; all of them where there is none.
double samples_per_cycle(const std::vector<double>& input_m) {
  const auto turns = reversals_of(input_m, reversal_threshold_m(input_m));
  if (turns.size() < 3) return static_cast<double>(input_m.size());
  return 2.0 * static_cast<double>(turns.back().sample - turns.front().sample) / static_cast<double>(turns.size() - 1);
}

}  // namespace

SeriesView::SeriesView(const InterfaceSeries& series)
    : series_{&series}, before_{difference(series.measured, series.model)} {
  if (has_augmented()) after_ = difference(series.measured, series.augmented);
  const bool is_large = largest_magnitude(series.measured) >= 2000.0;
  output_label_ = !gives_force() ? "displacement [mm]" : is_large ? "force [kN]" : "force [N]";
  output_scale_ = !gives_force() ? kMillimetres : is_large ? 1e-3 : 1.0;
}

GapSignals SeriesView::before() const noexcept {
  return {series_->sample_period_s, series_->input_m, series_->measured, before_};
}

GapSignals SeriesView::after() const noexcept {
  return {series_->sample_period_s, series_->input_m, series_->measured, after_};
}

SeriesView::Range SeriesView::close_up() const {
  const std::size_t size = before_.size();
  const auto length =
      std::clamp<std::size_t>(static_cast<std::size_t>(kCloseUpCycles * samples_per_cycle(series_->input_m)),
                              std::min<std::size_t>(size, 32), size);
  const auto step = std::max<std::size_t>(1, static_cast<std::size_t>(static_cast<double>(length) / kCloseUpSteps));
  Range worst{0, length};
  double most = -1.0;
  for (std::size_t begin = 0; begin + length <= size; begin += step) {
    const double here = mean_square(std::span{before_}.subspan(begin, length));
    if (here <= most) continue;
    most = here;
    worst = {begin, begin + length};
  }
  return worst;
}

plot::Line SeriesView::over_time(std::string name, const std::vector<double>& values, Range range) const {
  plot::Line line{.name = std::move(name)};
  for (std::size_t i = range.begin; i < range.end; ++i) {
    line.x.push_back(static_cast<double>(i) * series_->sample_period_s);
    line.y.push_back(output_scale_ * values[i]);
  }
  return line;
}

plot::Line SeriesView::over_input(std::string name, const std::vector<double>& values, Range range) const {
  plot::Line line{.name = std::move(name)};
  const std::size_t stride = 1 + (range.end - range.begin) / kMostLoopPoints;
  for (std::size_t i = range.begin; i < range.end; i += stride) {
    line.x.push_back(kMillimetres * series_->input_m[i]);
    line.y.push_back(output_scale_ * values[i]);
  }
  return line;
}

}  // namespace hybridtest::report
