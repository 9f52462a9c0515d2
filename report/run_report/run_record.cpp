#include "report/run_report/run_record.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <exception>
#include <limits>
#include <tuple>

#include "recording/error.hpp"
#include "recording/summary/clock_relation.hpp"
#include "report/run_report/tuning.hpp"

namespace hybridtest::run_report {
namespace {

constexpr std::string_view kStepsTable = "steps";
constexpr std::string_view kControlTable = "control";
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
/// Model times are sums of control periods: a row this share of a period before the end is at the end.
constexpr double kSamePlace = 0.25;

const TableLayout* table_of(const RunFileReader& file, std::string_view name) {
  const auto found = std::ranges::find(file.tables(), name, &TableLayout::name);
  return found == file.tables().end() ? nullptr : &*found;
}

/// The last model time of a table; 0 without any.
double end_of(const RunFileReader& file, std::string_view table) {
  const TableLayout* layout = table_of(file, table);
  const auto time = layout == nullptr ? std::nullopt : layout->position("model_time_s");
  const std::size_t rows = file.row_count(table);
  if (!time || rows == 0) return 0.0;
  const std::vector<double> last = file.rows(table, rows - 1, 1);
  return last.size() > *time && std::isfinite(last[*time]) ? last[*time] : 0.0;
}

/// The largest power of two up to a segment of the estimate.
std::size_t segment_samples(double period_s, double duration_s) {
  const double samples = std::min(kSegment_s, kSegmentShare * duration_s) / period_s;
  return samples < 16.0 ? 0 : std::bit_floor(static_cast<std::size_t>(samples));
}

/// Signals of one interface degree of freedom among those of a site; the position is -1 without one.
struct SiteColumns {
  std::string dof;
  std::ptrdiff_t target = -1;
  std::ptrdiff_t measured = -1;
  std::ptrdiff_t force = -1;
};

std::vector<SiteColumns> site_columns(const std::vector<SignalName>& names) {
  std::vector<SiteColumns> all;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i].name == "target_displacement") all.push_back({.dof = names[i].subject});
  }
  for (SiteColumns& columns : all) {
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (names[i].subject != columns.dof) continue;
      if (names[i].name == "target_displacement") columns.target = static_cast<std::ptrdiff_t>(i);
      if (names[i].name == "measured_displacement") columns.measured = static_cast<std::ptrdiff_t>(i);
      if (names[i].name == "force") columns.force = static_cast<std::ptrdiff_t>(i);
    }
  }
  return all;
}

/// Loops, subspaces and transfer estimates of a site, while its rows are read.
class SiteDofBuilder {
 public:
  SiteDofBuilder(SiteColumns columns, double duration_s)
      : columns_{std::move(columns)}, duration_s_{duration_s}, loop_{kLoopPoints}, subspace_{kLoopPoints} {}

  void add(double time_s, std::span<const double> values) {
    const auto value = [&](std::ptrdiff_t at) { return at < 0 ? kNaN : values[static_cast<std::size_t>(at)]; };
    const double target_m = value(columns_.target);
    const double measured_m = value(columns_.measured);
    loop_.add(measured_m, value(columns_.force));
    subspace_.add(target_m, measured_m);
    if (!estimate_ && time_s > last_time_s_) {  // false before there are two rows
      const double period_s = time_s - last_time_s_;
      if (const std::size_t samples = segment_samples(period_s, duration_s_); samples > 0) {
        estimate_.emplace(period_s, samples);
      }
    }
    last_time_s_ = time_s;
    if (estimate_) estimate_->add(target_m, measured_m);
  }

  [[nodiscard]] SiteDof take() {
    return {columns_.dof, loop_.take(), subspace_.take(),
            estimate_ ? estimate_->points() : std::vector<TransferPoint>{}};
  }

 private:
  SiteColumns columns_;
  double duration_s_;
  plot::LoopThinner loop_;
  plot::LoopThinner subspace_;
  std::optional<TransferEstimate> estimate_;
  double last_time_s_ = kNaN;
};

/// Rows of a site from the start of the test to its last measured step; interlocks to the end of the file, because one
/// that trips does so after the last step.
void read_control(const RunFileReader& file, const SubstructureScenario* scenario, SubstructureRecord& record) {
  const TableLayout& table = *table_of(file, kControlTable);
  const auto model_time = table.position("model_time_s");
  const auto site_time = table.position("time_s");
  if (!model_time) return;
  const double end_s = end_of(file, kStepsTable) > 0.0 ? end_of(file, kStepsTable) : end_of(file, kControlTable);
  CurveBuilder signals{scenario != nullptr ? site_signals(*scenario, table) : column_signals(table), end_s};
  std::optional<CurveBuilder> interlocks;
  if (scenario != nullptr) interlocks.emplace(interlock_signals(*scenario, table), end_s);
  std::vector<SiteDofBuilder> dofs;
  for (SiteColumns& columns : site_columns(signals.names())) dofs.emplace_back(std::move(columns), end_s);
  double before_s = kNaN;
  bool has_started = false;
  bool has_ended = false;
  read_rows(file, kControlTable, [&](std::span<const double> row) {
    const double time_s = row[*model_time];
    has_started = has_started || time_s > before_s;
    const double period_s = time_s - before_s;
    before_s = time_s;
    if (!has_started) return true;
    if (interlocks) interlocks->add(time_s, row);
    if (has_ended) return interlocks.has_value();
    signals.add(time_s, row);
    for (SiteDofBuilder& dof : dofs) dof.add(site_time ? row[*site_time] : time_s, signals.values());
    has_ended = time_s >= end_s - kSamePlace * period_s;
    return true;
  });
  record.signals = signals.take();
  if (interlocks) record.interlocks = interlocks->take();
  for (SiteDofBuilder& dof : dofs) record.dofs.push_back(dof.take());
}

