#include "scenario/site_answer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "compensation/no_compensation.hpp"
#include "compensation/no_force_compensation.hpp"
#include "core/config_error.hpp"
#include "core/ring_port.hpp"
#include "experimental_site/rigs/simulated_rig.hpp"
#include "plant/specimens/elastic_specimen.hpp"
#include "plant/transfer_systems/ideal.hpp"

namespace hybridtest {
namespace {

/// So small that nothing is learnt and no geometry bends; far above the rounding of a geometry, 1e-12 m.
constexpr double kUnit_m = 1e-5;
/// A compensator needs its history before it is what it stays: 4 spacings of 10 000 control periods at most.
constexpr int kWarmUpPeriods = 40'001;
/// The answer is over when it has stayed below this share of its peak for a while, and at the latest here.
constexpr double kOver = 1e-7;
constexpr double kSilence_s = 0.25;
constexpr int kLongestPeriods = 200'000;
/// Of the loop for one step; each runs some hundred control periods.
constexpr int kMostTurns = 100'000;

/// No limit acts.
ControlLoopSettings unlimited(ControlLoopSettings settings) {
  constexpr double kNoLimit = 1e12;
  settings.mode = CouplingMode::lockstep;
  settings.limits = {.displacement_m = kNoLimit,
                     .velocity_m_per_s = kNoLimit,
                     .force_n = std::numeric_limits<double>::max(),
                     .command_age_s = kNoLimit};
  settings.captures_zero_offsets = false;
  return settings;
}

/// The last compensated force.
class LastForce final : public RowSink {
 public:
  explicit LastForce(int dofs) : force_n{Eigen::VectorXd::Zero(dofs)} {}

  void append(std::span<const double> row) noexcept override {
    constexpr std::size_t kFirst = 7;  // of the columns of ControlRecord
    constexpr std::size_t kPerDof = 5;
    for (Eigen::Index k = 0; k < force_n.size(); ++k) {
      force_n[k] = row[kFirst + kPerDof * static_cast<std::size_t>(k)];
    }
    if (rows != nullptr) rows->push_back(force_n);
  }

  Eigen::VectorXd force_n;
  std::vector<Eigen::VectorXd>* rows = nullptr;  // where to keep them
};

/// A control loop that is sent one target after the other.
class LoopProbe {
 public:
  LoopProbe(const ControlLoopSettings& settings, std::unique_ptr<Rig> rig, SiteCompensation compensation)
      : settings_{unlimited(settings)},
        rig_{std::move(rig)},
        force_{settings.dofs},
        loop_{settings_,
              *rig_,
              std::move(compensation),
              EnergyErrorMonitor{SiteMatrix::Identity(settings.dofs, settings.dofs), 1.0},
              ControlLoopPorts{requests_, reports_},
              force_} {
    rig_->connect();
    requests_.send(loop_request::Arm{});
    requests_.send(loop_request::Start{});
    for (int step = 0; step * settings_.periods_per_step < kWarmUpPeriods; ++step) send(nothing());
  }

  /// One row per control period.
  [[nodiscard]] std::vector<Eigen::VectorXd> answer_to(const TargetPoint& command) {
    std::vector<Eigen::VectorXd> rows;
    force_.rows = &rows;
    send(command);
    const double period_s = settings_.step_s / settings_.periods_per_step;
    const auto silence = static_cast<std::size_t>(std::ceil(silence_s_ / period_s));
    double peak = 0.0;
    std::size_t last_loud = 0;
    std::size_t looked_at = 0;
    while (rows.size() < kLongestPeriods) {
      for (; looked_at < rows.size(); ++looked_at) {
        const double size = rows[looked_at].cwiseAbs().maxCoeff();
        peak = std::max(peak, size);
        if (size > kOver * peak) last_loud = looked_at;
      }
      if (rows.size() > last_loud + silence) break;
      send(nothing());
    }
    rows.resize(last_loud + 1);
    force_.rows = nullptr;
    return rows;
  }

