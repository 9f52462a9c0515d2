#include "validation/studies/rths_benchmark/rths_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "report/plotting/dot_figure.hpp"
#include "report/plotting/line_figure.hpp"
#include "report/plotting/page.hpp"
#include "validation/studies/rths_benchmark/verdict.hpp"

namespace hybridtest::rths {
namespace {

/// Histories are shown for the most sensitive case, under its strongest motion.
constexpr int kShownCase = 4;
constexpr std::size_t kShownMotion = 0;
constexpr double kShownSpanS = 6.0;
constexpr std::array<std::string_view, 5> kShown{"released_controller", "newmark_kinematics+pi", "adaptive_time_series",
                                                 "feedforward_lqg", kOurs};

std::vector<double> in_millimetres(const std::vector<double>& metres, std::size_t begin, std::size_t end) {
  std::vector<double> values;
  for (std::size_t i = begin; i < std::min(end, metres.size()); ++i) values.push_back(1e3 * metres[i]);
  return values;
}

std::string floor_figure(std::span<const CandidateMeans> means) {
  plot::DotFigure figure{.title = "J2 of the measured displacement, and its floor from sensor noise",
                         .axis = {.label = "mean over runs [%]", .is_logarithmic = true},
                         .marks = {"J2", "floor of J2"},
                         .rows = {}};
  for (const CandidateMeans& m : means) {
    if (m.lost == m.runs) continue;
    figure.rows.push_back(
        {m.name, {m.j2, m.reference_floor}, fmt::format("{:.3f}", m.j2), m.standing == Standing::ours});
  }
  return to_svg(figure);
}

/// Share of a candidate's runs that stay below a value.
plot::Line distribution(const std::string& name, std::vector<double> values, std::size_t of) {
  std::ranges::sort(values);
  plot::Line line{.name = name, .x = {}, .y = {}, .is_emphasised = name == kOurs};
  for (std::size_t i = 0; i < values.size(); ++i) {
    line.x.push_back(values[i]);
    line.y.push_back(100.0 * static_cast<double>(i + 1) / static_cast<double>(of));
  }
  return line;
}

std::string distribution_figure(const std::vector<Candidate>& candidates, std::span<const StudyRun> runs) {
  plot::Panel tracking{"tracking error without sensor noise",
                       {.label = "J2 of the true displacement [%]", .is_logarithmic = true},
                       {.label = "runs below [%]", .low = 0.0, .high = 100.0},
                       {}};
  plot::Panel structure{"error of the structure",
                        {.label = "J6 [%]", .is_logarithmic = true},
                        {.label = "runs below [%]", .low = 0.0, .high = 100.0},
                        {}};
  const std::size_t each = runs.size() / candidates.size();
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (std::ranges::find(kShown, candidates[i].name) == kShown.end()) continue;
    std::vector<double> true_j2;
    std::vector<double> j6;
    for (const StudyRun& run : runs.subspan(i * each, each)) {
      if (run.is_lost()) continue;
      true_j2.push_back(run.result.true_tracking_percent);
      j6.push_back(run.result.criteria.j(6));
    }
    tracking.lines.push_back(distribution(candidates[i].name, std::move(true_j2), each));
    structure.lines.push_back(distribution(candidates[i].name, std::move(j6), each));
  }
  return to_svg(plot::LineFigure{{std::move(tracking), std::move(structure)}, 2, 600.0, 320.0});
}

std::string history_figure(const BenchmarkInputs& inputs, const std::vector<Candidate>& candidates,
                           const StudySettings& settings) {
  const auto& floor_3_m = inputs.reference(kShownCase, kShownMotion).displacement_m[2];
  const auto peak = std::ranges::max_element(floor_3_m, {}, [](double value) { return std::abs(value); });
  const auto at_peak = static_cast<std::size_t>(peak - floor_3_m.begin());
  const auto span = static_cast<std::size_t>(kShownSpanS * kSampleRateHz);
  const std::size_t begin = at_peak > span / 2 ? at_peak - span / 2 : 0;
  const std::size_t end = std::min(begin + span, floor_3_m.size());
  std::vector<double> times_s;
  for (std::size_t i = begin; i < end; ++i) times_s.push_back(static_cast<double>(i) * kPeriodS);

  plot::Panel floor{"third floor", {.label = "time [s]"}, {.label = "displacement [mm]"}, {}};
  plot::Panel error{"tracking error of the specimen", {.label = "time [s]"}, {.label = "true error [mm]"}, {}};
  floor.lines.push_back({"reference", times_s, in_millimetres(floor_3_m, begin, end), true});
  for (const Candidate& candidate : candidates) {
    if (std::ranges::find(kShown, candidate.name) == kShown.end()) continue;
    const TestHistory history = run_for_history(inputs, candidate, kShownCase, kShownMotion, 0, settings);
    floor.lines.push_back({candidate.name, times_s, in_millimetres(history.floor_3_m, begin, end)});
    if (candidate.standing == Standing::yardstick) continue;  // so large that the others would not be visible
    std::vector<double> error_m = history.true_m;
    for (std::size_t i = 0; i < error_m.size(); ++i) error_m[i] -= history.target_m[i];
    error.lines.push_back({candidate.name, times_s, in_millimetres(error_m, begin, end)});
  }
  return to_svg(plot::LineFigure{{std::move(floor), std::move(error)}, 1, 1200.0, 300.0});
}

}  // namespace

std::string error_figure(const BenchmarkInputs& inputs, const std::vector<Candidate>& candidates,
                         std::span<const StudyRun> runs) {
  plot::DotFigure figure{
      .title = "Errors on the virtual RTHS benchmark, means over the runs that were not lost",
      .axis = {.label = "[%]", .is_logarithmic = true},
      .marks = {"true tracking error, perturbed plants", "J6, second floor", "J4, measured against reference"},
      .rows = {}};
  for (const CandidateMeans& m : means_of(inputs, candidates, runs)) {
    figure.rows.push_back({m.name,
                           {m.true_perturbed, m.j6, m.j4},
                           m.lost == 0 ? "" : fmt::format("lost {} of {}", m.lost, m.runs),
                           m.standing == Standing::ours});
  }
  return to_svg(figure);
}

std::string page_html(const BenchmarkInputs& inputs, const std::vector<Candidate>& candidates,
                      std::span<const StudyRun> runs, const StudySettings& settings) {
  return plot::html_page(
      "Delay compensation on the virtual RTHS benchmark",
      fmt::format("{} runs of each compensator, seed {}. Numbers in summary.md, table.csv and tracking.csv.",
                  runs.size() / candidates.size(), settings.seed),
      {
          {"All compensators", "Lost runs are left out of the means.", error_figure(inputs, candidates, runs)},
          {"J2 and its floor",
           "Noise of the displacement sensor sets a floor for J2. Where J2 is below its floor, the structure moves "
           "more "
           "than the reference.",
           floor_figure(means_of(inputs, candidates, runs))},
          {"Distribution over the runs", "Every case, motion and plant.", distribution_figure(candidates, runs)},
          {"Histories",
           fmt::format("Case {}, {}, nominal plant, around the reference's peak.", kShownCase,
                       kMotionNames[kShownMotion]),
           history_figure(inputs, candidates, settings)},
      });
}

}  // namespace hybridtest::rths
