#include "launch/run_report.hpp"

#include <exception>

#include "launch/shipped_scenarios.hpp"
#include "report/run_report/run_report.hpp"
#include "scenario/scenario.hpp"

namespace hybridtest {
namespace {

/// The effective text of the shipped scenario of this name; empty without one.
std::string shipped_text(const std::string& test_name) {
  std::error_code absent;
  for (const auto& entry : std::filesystem::recursive_directory_iterator{shipped_scenarios(), absent}) {
    if (entry.path().extension() != ".yaml" || entry.path().stem() != test_name) continue;
    try {
      return read_scenario(entry.path(), {}).effective;
    } catch (const std::exception&) {  // of another version: nothing to compare with
      return "";
    }
  }
  return "";
}

}  // namespace

std::filesystem::path report_file(const std::filesystem::path& run) { return run / "report.html"; }

void write_run_report(const std::filesystem::path& run, const std::vector<std::filesystem::path>& compare,
                      const RunSummary& summary, const std::filesystem::path& file) {
  write_report({.run = run, .compare = compare, .shipped_scenario = shipped_text(summary.test_name)}, summary, file);
}

}  // namespace hybridtest
