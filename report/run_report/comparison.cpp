#include "report/run_report/comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>

#include "core/config_error.hpp"
#include "recording/error.hpp"
#include "recording/summary/reference_comparison.hpp"
#include "report/run_report/history_source.hpp"
#include "report/run_report/scenario_differences.hpp"
#include "report/run_report/tuning.hpp"

namespace hybridtest::run_report {
namespace {

namespace fs = std::filesystem;

const std::array<std::string, 1> kStructureColumns{"displacement_"};
const std::array<std::string, 2> kSiteColumns{"measured_displacement_m", "measured_force_n"};

/// Adds up the difference of two histories.
class DifferenceSum {
 public:
  void add(double value, double other) noexcept {
    if (!std::isfinite(value) || !std::isfinite(other)) return;
    ++count_;
    peak_ = std::max(peak_, std::abs(value));
    other_peak_ = std::max(other_peak_, std::abs(other));
    largest_ = std::max(largest_, std::abs(value - other));
    squares_ += (value - other) * (value - other);
    other_squares_ += other * other;
  }
  [[nodiscard]] bool is_empty() const noexcept { return count_ == 0; }
  [[nodiscard]] Difference result(std::string signal, std::string unit) const {
    Difference difference{std::move(signal), std::move(unit), peak_, other_peak_, {}, {}};
    if (other_squares_ > 0.0) difference.rms_relative = std::sqrt(squares_ / other_squares_);
    if (other_peak_ > 0.0) difference.peak_relative = largest_ / other_peak_;
    return difference;
  }

 private:
  std::size_t count_ = 0;
  double peak_ = 0.0;
  double other_peak_ = 0.0;
  double largest_ = 0.0;
  double squares_ = 0.0;
  double other_squares_ = 0.0;
};

/// A history at any later time: interpolated between its steps.
class Interpolated {
 public:
  explicit Interpolated(HistorySource& source) : source_{source}, before_(source.columns().size()), after_(before_) {
    has_after_ = read();
    before_ = after_;
    before_s_ = after_s_;
  }
  /// Moves on to a time; false beyond its ends.
  bool move_to(double time_s) {
    while (has_after_ && after_s_ < time_s - kSameTime_s) {
      before_ = after_;
      before_s_ = after_s_;
      has_after_ = read();
    }
    time_s_ = time_s;
    return has_after_ && time_s >= before_s_ - kSameTime_s;
  }
  [[nodiscard]] double value(std::size_t column) const noexcept {
    const double span_s = after_s_ - before_s_;
    if (!(span_s > 0.0) || after_s_ - time_s_ <= kSameTime_s) return after_[column];
    const double share = std::max(0.0, (time_s_ - before_s_) / span_s);
    return before_[column] + share * (after_[column] - before_[column]);
  }

 private:
  /// Sums of steps differ from their products by rounding.
  static constexpr double kSameTime_s = 1e-9;

  bool read() {
    if (!source_.next()) return false;
    after_s_ = source_.time_s();
    after_.assign(source_.values().begin(), source_.values().end());
    return true;
  }