void read_steps(const RunFileReader& file, std::unique_ptr<DerivedSignals> signals, std::vector<SignalCurve>& curves) {
  const TableLayout& table = *table_of(file, kStepsTable);
  const auto time = table.position("model_time_s");
  if (!time) return;
  CurveBuilder builder{std::move(signals), end_of(file, kStepsTable)};
  read_rows(file, kStepsTable, [&](std::span<const double> row) {
    builder.add(row[*time], row);
    return true;
  });
  curves = builder.take();
}

void read_lateness(const RunFileReader& file, TimeHistogram& histogram) {
  const TableLayout* table = table_of(file, "loop_start_lateness");
  if (table == nullptr) return;
  const auto begin = table->position("begin_us");
  const auto count = table->position("count");
  if (!begin || !count) return;
  read_rows(file, table->name, [&](std::span<const double> row) {
    histogram.add(row[*begin], row[*count]);
    return true;
  });
}

void read_substructure(const RunFileReader& file, const SubstructureScenario* scenario, SubstructureRecord& record) {
  record.has_file = true;
  record.is_site = file.header().role == Role::experimental_site;
  if (table_of(file, kControlTable) != nullptr) {
    read_control(file, scenario, record);
  } else if (const TableLayout* steps = table_of(file, kStepsTable); steps != nullptr) {
    read_steps(file,
               scenario != nullptr && !record.is_site ? numerical_signals(*scenario, *steps) : column_signals(*steps),
               record.signals);
  }
  read_lateness(file, record.lateness);
}

/// By the index that the coordinator's tables use; nullptr for one that is not there.
std::vector<SubstructureRecord*> in_order_of(const RunFileReader& file,
                                             std::vector<SubstructureRecord>& substructures) {
  std::vector<SubstructureRecord*> by_index;
  for (const std::string& id : file.header().substructure_ids) {
    const auto found = std::ranges::find(substructures, id, &SubstructureRecord::id);
    by_index.push_back(found == substructures.end() ? nullptr : &*found);
  }
  return by_index;
}

void read_exchanges(const RunFileReader& file, std::vector<SubstructureRecord>& substructures) {
  const TableLayout* table = table_of(file, "exchanges");
  if (table == nullptr) return;
  const auto who = table->position("substructure");
  const auto time = table->position("round_trip_us");
  if (!who || !time) return;
  const std::vector<SubstructureRecord*> by_index = in_order_of(file, substructures);
  read_rows(file, table->name, [&](std::span<const double> row) {
    const double index = row[*who];
    if (!(index >= 0.0) || index >= static_cast<double>(by_index.size())) return true;
    if (SubstructureRecord* record = by_index[static_cast<std::size_t>(index)]) record->round_trip.add(row[*time]);
    return true;
  });
}

/// Sums of what happens now and then, as stairs.
class StairBuilder {
 public:
  explicit StairBuilder(double end_s) : thinner_{0.0, end_s, kHistoryColumns}, end_s_{end_s} {}

  void add(double time_s, double more) {
    if (!has_any_) thinner_.add(0.0, 0.0);
    has_any_ = true;
    // A column keeps the lowest and the highest value in it, which may not be the last: the next one begins with that.
    const double next_s = last_s_ + end_s_ / static_cast<double>(kHistoryColumns);
    if (next_s < time_s) thinner_.add(next_s, sum_);
    thinner_.add(time_s, sum_);
    sum_ += more;
    thinner_.add(time_s, sum_);
    last_s_ = time_s;
  }
  [[nodiscard]] plot::Points take() {
    if (has_any_) thinner_.add(end_s_, sum_);
    return thinner_.take();
  }

 private:
  plot::HistoryThinner thinner_;
  double end_s_;
  double last_s_ = 0.0;
  double sum_ = 0.0;
  bool has_any_ = false;
};

