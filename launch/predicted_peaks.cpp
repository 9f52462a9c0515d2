#include "launch/predicted_peaks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <memory>
#include <span>

#include "core/event_text.hpp"
#include "runtime/executor.hpp"
#include "runtime/simulation.hpp"

namespace hybridtest {
namespace {

constexpr Duration kProgressEvery = std::chrono::milliseconds{1900};

/// Of the table `control`, see ControlRecord.
class ControlPeaks final : public RowSink {
 public:
  ControlPeaks(int dofs, double period_s) : targets_m_(static_cast<std::size_t>(dofs)), period_s_{period_s} {}

  void append(std::span<const double> row) noexcept override {
    constexpr std::size_t kFirst = 3;
    constexpr std::size_t kPerDof = 5;
    const bool runs = row[2] > model_time_s_;  // not yet, or not any more: the return to zero has targets of its own
    model_time_s_ = row[2];
    for (std::size_t k = 0; k < targets_m_.size(); ++k) {
      const auto values = row.subspan(kFirst + k * kPerDof, kPerDof);
      const double target_m = values[0];
      for (std::size_t i = 0; i < 3; ++i) displacement_m = std::max(displacement_m, std::abs(values[i]));
      if (runs) velocity_m_per_s = std::max(velocity_m_per_s, std::abs(target_m - targets_m_[k]) / period_s_);
      force_n = std::max(force_n, std::abs(values[3]));
      targets_m_[k] = target_m;
    }
  }

  double displacement_m = 0.0;
  double velocity_m_per_s = 0.0;
  double force_n = 0.0;

 private:
  std::vector<double> targets_m_;
  double period_s_;
  double model_time_s_ = 0.0;
};

std::string stand_in(SubstructureScenario& substructure) {
  SiteScenario& site = substructure.site;
  if (!site.rig_is_elsewhere) return "its " + site.rig_type + " rig";
  site.rig_is_elsewhere = false;
  site.rig_tables.clear();
  if (substructure.make_model_rig) {
    substructure.make_rig = substructure.make_model_rig;
    return "the model beside its " + site.rig_type + " rig";
  }
  substructure.make_rig = [make = substructure.make_linear_rig,
                           at_m = site.loop.limits.displacement_m](double period_s) { return make(period_s, at_m); };
  return "an elastic specimen of the initial stiffness in place of its " + site.rig_type + " rig";
}

}  // namespace

PredictedTest predicted_test(const Scenario& scenario) {
  Scenario simulated = scenario;
  PredictedTest test;
  std::map<std::string, std::unique_ptr<ControlPeaks>> peaks;
  for (std::size_t i = 0; i < simulated.substructures.size(); ++i) {
    SubstructureScenario& substructure = simulated.substructures[i];
    if (substructure.role != Role::experimental_site) continue;
    test.sites.push_back({.site = &scenario.substructures[i], .rig = stand_in(substructure)});
    const ControlLoopSettings settings = control_loop_settings(simulated, substructure);
    peaks[substructure.id] = std::make_unique<ControlPeaks>(settings.dofs, settings.step_s / settings.periods_per_step);
  }
  NoRecord no_record;
  const ProcessClock clock;
  Instant shown = clock.now();
  SimulationObserver observer;
  observer.sink = [&](const std::string& participant, const TableLayout& table) -> RowSink& {
    const auto site = peaks.find(participant);
    if (site == peaks.end() || table.name != "control") return no_record;
    return *site->second;
  };
  observer.event = [&](const Event& event) {
    if (event.severity == Severity::fault) test.faults.push_back(event.source.text() + ": " + describe(event));
  };
  observer.progress = [&](const CoordinatorReport& report) {
    const Instant now = clock.now();
    if (now - shown >= kProgressEvery) {
      shown = now;
      fmt::print(stderr, "simulating the test for its peaks: step {} of {} (--quick leaves it out)\n",
                 report.completed_steps, simulated.time.last_step);
    }
    return stop_was_requested();
  };
  const SimulationResult result = simulate(simulated, SimulationSettings{}, observer);
  test.reason = result.coordinator.reason;
  test.end_s = scenario.model_time_s(std::max<Step>(0, result.coordinator.completed_steps - 1));
  for (SitePeaks& site : test.sites) {
    const ControlPeaks& found = *peaks.at(site.site->id);
    site.displacement_m = found.displacement_m;
    site.velocity_m_per_s = found.velocity_m_per_s;
    site.force_n = found.force_n;
  }
  return test;
}

}  // namespace hybridtest