  [[nodiscard]] TargetPoint nothing() const {
    TargetPoint point;
    point.displacement_m = point.velocity_m_per_s = point.acceleration_m_per_s2 = SiteVector::Zero(settings_.dofs);
    return point;
  }
  /// An answer that begins or pauses for so long is not over.
  void wait_at_least(double silence_s) { silence_s_ = std::max(silence_s_, silence_s); }

 private:
  void send(TargetPoint point) {
    point.step = step_;
    point.model_time_s = static_cast<double>(step_++) * settings_.step_s / settings_.time_scale;
    requests_.send(loop_request::Target{point});
    LoopReport report;
    for (int turn = 0; turn < kMostTurns; ++turn) {
      static_cast<void>(loop_.advance(Instant{}));
      if (take_measurement(report)) return;
    }
    throw ConfigError{
        "the control loop of a site stops answering while the preflight moves it by hundredths of a millimetre: its "
        "transfer system or a compensator grows beyond all bounds by itself; check their parameters"};
  }
  bool take_measurement(LoopReport& report) {
    bool found = false;
    while (reports_.take(report)) found = found || std::holds_alternative<StepMeasurement>(report);
    return found;
  }

  ControlLoopSettings settings_;
  std::unique_ptr<Rig> rig_;
  RingPort<LoopRequest> requests_{8};
  RingPort<LoopReport> reports_{64};
  LastForce force_;
  ControlLoop loop_;
  Step step_ = 0;
  double silence_s_ = kSilence_s;
};

/// Earlier by that many rows, or later; between two rows along a straight line.
Eigen::MatrixXd moved(const Eigen::MatrixXd& rows, double earlier) {
  const auto at = [&](Eigen::Index row) -> Eigen::RowVectorXd {
    if (row < 0 || row >= rows.rows()) return Eigen::RowVectorXd::Zero(rows.cols());
    return rows.row(row);
  };
  const double whole = std::floor(earlier);
  const double part = earlier - whole;
  const auto shift = static_cast<Eigen::Index>(whole);
  Eigen::MatrixXd result{std::max<Eigen::Index>(rows.rows(), rows.rows() - shift), rows.cols()};
  for (Eigen::Index row = 0; row < result.rows(); ++row) {
    result.row(row) = (1.0 - part) * at(row + shift) + part * at(row + shift + 1);
  }
  return result;
}

SiteAnswer answer_of(LoopProbe& probe, const SubstructureScenario& substructure, double step_s) {
  const Eigen::Index dofs = substructure.interface.size();
  std::vector<std::vector<Eigen::VectorXd>> answers;
  std::vector<double> units;
  for (const auto& [channel, unit] : {std::pair{&TargetPoint::displacement_m, kUnit_m},
                                      {&TargetPoint::velocity_m_per_s, kUnit_m / step_s},
                                      {&TargetPoint::acceleration_m_per_s2, kUnit_m / (step_s * step_s)}}) {
    for (Eigen::Index k = 0; k < dofs; ++k) {
      TargetPoint command = probe.nothing();
      (command.*channel)[k] = unit;
      answers.push_back(probe.answer_to(command));
      units.push_back(unit);
    }
  }
  std::size_t longest = static_cast<std::size_t>(substructure.site.periods_per_step);
  for (const auto& answer : answers) longest = std::max(longest, answer.size());
  SiteAnswer site;
  site.periods_per_step = substructure.site.periods_per_step;
  site.stiffness_n_per_m = substructure.initial_stiffness_n_per_m;
  site.force_n = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(longest), std::ssize(answers) * dofs);
  for (std::size_t i = 0; i < answers.size(); ++i) {
    for (std::size_t row = 0; row < answers[i].size(); ++row) {
      site.force_n.block(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(i) * dofs, 1, dofs) =
          answers[i][row].transpose() / units[i];
    }
  }
  return site;
}

}  // namespace