void read_bridges(const RunFileReader& file, double end_s, std::vector<SubstructureRecord>& substructures) {
  const TableLayout* table = table_of(file, "bridges");
  if (table == nullptr) return;
  const auto step = table->position("step");
  const auto who = table->position("substructure");
  const auto energy_j = table->position("energy_added_j");
  const double step_s = file.header().model_time_step_s;
  if (!step || !who || !energy_j || !(step_s > 0.0)) return;
  const std::vector<SubstructureRecord*> by_index = in_order_of(file, substructures);
  std::vector<std::pair<StairBuilder, StairBuilder>> sums(by_index.size(), {StairBuilder{end_s}, StairBuilder{end_s}});
  read_rows(file, table->name, [&](std::span<const double> row) {
    const double index = row[*who];
    if (!(index >= 0.0) || index >= static_cast<double>(sums.size())) return true;
    auto& [bridges, energy] = sums[static_cast<std::size_t>(index)];
    bridges.add(row[*step] * step_s, 1.0);
    if (std::isfinite(row[*energy_j])) energy.add(row[*step] * step_s, row[*energy_j]);
    return true;
  });
  for (std::size_t i = 0; i < sums.size(); ++i) {
    if (by_index[i] == nullptr) continue;
    by_index[i]->bridges = sums[i].first.take();
    by_index[i]->bridged_energy_j = sums[i].second.take();
  }
}

void read_scenario_of(RunRecord& run) {
  const std::filesystem::path file = run.directory / "scenario.yaml";
  if (!std::filesystem::exists(file)) {
    run.why_no_scenario = "the run directory has no scenario.yaml";
    return;
  }
  try {
    run.scenario = read_scenario(file, {});
  } catch (const std::exception& error) {  // of another version, or one of its files is gone
    run.why_no_scenario = error.what();
  }
}

/// Readable run files, the coordinator's first.
std::vector<RunFileReader> open_files(RunRecord& run) {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator{run.directory}) {
    if (entry.path().extension() == kRunFileExtension) paths.push_back(entry.path());
  }
  std::ranges::sort(paths);
  std::vector<RunFileReader> files;
  for (const std::filesystem::path& path : paths) {
    try {
      files.emplace_back(path);
    } catch (const RecordingError& error) {
      run.unread.emplace_back(error.what());
    }
  }
  std::stable_partition(files.begin(), files.end(),
                        [](const auto& file) { return file.header().role == Role::coordinator; });
  return files;
}

/// In the order of model time, then by the coordinator's clock, each once: participants record what they hear from each
/// other.
void put_in_order(std::vector<RecordedEvent>& events, const std::vector<ParticipantClock>& clocks) {
  const auto time_s = [&](const Event& event) {
    const auto clock = std::ranges::find(clocks, event.source.view(), &ParticipantClock::participant);
    const double own_s = to_seconds(event.clock);
    return clock == clocks.end() ? own_s : clock->at(own_s).to_coordinator_s(own_s);
  };
  std::ranges::stable_sort(events, {}, [&](const RecordedEvent& recorded) {
    const Event& event = recorded.event;
    return std::tuple{event.model_time_s, time_s(event), event.source.view(), event.code};
  });
  const auto is_same = [](const RecordedEvent& a, const RecordedEvent& b) { return a.event == b.event; };
  events.erase(std::unique(events.begin(), events.end(), is_same), events.end());
}

}  // namespace

RunRecord read_run_record(const std::filesystem::path& directory) {
  RunRecord run;
  run.directory = directory;
  read_scenario_of(run);
  const std::vector<RunFileReader> files = open_files(run);
  const auto add_substructure = [&](const std::string& id) {
    const bool is_known = std::ranges::find(run.substructures, id, &SubstructureRecord::id) != run.substructures.end();
    if (!is_known) run.substructures.emplace_back().id = id;
  };
  for (const RunFileReader& file : files) {
    for (const std::string& id : file.header().substructure_ids) add_substructure(id);
  }
  std::vector<ParticipantClock> clocks;
  for (const RunFileReader& file : files) {
    try {
      for (RecordedEvent& event : file.events()) run.events.push_back(std::move(event));
      if (file.header().role == Role::coordinator) {
        const TableLayout* steps = table_of(file, kStepsTable);
        run.end_s = end_of(file, kStepsTable);
        if (steps != nullptr) {
          read_steps(file, run.scenario ? structure_signals(*run.scenario, *steps) : column_signals(*steps),
                     run.structure);
        }
        read_exchanges(file, run.substructures);
        read_bridges(file, run.end_s, run.substructures);
        clocks = participant_clocks(file);
        continue;
      }
      const std::string& id = file.header().participant;
      add_substructure(id);
      read_substructure(file, run.scenario ? run.scenario->find(id) : nullptr,
                        *std::ranges::find(run.substructures, id, &SubstructureRecord::id));
      run.end_s = std::max(run.end_s, end_of(file, kStepsTable));
    } catch (const RecordingError& error) {
      run.unread.emplace_back(error.what());
    }
  }
  put_in_order(run.events, clocks);
  return run;
}

bool is_run_directory(const std::filesystem::path& directory) {
  std::error_code absent;
  for (const auto& entry : std::filesystem::directory_iterator{directory, absent}) {
    if (entry.path().extension() == kRunFileExtension) return true;
  }
  return false;
}

}  // namespace hybridtest::run_report
