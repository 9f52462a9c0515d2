#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "compensation/no_compensation.hpp"
#include "compensation/no_force_compensation.hpp"
#include "compensation/polynomial_displacement.hpp"
#include "core/ring_port.hpp"
#include "experimental_site/control_loop.hpp"
#include "tests/support/kept_rows.hpp"
#include "tests/support/scripted_rig.hpp"

namespace hybridtest {

/// A control loop at 1 kHz with steps of 4 ms, told what to do and handed the time.
class LoopBench {
 public:
  static constexpr double kStiffness_n_per_m = 1.0e5;
  static constexpr Duration kPeriod = std::chrono::milliseconds{1};
  static constexpr double kPeriod_s = 1.0e-3;
  static constexpr int kPeriodsPerStep = 4;
  static constexpr double kStep_s = kPeriodsPerStep * kPeriod_s;

  static ControlLoopSettings settings(CouplingMode mode, int dofs = 1) {
    ControlLoopSettings settings;
    settings.mode = mode;
    settings.dofs = dofs;
    settings.periods_per_step = kPeriodsPerStep;
    settings.step_s = kStep_s;
    settings.limits.displacement_m = 0.1;
    settings.limits.velocity_m_per_s = 0.5;
    settings.limits.force_n = 1.0e4;
    settings.limits.command_age_s = 0.1;
    settings.return_time_s = 0.2;
    return settings;
  }

  LoopBench(const ControlLoopSettings& settings, ScriptedRig::Answer answer, bool compensates = false)
      : settings_{settings},
        rig{std::move(answer)},
        record{ControlLoop::control_layout(settings.dofs)},
        loop{settings,
             rig,
             compensation(settings.dofs, compensates),
             EnergyErrorMonitor{kStiffness_n_per_m * SiteMatrix::Identity(settings.dofs, settings.dofs), 0.005},
             ControlLoopPorts{requests, reports},
             record} {}

  static SiteCompensation compensation(int dofs, bool compensates) {
    SiteCompensation made;
    for (int i = 0; i < dofs; ++i) {
      if (compensates) {
        made.commands.push_back(std::make_unique<PolynomialDisplacement>(3, 8 * kPeriod, kPeriod));
      } else {
        made.commands.push_back(std::make_unique<NoCompensation>());
      }
      made.forces.push_back(std::make_unique<NoForceCompensation>());
    }
    return made;
  }

  void ask(const LoopRequest& request) { requests.send(request); }
  void target(Step step, double displacement_m, double velocity_m_per_s = 0.0, double acceleration_m_per_s2 = 0.0) {
    TargetPoint point;
    point.step = step;
    point.model_time_s = static_cast<double>(step) * kStep_s / settings_.time_scale;
    point.displacement_m = SiteVector::Constant(settings_.dofs, displacement_m);
    point.velocity_m_per_s = SiteVector::Constant(settings_.dofs, velocity_m_per_s);
    point.acceleration_m_per_s2 = SiteVector::Constant(settings_.dofs, acceleration_m_per_s2);
    requests.send(loop_request::Target{point});
  }
  /// Armed and started, the first target at rest.
  void start() {
    ask(loop_request::Arm{});
    ask(loop_request::Start{});
    target(0, 0.0);
    advance();
    take_reports();
  }
  /// One period later.
  Instant advance() {
    const Instant wake = loop.advance(now);
    now += kPeriod;
    return wake;
  }
  std::vector<LoopReport> take_reports() {
    std::vector<LoopReport> taken;
    LoopReport report;
    while (reports.take(report)) taken.push_back(report);
    return taken;
  }
  /// The fault among the reports that wait, if there is one.
  std::optional<loop_report::Fault> take_fault() {
    for (const LoopReport& report : take_reports()) {
      if (const auto* fault = std::get_if<loop_report::Fault>(&report)) return *fault;
    }
    return {};
  }
  [[nodiscard]] double command_m(std::size_t back = 0) const {
    return rig.commands[rig.commands.size() - 1 - back].displacement_m[0];
  }

  ControlLoopSettings settings_;
  RingPort<LoopRequest> requests{64};
  RingPort<LoopReport> reports{64};
  ScriptedRig rig;
  KeptRows record;
  ControlLoop loop;
  Instant now{};
};

}  // namespace hybridtest
