#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "diagnosis/localisation/localise.hpp"
#include "diagnosis/page/page_parts.hpp"
#include "diagnosis/page/series_view.hpp"
#include "diagnosis/page/wording.hpp"
#include "report/plotting/heat_figure.hpp"
#include "report/plotting/line_figure.hpp"

namespace hybridtest::report {
namespace {

using plot::Axis;
using plot::Line;
using plot::LineFigure;
using plot::Panel;

constexpr std::size_t kLeastSamples = 64;

/// A step curve over ranges of a quantity, in per cent of the measured output.
struct Steps {
  Line line;
  void add(double low, double high, double nrmse) {
    line.x.insert(line.x.end(), {low, high});
    line.y.insert(line.y.end(), {100.0 * nrmse, 100.0 * nrmse});
  }
};

Line floor_line(double low, double high, double floor_nrmse) {
  return {.name = "floor", .x = {low, high}, .y = {100.0 * floor_nrmse, 100.0 * floor_nrmse}, .is_background = true};
}

/// Both residuals of an interface, located.
struct Located {
  Localisation before;
  std::optional<Localisation> after;
  double floor_nrmse = 0.0;

  /// Curves of before and after over something, with the floor behind.
  template <class Add>
  [[nodiscard]] std::vector<Line> lines(Add&& add) const {
    Steps model{{.name = "model as given"}};
    add(before, model);
    std::vector<Line> result{model.line};
    if (after) {
      Steps augmented{{.name = "model with the cause added"}};
      add(*after, augmented);
      result.push_back(augmented.line);
    }
    if (!result.front().x.empty()) {
      result.insert(result.begin(), floor_line(result.front().x.front(), result.front().x.back(), floor_nrmse));
    }
    return result;
  }
};

Panel over_time(const Located& located) {
  return {
      "over time", {"time [s]"}, {"error [%]", false, 0.0}, located.lines([](const Localisation& where, Steps& steps) {
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
  return {"over the cycles",
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
  return to_svg(figure);
}

std::string maps(const Located& located) {
  std::string html = "<div class=\"pair\">" + motion_map(located.before, "share of the gap over the motion, before");
  if (located.after) html += motion_map(*located.after, "share of what is left, after");
  return html + "</div>\n";
}

/// What holds the better part of the gap, in a sentence.
std::string in_words(const Localisation& where) {
  std::vector<std::string> times;
  std::vector<std::string> bands;
  for (const TimeWindow& window : where.main_windows)
    times.push_back(fmt::format("{:.1f} to {:.1f} s", window.begin_s, window.end_s));
  for (const BandShare& band : where.main_bands)
    bands.push_back(fmt::format("{:.2f} to {:.2f} Hz", band.low_hz, band.high_hz));
  constexpr std::size_t kMostNamed = 4;
  if (times.size() > kMostNamed) times = {"many stretches of time"};
  if (bands.size() > kMostNamed) bands = {"many bands"};
  return fmt::format("<p>Half of the gap's energy lies in {}; half of it in {}.</p>\n", joined(times), joined(bands));
}

/// What a parameter goes with, and what that hints at where the recording tells it from the rest.
std::string drift_sentence(const ParameterDrift& drift) {
  std::vector<std::string> with;
  std::string hint;
  const auto note = [&](double correlation, std::string_view what, std::string_view meaning) {
    if (!drift.is_significant(correlation)) return;
    with.push_back(fmt::format("{} with {}", correlation > 0.0 ? "rises" : "falls", what));
    hint = meaning;
  };
  note(drift.with_amplitude, "amplitude", "a missing nonlinearity");
  note(drift.with_time, "time", "a degradation or drift");
  note(drift.with_frequency, "frequency", "a missing dynamic");
  if (with.empty()) return "";
  if (with.size() > 1) hint = "they go together in this recording, so which one matters cannot be told";
  return fmt::format("<p>Fitted window by window, the {} {} ({}); it varies by ±{}.</p>\n",
                     drift.parameter.substr(0, drift.parameter.find('_')), joined(with), hint, percent(drift.spread));
}

std::string drift_text(const Localisation& where) {
  std::string html;
  for (const ParameterDrift& drift : where.drifts) html += drift_sentence(drift);
  return html;
}

}  // namespace

std::string location_part(const DiagnosisReport& report) {
  if (report.series.empty() || report.series.front().measured.size() < kLeastSamples) return "";
  const SeriesView view{report.series.front()};
  const InterfaceKind kind = view.gives_force() ? InterfaceKind::force_out : InterfaceKind::displacement_out;
  Located located{.before = localise(view.before(), kind), .after = {}};
  if (view.has_augmented()) located.after = localise(view.after(), kind);
  const auto gap = std::ranges::find(report.where, view.series().interface, &InterfaceGap::interface);
  if (gap != report.where.end()) located.floor_nrmse = gap->floor_nrmse;
  const LineFigure figure{
      .panels = {over_time(located), over_frequency(located), over_reversal(located), over_cycles(located)},
      .columns = 2,
      .panel_width = kHalfWidth,
      .panel_height = 230.0};
  return "<h2>Where inside the " + plain(view.series().interface) + "</h2>\n" + in_words(located.before) +
         drift_text(located.before) + to_svg(figure) + maps(located);
}

}  // namespace hybridtest::report
