#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "recording/error.hpp"
#include "recording/run_file.hpp"
#include "report/run_index/run_index.hpp"
#include "runtime/run_directory.hpp"

namespace hybridtest {
namespace {

using Json = nlohmann::json;

constexpr const char* kSummary = "summary.json";
constexpr const char* kDiagnosis = "diagnosis.json";

Json read_json(const std::filesystem::path& file) {
  std::ifstream stream{file};
  if (!stream) throw RecordingError{file.filename().string() + " cannot be opened"};
  return Json::parse(stream);
}

/// A number; NaN for null, which stands for one that is not finite.
double number_of(const Json& value) {
  return value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>();
}

void take_summary(const Json& summary, RunEntry& run) {
  run.start_time_utc = summary.at("start_time_utc");
  run.test_name = summary.at("test_name");
  run.verdict = summary.at("verdict");
  run.exit_code = summary.at("exit_code");
  run.data_valid = summary.at("data_valid");
  for (const Json& peak : summary.at("peak_displacement")) {
    run.peak_displacement_m.push_back(
        {peak.at("dof"), number_of(peak.at("displacement_m")), number_of(peak.at("model_time_s"))});
  }
}

void take_summary(RunSummary&& summary, RunEntry& run) {
  run.verdict = verdict(summary);
  run.start_time_utc = std::move(summary.start_time_utc);
  run.test_name = std::move(summary.test_name);
  run.exit_code = summary.exit_code;
  run.data_valid = summary.data_valid;
  run.peak_displacement_m = std::move(summary.peak_displacement_m);
}

/// `storey_1: named (backlash)`; without the site where there is one alone.
void take_diagnosis(const std::filesystem::path& folder, const std::string& site, RunEntry& run) {
  std::string text = site.empty() ? "" : site + ": ";
  try {
    const Json diagnosis = read_json(folder / kDiagnosis);
    text += diagnosis.at("verdict").get<std::string>();
    std::string causes;
    for (const Json& cause : diagnosis.at("causes")) {
      causes += (causes.empty() ? "" : ", ") + cause.at("effect").get<std::string>();
    }
    if (!causes.empty()) text += " (" + causes + ")";
  } catch (const std::exception& error) {
    text += std::string{"diagnosis.json cannot be read: "} + error.what();
  }
  run.diagnoses.push_back(text);
  if (const auto page = folder / "diagnosis.html"; exists(page)) run.diagnosis_pages.push_back(page);
}

/// What `--diagnose` left: in `diagnosis/`, or in one folder for each site there.
void take_diagnoses(RunEntry& run) {
  const std::filesystem::path folder = run.directory / "diagnosis";
  if (!is_directory(folder)) return;
  if (exists(folder / kDiagnosis)) take_diagnosis(folder, "", run);
  std::set<std::filesystem::path> sites;
  for (const auto& entry : std::filesystem::directory_iterator{folder}) {
    if (entry.is_directory() && exists(entry.path() / kDiagnosis)) sites.insert(entry.path());
  }
  for (const auto& site : sites) take_diagnosis(site, site.filename().string(), run);
}

std::string changed_utc(const std::filesystem::path& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return "";
  return time_utc_of(status.st_mtime);
}

RunEntry read_run(const std::filesystem::path& directory) {
  RunEntry run{.directory = directory};
  try {
    run.has_summary = exists(directory / kSummary);
    if (run.has_summary) {
      take_summary(read_json(directory / kSummary), run);
    } else {
      take_summary(summarise(directory), run);
    }
    take_diagnoses(run);
    if (const auto report = directory / "report.html"; exists(report)) run.report = report;
  } catch (const std::exception& error) {
    run = {.directory = directory, .fault = error.what()};
    run.start_time_utc = changed_utc(directory);
  }
  return run;
}

bool is_run(const std::filesystem::path& directory) {
  if (exists(directory / kSummary)) return true;
  bool has_scenario = false;
  bool has_recording = false;
  for (const auto& entry : std::filesystem::directory_iterator{directory}) {
    has_scenario = has_scenario || entry.path().filename() == "scenario.yaml";
    has_recording = has_recording || entry.path().extension() == kRunFileExtension;
  }
  return has_recording || (has_scenario && exists(directory / "events.log"));
}

/// A folder that cannot be listed is an entry too. Symbolic links are not followed, so that the search ends.
void search(const std::filesystem::path& folder, std::vector<RunEntry>& runs) {
  try {
    if (is_run(folder)) {
      runs.push_back(read_run(folder));
      return;
    }
    for (const auto& entry : std::filesystem::directory_iterator{folder}) {
      if (entry.is_directory() && !entry.is_symlink()) search(entry.path(), runs);
    }
  } catch (const std::filesystem::filesystem_error& error) {
    runs.push_back({.directory = folder, .fault = "cannot be read: " + error.code().message()});
  }
}

}  // namespace

const Peak* RunEntry::largest_peak() const noexcept {
  const Peak* largest = nullptr;
  for (const Peak& peak : peak_displacement_m) {
    if (std::isfinite(peak.value) && (largest == nullptr || std::abs(peak.value) > std::abs(largest->value))) {
      largest = &peak;
    }
  }
  return largest;
}

std::vector<RunEntry> find_runs(const std::filesystem::path& folder, const RunFilter& filter) {
  if (!std::filesystem::is_directory(folder)) {
    throw RecordingError{folder.string() + ": no such folder; expected one with run directories"};
  }
  std::vector<RunEntry> runs;
  search(folder, runs);
  std::erase_if(runs, [&](const RunEntry& run) {
    return (!filter.test_name.empty() && run.test_name != filter.test_name) || (filter.only_failed && !run.failed());
  });
  std::ranges::sort(runs, [](const RunEntry& one, const RunEntry& other) {
    if (one.start_time_utc != other.start_time_utc) return one.start_time_utc > other.start_time_utc;
    return one.directory > other.directory;
  });
  return runs;
}

}  // namespace hybridtest
