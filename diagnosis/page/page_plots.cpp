#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/signal/frequency_evaluation.hpp"
#include "diagnosis/localisation/localise.hpp"
#include "diagnosis/localisation/tracking_screens.hpp"
#include "diagnosis/page/page_parts.hpp"
#include "diagnosis/page/wording.hpp"
#include "diagnosis/signals/signals.hpp"
#include "diagnosis/tuning.hpp"
#include "report/plotting/heat_figure.hpp"
#include "report/plotting/line_figure.hpp"
#include "report/plotting/page.hpp"
#include "report/plotting/svg_canvas.hpp"

namespace hybridtest::report {

namespace {

constexpr double kCloseUpCycles = 4.0;
constexpr double kCloseUpSteps = 8.0;  // per close-up, in the search for the largest gap
/// A loop with more points looks the same on a screen.
constexpr std::size_t kLoopPointsMax = 2000;

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

/// Mean number of samples per cycle; all samples when there is no full cycle.
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
  const std::size_t stride = 1 + (range.end - range.begin) / kLoopPointsMax;
  for (std::size_t i = range.begin; i < range.end; i += stride) {
    line.x.push_back(kMillimetres * series_->input_m[i]);
    line.y.push_back(output_scale_ * values[i]);
  }
  return line;
}

namespace {

using plot::Line;
using plot::LineFigure;
using plot::Panel;

constexpr double kWide = 900.0;
const std::string kMeasured = "measured";
const std::string kModel = "model as given";
const std::string kAugmented = "model with the causes added";

Line measured_behind(Line line) {
  line.is_background = true;
  line.signal = plot::Signal::measured;
  return line;
}

Line modelled(Line line) {
  line.signal = plot::Signal::modelled;
  return line;
}

Line completed(Line line) {
  line.signal = plot::Signal::completed;
  return line;
}

std::vector<Line> outputs(const SeriesView& view, SeriesView::Range range) {
  const InterfaceSeries& series = view.series();
  std::vector<Line> lines{measured_behind(view.over_time(kMeasured, series.measured, range)),
                          modelled(view.over_time(kModel, series.model, range))};
  if (view.has_augmented()) lines.push_back(completed(view.over_time(kAugmented, series.augmented, range)));
  return lines;
}

std::vector<Line> residuals(const SeriesView& view, SeriesView::Range range) {
  const auto values = [](const GapSignals& signals) {
    return std::vector<double>(signals.residual.begin(), signals.residual.end());
  };
  std::vector<Line> lines{modelled(view.over_time(kModel, values(view.before()), range))};
  if (view.has_augmented()) lines.push_back(completed(view.over_time(kAugmented, values(view.after()), range)));
  return lines;
}

std::string histories(const SeriesView& view) {
  const SeriesView::Range close_up = view.close_up();
  LineFigure figure{
      .panels = {{"the whole recording", {view.time_label()}, {view.output_label()}, outputs(view, view.whole())},
                 {"measured less modelled", {view.time_label()}, {view.output_label()}, residuals(view, view.whole())},
                 {"where the gap is largest", {view.time_label()}, {view.output_label()}, outputs(view, close_up)},
                 {"measured less modelled", {view.time_label()}, {view.output_label()}, residuals(view, close_up)}},
      .columns = 1,
      .panel_width = kWide,
      .panel_height = 210.0};
  return plot::scrolling(to_svg(figure));
}

/// Force over displacement of a specimen, measured over commanded of a transfer system.
std::string loops(const SeriesView& view) {
  const InterfaceSeries& series = view.series();
  const SeriesView::Range range = view.close_up();
  const std::string input = view.gives_force() ? "displacement [mm]" : "command [mm]";
  const std::string title = view.gives_force() ? "force over displacement" : "synchronisation subspace";
  const Line measured = measured_behind(view.over_input(kMeasured, series.measured, range));
  std::vector<Panel> panels{{title + ", before",
                             {input},
                             {view.output_label()},
                             {measured, modelled(view.over_input(kModel, series.model, range))}}};
  if (view.has_augmented()) {
    panels.push_back({title + ", after",
                      {input},
                      {view.output_label()},
                      {measured, completed(view.over_input(kAugmented, series.augmented, range))}});
  }
  const std::string figure = plot::scrolling(to_svg(LineFigure{
      .panels = panels, .columns = static_cast<int>(panels.size()), .panel_width = kHalfWidth, .panel_height = 360.0}));
  return panels.size() > 1 ? figure : "<div class=\"pair\">" + figure + "</div>\n";
}

std::string tracking(const SeriesView& view) {
  const InterfaceSeries& series = view.series();
  std::vector<double> indicator = tracking_indicator_m2(series.input_m, series.measured);
  Line line{.name = "tracking indicator"};
  for (std::size_t i = 0; i < indicator.size(); ++i) {
    line.x.push_back(static_cast<double>(i) * series.sample_period_s);
    line.y.push_back(kMillimetres * kMillimetres * indicator[i]);
  }
  return plot::scrolling(to_svg(LineFigure{
      .panels = {{"tracking indicator (it rises while the actuator lags)", {"time [s]"}, {"TI [mm²]"}, {line}}},
      .columns = 1,
      .panel_width = kWide,
      .panel_height = 190.0}));
}

std::string screens_text(const SeriesView& view) {
  const InterfaceSeries& series = view.series();
  const auto evaluation = evaluate_tracking_frequency(series.input_m, series.measured, series.sample_period_s);
  if (!evaluation) return "";
  return fmt::format(
      "<p>Frequency evaluation index: amplitude {:.3f}, delay {} at {:.2f} Hz. This index and the tracking indicator "
      "show that the actuator does not follow its command, but not why: a constant delay and a lag that depends on "
      "frequency can give the same value.</p>\n",
      evaluation->amplitude, quantity(evaluation->delay_s, "s"), evaluation->frequency_hz);
}

/// The damping that the delay of the transfer system adds through the stiffness of the specimen.
std::string consequence_text(const DiagnosisReport& report, const InterfaceSeries& transfer) {
  const auto specimen = std::ranges::find_if(report.series, [&](const InterfaceSeries& series) {
    return series.unit == "N" && series.dof == transfer.dof && series.recording == transfer.recording &&
           series.measured.size() == transfer.measured.size();
  });
  if (specimen == report.series.end()) return "";
  const auto consequence =
      delay_consequence(transfer.input_m, transfer.measured, specimen->measured, transfer.sample_period_s);
  if (!consequence) return "";
  const auto monitor =
      error_monitor(transfer.input_m, transfer.measured, specimen->measured, consequence->stiffness_n_per_m);
  return fmt::format(
      "<p>In a hybrid test this delay acts like a damper of {} (−k τ, k = {}). The test becomes unstable if the "
      "structure has less damping at this degree of freedom. Hybrid simulation error monitor at the end: {:.2f} of "
      "the peak strain energy.</p>\n",
      quantity(consequence->equivalent_damping_n_s_per_m, "N s/m"), quantity(consequence->stiffness_n_per_m, "N/m"),
      monitor.back());
}

std::string heading(const InterfaceSeries& series) {
  return fmt::format("<h2>Measured and modelled output: {}</h2>\n<p class=\"fine\">{}, {}{}</p>\n",
                     plot::escaped(plain(series.interface)), plot::escaped(series.recording),
                     series.is_held_out ? "held out" : "used for the fit",
                     series.dof > 0 ? fmt::format(", degree of freedom {}", series.dof + 1) : "");
}

}  // namespace

std::string curves_part(const DiagnosisReport& report) {
  if (report.series.empty()) return "";
  const SeriesView view{report.series.front()};
  std::string html = heading(view.series()) + histories(view) + loops(view);
  const auto transfer = std::ranges::find_if(report.series, [](const auto& series) { return series.unit == "m"; });
  if (transfer == report.series.end()) return html;
  const SeriesView motion{*transfer};
  html += "<h2>Tracking of the actuator</h2>\n" + screens_text(motion) + consequence_text(report, *transfer);
  html += tracking(motion);
  if (&*transfer != &view.series()) html += loops(motion);
  return html;
}

namespace {

using plot::Axis;
using plot::Line;
using plot::LineFigure;
using plot::Panel;

/// A step curve over ranges of a quantity, in per cent of the measured output.
struct Steps {
  Line line;
  void add(double low, double high, double nrmse) {
    line.x.insert(line.x.end(), {low, high});
    line.y.insert(line.y.end(), {100.0 * nrmse, 100.0 * nrmse});
  }
};

Line floor_line(double low, double high, double floor_nrmse) {
  return {
      .name = "noise floor", .x = {low, high}, .y = {100.0 * floor_nrmse, 100.0 * floor_nrmse}, .is_background = true};
}

/// The residuals of an interface before and after, by time, frequency and motion.
struct Located {
  Localisation before;
  std::optional<Localisation> after;
  double floor_nrmse = 0.0;