SiteAnswer site_answer(const Scenario& scenario, const SubstructureScenario& substructure, LearntDelay learnt,
                       double displacement_m) {
  const ControlLoopSettings settings = control_loop_settings(scenario, substructure);
  const double period_s = settings.step_s / settings.periods_per_step;
  LoopProbe probe{settings, substructure.make_linear_rig(period_s, displacement_m),
                  substructure.make_linear_compensation(period_s, learnt)};
  for (const ForceDelay& delay : substructure.site.delays) {
    probe.wait_at_least(2.0 * (delay.transfer_s + std::abs(delay.transfer_s - delay.after_command_s)));
  }
  SiteAnswer answer = answer_of(probe, substructure, scenario.time.step_s);
  double moved_s = 0.0;
  for (const ForceDelay& delay : substructure.site.delays) {
    if (std::abs(delay.moved_s) > std::abs(moved_s)) moved_s = delay.moved_s;
  }
  if (moved_s != 0.0) answer.force_n = moved(answer.force_n, moved_s / period_s);
  return answer;
}

SiteAnswer bare_answer(const Scenario& scenario, const SubstructureScenario& substructure,
                       const Eigen::MatrixXd& stiffness_n_per_m) {
  const ControlLoopSettings settings = control_loop_settings(scenario, substructure);
  std::vector<std::unique_ptr<TransferSystem>> transfer_systems;
  SiteCompensation none;
  for (int k = 0; k < settings.dofs; ++k) {
    transfer_systems.push_back(std::make_unique<Ideal>());
    none.commands.push_back(std::make_unique<NoCompensation>());
    none.forces.push_back(std::make_unique<NoForceCompensation>());
  }
  LoopProbe probe{
      settings,
      std::make_unique<SimulatedRig>(std::move(transfer_systems), std::make_unique<ElasticSpecimen>(stiffness_n_per_m),
                                     SensorNoise{}, from_seconds(settings.step_s / settings.periods_per_step)),
      std::move(none)};
  return answer_of(probe, substructure, scenario.time.step_s);
}

NoiseGains noise_gains(const Scenario& scenario, const SubstructureScenario& substructure) {
  const ControlLoopSettings settings = control_loop_settings(scenario, substructure);
  NoiseGains gains{.command_by_target = 0.0, .force_by_force = 0.0};
  // The answer to one sample; that to white noise has the sum of its squares as variance.
  const auto gain = [](const auto& answer) {
    for (int i = 0; i < kWarmUpPeriods; ++i) static_cast<void>(answer(0.0));
    double sum = 0.0;
    for (int i = 0; i < kWarmUpPeriods; ++i) sum += std::pow(answer(i == 0 ? kUnit_m : 0.0) / kUnit_m, 2);
    return std::sqrt(sum);
  };
  SiteCompensation made =
      substructure.make_linear_compensation(settings.step_s / settings.periods_per_step, LearntDelay::initial);
  for (const auto& command : made.commands) {
    command->reset();
    gains.command_by_target =
        std::max(gains.command_by_target, gain([&](double value) { return command->command({.target_m = value}); }));
    command->reset();
    gains.command_by_measured =
        std::max(gains.command_by_measured,
                 gain([&](double value) { return command->command({.measured_displacement_m = value}); }));
  }
  for (const auto& force : made.forces) {
    force->reset();
    gains.force_by_force = std::max(
        gains.force_by_force, gain([&](double value) { return force->corrected_force({.measured_force_n = value}); }));
  }
  return gains;
}

SiteAnswer prompt_answer(const Eigen::MatrixXd& stiffness_n_per_m) {
  const Eigen::Index dofs = stiffness_n_per_m.rows();
  SiteAnswer site;
  site.stiffness_n_per_m = stiffness_n_per_m;
  site.force_n = Eigen::MatrixXd::Zero(1, IntegratorResponse::kChannels * dofs * dofs);
  site.force_n.leftCols(dofs * dofs) = stiffness_n_per_m.reshaped().transpose();
  return site;
}

}  // namespace hybridtest