  HistorySource& source_;
  std::vector<double> before_;
  std::vector<double> after_;
  double before_s_ = 0.0;
  double after_s_ = 0.0;
  double time_s_ = 0.0;
  bool has_after_ = false;
};

struct NamedSignal {
  std::string name;  // for people
  std::string unit;
};

/// `displacement_floor_1_m` as `displacement floor_1`, in m.
NamedSignal named(const std::string& column) {
  std::string name = column;
  std::string unit;
  for (const auto& [ending, its_unit] : {std::pair{std::string{"_m"}, "m"}, std::pair{std::string{"_n"}, "N"}}) {
    const std::size_t at = name.rfind(ending);
    // At the end, or before the number of a degree of freedom.
    const bool is_unit = at != std::string::npos && name.find_first_not_of("_0123456789", at + 2) == std::string::npos;
    if (!is_unit) continue;
    unit = its_unit;
    name.erase(at, 2);
    break;
  }
  for (const char* quantity : {"measured_displacement", "measured_force", "displacement", "force"}) {
    const std::string words = quantity;
    if (!name.starts_with(words)) continue;
    std::string rest = name.substr(words.size());
    if (rest.starts_with('_')) rest[0] = ' ';
    std::string spaced = words;
    std::ranges::replace(spaced, '_', ' ');
    return {spaced + rest, unit};
  }
  return {name, unit};
}

/// The differences of all columns that both have.
void add_differences(HistorySource& source, HistorySource& other, const std::string& subject,
                     std::vector<Difference>& differences) {
  struct Pair {
    std::size_t here = 0;
    std::size_t there = 0;
    DifferenceSum sum{};
  };
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < source.columns().size(); ++i) {
    const auto found = std::ranges::find(other.columns(), source.columns()[i].name, &HistoryColumn::name);
    if (found != other.columns().end()) pairs.push_back({i, static_cast<std::size_t>(found - other.columns().begin())});
  }
  if (pairs.empty()) return;
  Interpolated reference{other};
  while (source.next()) {
    if (!reference.move_to(source.time_s())) continue;
    for (Pair& pair : pairs) pair.sum.add(source.values()[pair.here], reference.value(pair.there));
  }
  for (const Pair& pair : pairs) {
    if (pair.sum.is_empty()) continue;
    const NamedSignal signal = named(source.columns()[pair.here].name);
    differences.push_back(pair.sum.result((subject.empty() ? "" : subject + ": ") + signal.name, signal.unit));
  }
}

/// The file of a participant; empty when it cannot be read.
std::optional<RunFileReader> file_of(const fs::path& run, std::string_view participant) {
  try {
    return RunFileReader{run / (std::string{participant} + std::string{kRunFileExtension})};
  } catch (const RecordingError&) {
    return {};
  }
}

void compare_runs(const RunRecord& run, const fs::path& other, Compared& compared) {
  const auto compare = [&](std::string_view participant, std::span<const std::string> columns,
                           const std::string& subject) {
    const auto here = file_of(run.directory, participant);
    const auto there = file_of(other, participant);
    if (!here || !there) return;
    TableHistory source{*here, "steps", columns};
    TableHistory reference{*there, "steps", columns};
    add_differences(source, reference, subject, compared.differences);
  };
  compare(kCoordinatorId, kStructureColumns, "");
  for (const SubstructureRecord& substructure : run.substructures) {
    if (substructure.is_site) compare(substructure.id, kSiteColumns, substructure.id);
  }
}

Compared compared_run(const fs::path& other, const RunRecord& run) {
  RunRecord record = read_run_record(other);
  Compared compared{.label = other.filename().string(), .what = "the run " + other.string()};
  compare_runs(run, other, compared);
  compared.structure = std::move(record.structure);
  compared.substructures = std::move(record.substructures);
  if (run.scenario && record.scenario) {
    for (const DiffLine& line : scenario_differences(record.scenario->effective, run.scenario->effective)) {
      compared.scenario_differences.push_back((line.kind == DiffLine::Kind::added ? "here: " : "there: ") + line.text);
    }
  }
  return compared;
}

Compared compared_csv(const fs::path& file, const RunRecord& run) {
  Compared compared{.label = file.stem().string(), .what = "the histories in " + file.string()};
  CsvHistory curves{file};
  std::vector<plot::HistoryThinner> thinners(curves.columns().size(),
                                             plot::HistoryThinner{0.0, run.end_s, kHistoryColumns});
  while (curves.next()) {
    for (std::size_t i = 0; i < thinners.size(); ++i) thinners[i].add(curves.time_s(), curves.values()[i]);
  }
  for (std::size_t i = 0; i < thinners.size(); ++i) {
    constexpr std::string_view kBegin = "displacement_";
    const std::string& column = curves.columns()[i].name;
    if (!column.starts_with(kBegin) || !column.ends_with("_m") || column.size() < kBegin.size() + 2) continue;
    const std::string dof = column.substr(kBegin.size(), column.size() - kBegin.size() - 2);
    compared.structure.push_back({.name = {"displacement", dof, "m"}, .points = thinners[i].take(), .values = 1});
  }
  if (const auto here = file_of(run.directory, kCoordinatorId)) {
    TableHistory source{*here, "steps", kStructureColumns};
    CsvHistory reference{file};
    add_differences(source, reference, "", compared.differences);
  }
  return compared;
}

/// A row of prediction.csv, as diagnosis/runs/prediction_file.hpp has it.
struct PredictionRow {
  std::string title;
  std::string unit;
  double time_s = 0.0;
  double measured = 0.0;
  double modelled = 0.0;
  std::optional<double> completed;
};

PredictionRow prediction_row(const std::string& line, const fs::path& file, std::size_t number) {
  std::array<std::string, 8> cells;
  std::istringstream stream{line};
  for (std::size_t i = 0; i < cells.size(); ++i) std::getline(stream, cells[i], i + 1 < cells.size() ? ',' : '\n');
  const auto value = [&](std::size_t cell) {
    double result = 0.0;
    const auto [end, error] = std::from_chars(cells[cell].data(), cells[cell].data() + cells[cell].size(), result);
    if (error != std::errc{} || end != cells[cell].data() + cells[cell].size()) {
      throw ConfigError{
          fmt::format("{}:{}: '{}' is not a number; write the diagnosis again", file.string(), number, cells[cell])};
    }
    return result;
  };
  PredictionRow row{
      cells[0] + (cells[1] == "1" ? "" : " " + cells[1]) + ", " + cells[7], cells[2], value(3), value(4), value(5), {}};
  if (!cells[6].empty()) row.completed = value(6);
  return row;
}

void append(plot::Points& points, double x, double y) {
  points.x.push_back(x);
  points.y.push_back(y);
}

/// Of one site: each interface with its differences. The rows of an interface stand together.
void read_predictions(const fs::path& file, Compared& compared) {
  struct Sums {
    DifferenceSum before{};
    DifferenceSum after{};
  };
  std::vector<Sums> sums;
  const std::size_t first = compared.predictions.size();
  std::ifstream stream{file};
  std::string line;
  std::getline(stream, line);
  for (std::size_t number = 2; std::getline(stream, line); ++number) {
    PredictionRow row = prediction_row(line, file, number);
    if (sums.empty() || compared.predictions.back().title != row.title) {
      sums.emplace_back();
      compared.predictions.push_back(
          {.title = row.title, .unit = row.unit, .measured = {}, .modelled = {}, .completed = {}});
    }
    Prediction& prediction = compared.predictions.back();
    append(prediction.measured, row.time_s, row.measured);
    append(prediction.modelled, row.time_s, row.modelled);
    sums.back().before.add(row.modelled, row.measured);
    if (!row.completed) continue;
    append(prediction.completed, row.time_s, *row.completed);
    sums.back().after.add(*row.completed, row.measured);
  }
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const Prediction& prediction = compared.predictions[first + i];
    compared.differences.push_back(
        sums[i].before.result(prediction.title + ": model as given, there measured", prediction.unit));
    if (sums[i].after.is_empty()) continue;
    compared.differences.push_back(
        sums[i].after.result(prediction.title + ": model with the causes, there measured", prediction.unit));
  }
}