  /// Curves of before and after over something, with the floor behind.
  template <class Add>
  [[nodiscard]] std::vector<Line> lines(Add&& add) const {
    Steps model{{.name = "model as given", .signal = plot::Signal::modelled}};
    add(before, model);
    std::vector<Line> result{model.line};
    if (after) {
      Steps augmented{{.name = "model with the causes added", .signal = plot::Signal::completed}};
      add(*after, augmented);
      result.push_back(augmented.line);
    }
    if (!result.front().x.empty()) {
      result.insert(result.begin(), floor_line(result.front().x.front(), result.front().x.back(), floor_nrmse));
    }
    return result;
  }
};

Panel over_time(const Located& located, const SeriesView& view) {
  return {view.series().is_quasi_static ? "over the path" : "over time",
          {view.time_label()},
          {"error [%]", false, 0.0},
          located.lines([](const Localisation& where, Steps& steps) {
            for (const TimeWindow& window : where.windows) steps.add(window.begin_s, window.end_s, window.nrmse);
          })};
}

Panel over_frequency(const Located& located) {
  return {"over frequency",
          {"frequency [Hz]", true},
          {"error in the band [%]", false, 0.0},
          located.lines([](const Localisation& where, Steps& steps) {
            for (const BandShare& band : where.bands) {
              // The first band begins at zero, which a logarithmic axis does not show.
              steps.add(band.low_hz > 0.0 ? band.low_hz : 0.5 * band.high_hz, band.high_hz, band.nrmse);
            }
          })};
}

Panel over_reversal(const Located& located) {
  return {"over the distance since the last reversal",
          {"distance [mm]"},
          {"error [%]", false, 0.0},
          located.lines([](const Localisation& where, Steps& steps) {
            for (const GapBin& bin : where.since_reversal) {
              if (bin.samples > 0) steps.add(kMillimetres * bin.low, kMillimetres * bin.high, bin.nrmse);
            }
          })};
}

Panel over_cycles(const Located& located) {
  return {"over the number of cycles",
          {"cycles completed"},
          {"error [%]", false, 0.0},
          located.lines([](const Localisation& where, Steps& steps) {
            for (const GapBin& bin : where.over_cycles) {
              if (bin.samples > 0) steps.add(bin.low, bin.high, bin.nrmse);
            }
          })};
}

std::vector<std::string> edges(double peak, std::size_t bins) {
  std::vector<std::string> texts;
  for (std::size_t i = 0; i <= bins; ++i)
    texts.push_back(fmt::format("{:.3g}", peak * static_cast<double>(i) / static_cast<double>(bins)));
  return texts;
}

std::string motion_map(const Localisation& where, const std::string& title) {
  const MotionMap& map = where.motion;
  plot::HeatFigure figure{.title = title,
                          .x_label = "|displacement| [mm]",
                          .y_label = "|velocity| [mm/s]",
                          .x_edges = edges(kMillimetres * map.peak_m, map.displacement_bins),
                          .y_edges = edges(kMillimetres * map.peak_m_per_s, map.velocity_bins),
                          .shares = {}};
  for (const GapBin& cell : map.cells) figure.shares.push_back(cell.samples > 0 ? cell.share : -1.0);
  return plot::scrolling(to_svg(figure));
}

std::string maps(const Located& located) {
  std::string html =
      "<div class=\"pair\">" + motion_map(located.before, "share of the gap by displacement and velocity, before");
  if (located.after) html += motion_map(*located.after, "share of the remaining gap, after");
  return html + "</div>\n";
}

/// The times and the frequency bands that contain half of the gap, as a sentence.
std::string in_words(const Localisation& where, bool is_quasi_static) {
  std::vector<std::string> times;
  std::vector<std::string> bands;
  for (const TimeWindow& window : where.main_windows)
    times.push_back(fmt::format("{:.1f} to {:.1f}{}", window.begin_s, window.end_s, is_quasi_static ? "" : " s"));
  for (const BandShare& band : where.main_bands)
    bands.push_back(fmt::format("{:.2f} to {:.2f} Hz", band.low_hz, band.high_hz));
  constexpr std::size_t kNamedMax = 4;
  if (times.size() > kNamedMax) times = {is_quasi_static ? "many separate stretches" : "many separate time intervals"};
  if (bands.size() > kNamedMax) bands = {"many separate frequency bands"};
  if (is_quasi_static) {
    return fmt::format("<p>Half of the energy of the gap is in the path {}, in cycles over the whole range.</p>\n",
                       joined(times));
  }
  return fmt::format("<p>Half of the energy of the gap is in the time {}. By frequency, half of it is in {}.</p>\n",
                     joined(times), joined(bands));
}

/// What a parameter is correlated with, and the likely reason if it is correlated with one quantity only.
std::string drift_sentence(const ParameterDrift& drift) {
  std::vector<std::string> with;
  std::string hint;
  const auto note = [&](double correlation, std::string_view what, std::string_view meaning) {
    if (!drift.is_significant(correlation)) return;
    with.push_back(fmt::format("{} with {}", correlation > 0.0 ? "rises" : "falls", what));
    hint = meaning;
  };
  note(drift.with_amplitude, "amplitude", "a sign of a missing nonlinearity");
  note(drift.with_time, "time", "a sign of degradation or drift");
  note(drift.with_frequency, "frequency", "a sign of missing dynamics");
  if (with.empty()) return "";
  if (with.size() > 1) hint = "these quantities are correlated in this recording; it cannot show which one matters";
  return fmt::format("<p>Fitted in each time window, the {} {} ({}); it varies by ±{}.</p>\n",
                     drift.parameter.substr(0, drift.parameter.find('_')), joined(with), hint, percent(drift.spread));
}

std::string drift_text(const Localisation& where) {
  std::string html;
  for (const ParameterDrift& drift : where.drifts) html += drift_sentence(drift);
  return html;
}

/// Of a quasi-static recording only what has no time, frequency or velocity in it.
std::string location_without_time(const Located& located, const SeriesView& view) {
  const LineFigure figure{.panels = {over_time(located, view), over_reversal(located), over_cycles(located)},
                          .columns = 2,
                          .panel_width = kHalfWidth,
                          .panel_height = 230.0};
  return "<h2>The gap at the " + plain(view.series().interface) + " by path and motion</h2>\n" +
         in_words(located.before, true) + plot::scrolling(to_svg(figure));
}

}  // namespace

std::string location_part(const DiagnosisReport& report) {
  if (report.series.empty() || report.series.front().measured.size() < tuning::kLocaliseSamplesMin) return "";
  const SeriesView view{report.series.front()};
  const InterfaceKind kind = view.gives_force() ? InterfaceKind::force_out : InterfaceKind::displacement_out;
  Located located{.before = localise(view.before(), kind), .after = {}};
  if (view.has_augmented()) located.after = localise(view.after(), kind);
  const auto gap = std::ranges::find(report.where, view.series().interface, &InterfaceGap::interface);
  if (gap != report.where.end()) located.floor_nrmse = gap->floor_nrmse;
  if (view.series().is_quasi_static) return location_without_time(located, view);
  const LineFigure figure{
      .panels = {over_time(located, view), over_frequency(located), over_reversal(located), over_cycles(located)},
      .columns = 2,
      .panel_width = kHalfWidth,
      .panel_height = 230.0};
  return "<h2>The gap at the " + plain(view.series().interface) + " by time, frequency and motion</h2>\n" +
         in_words(located.before, false) + drift_text(located.before) + plot::scrolling(to_svg(figure)) + maps(located);
}

}  // namespace hybridtest::report