/// The files of a diagnosis: one, or one for each site in folders of their own.
std::vector<fs::path> prediction_files(const fs::path& folder) {
  const std::string name = "prediction.csv";
  std::vector<fs::path> files;
  if (fs::exists(folder / name)) files.push_back(folder / name);
  std::error_code absent;
  for (const auto& entry : fs::directory_iterator{folder, absent}) {
    if (entry.is_directory() && fs::exists(entry.path() / name)) files.push_back(entry.path() / name);
  }
  std::ranges::sort(files);
  return files;
}

Compared compared_diagnosis(const fs::path& folder, const std::vector<fs::path>& files) {
  Compared compared{.label = folder.filename().string(), .what = "the predictions of the diagnosis " + folder.string()};
  for (const fs::path& file : files) read_predictions(file, compared);
  return compared;
}

}  // namespace

Compared read_compared(const fs::path& other, const RunRecord& run) {
  fs::path named = other;
  if (!named.has_filename()) named = named.parent_path();
  Compared compared;
  if (is_run_directory(named)) {
    compared = compared_run(named, run);
  } else if (fs::is_regular_file(named)) {
    compared = compared_csv(named, run);
  } else if (const std::vector<fs::path> files = prediction_files(named); !files.empty()) {
    compared = compared_diagnosis(named, files);
  } else {
    throw ConfigError{"--compare " + other.string() +
                      ": expected a run directory, a CSV file of `hybridtest reference`, or the folder of a diagnosis "
                      "with its prediction.csv"};
  }
  if (compared.differences.empty()) {
    throw ConfigError{"--compare " + other.string() + ": has no displacement or force that " + run.directory.string() +
                      " has, at the same time; expected columns of the same names"};
  }
  return compared;
}

std::vector<Compared> references_of(const RunRecord& run) {
  std::vector<Compared> references;
  std::vector<fs::path> files;
  std::error_code absent;
  for (const auto& entry : fs::directory_iterator{reference_folder(run.directory), absent}) {
    if (entry.path().extension() == ".csv") files.push_back(entry.path());
  }
  std::ranges::sort(files);
  for (const fs::path& file : files) {
    try {
      references.push_back(read_compared(file, run));
      references.back().label = "reference " + references.back().label;
    } catch (const ConfigError&) {  // not one of ours
    }
  }
  return references;
}

}  // namespace hybridtest::run_report
