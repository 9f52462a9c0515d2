#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "core/random.hpp"
#include "tests/unit/experimental_site/control_loop_bench.hpp"

/// Random sequences of faults, of sensors, rig, targets and operators, on loops with random limits,
/// rules, actions and clear conditions. Seen from outside, at the rig and in the reports, and in
/// other words than those of the interlocks: no command leaves the limits, and whatever passes a
/// limit is acted upon by the very next command.
namespace hybridtest {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// A change to the loop after everything is drawn, which the checks do not know of.
using Sabotage = void (*)(ControlLoopSettings&);
void nothing(ControlLoopSettings&) {}

class FaultSequence {
 public:
  explicit FaultSequence(std::uint64_t seed, Sabotage sabotage = nothing)
      : random_{seed},
        settings_{drawn_settings()},
        bench_{sabotaged(settings_, sabotage),
               [this](const ActuatorCommand& c, RigFeedback& f) {
                 check_command(c);
                 const RigStatus status = answer(c, f);
                 find_violations(status, f);
                 return status;
               },
               random_.uniform() < 0.5} {}

  void run() {
    bench_.ask(loop_request::Arm{});
    bench_.ask(loop_request::Start{});
    bench_.target(0, 0.0);
    for (int i = 0; i < 400 && wrongs_.empty(); ++i) {
      if (random_.uniform() < 0.05) bench_.now += static_cast<int>(random_.below(10)) * LoopBench::kPeriod;
      interfere();
      bench_.advance();
      heed_reports();
      if (required_ == SafetyAction::release && bench_.rig.stops == 0) wrong("not released in the same period");
    }
  }

  [[nodiscard]] const std::vector<std::string>& wrongs() const { return wrongs_; }
  [[nodiscard]] bool has_ended() const { return required_ != SafetyAction::none; }
  [[nodiscard]] bool has_cleared() const { return has_cleared_; }

 private:
  static ControlLoopSettings sabotaged(ControlLoopSettings settings, Sabotage sabotage) {
    sabotage(settings);
    return settings;
  }

  ControlLoopSettings drawn_settings() {
    const bool is_lockstep = random_.uniform() < 0.5;
    ControlLoopSettings settings = LoopBench::settings(is_lockstep ? CouplingMode::lockstep : CouplingMode::paced,
                                                       1 + static_cast<int>(random_.below(2)));
    const auto maybe = [&](double low, double high) {
      return random_.uniform() < 0.5 ? std::optional<double>{random_.uniform(low, high)} : std::nullopt;
    };
    settings.limits.tracking_error_m = maybe(0.0005, 0.02);
    settings.limits.energy_error_ratio = maybe(0.05, 2.0);
    settings.limits.displacement_step_m = maybe(0.001, 0.1);
    settings.limits.force_step_n = maybe(100.0, 1.0e4);
    settings.limits.tracking_indicator = maybe(0.2, 1.0);
    if (random_.uniform() < 0.5) settings.limits.stuck_samples = 5 + static_cast<int>(random_.below(50));
    settings.return_time_s = random_.uniform() < 0.3 ? 0.0 : random_.uniform(0.0, 0.3);
    settings.returns_at_end = random_.uniform() < 0.5;
    settings.trajectory.order = 1 + static_cast<int>(random_.below(3));
    if (random_.uniform() < 0.2) settings.trajectory.type = TrajectoryType::ramp_and_hold;
    for (std::size_t i = 0; i < kInterlockCount; ++i) {
      if (static_cast<InterlockKind>(i) == InterlockKind::emergency_stop || random_.uniform() < 0.5) continue;
      settings.rules[i].action = static_cast<SafetyAction>(1 + random_.below(4));
      // What is no number cannot be commanded or sent, so a warning is not enough for it.
      if (static_cast<InterlockKind>(i) == InterlockKind::not_finite) {
        settings.rules[i].action = std::max(settings.rules[i].action, SafetyAction::hold);
      }
      const bool may_clear = settings.rules[i].action == SafetyAction::warn || !is_lockstep;
      if (may_clear) settings.rules[i].clears = static_cast<ClearCondition>(random_.below(3));
    }
    return settings;
  }

  /// A lagging actuator on a spring, whose sensors and status fail now and then.
  RigStatus answer(const ActuatorCommand& command, RigFeedback& feedback) {
    place_m_.conservativeResize(settings_.dofs);
    place_m_ += 0.3 * (command.displacement_m - place_m_);
    if (stuck_ > 0 && --stuck_ >= 0) {
      feedback = measured_;
      return RigStatus::healthy;
    }
    feedback.displacement_m = place_m_;
    feedback.force_n = LoopBench::kStiffness_n_per_m * place_m_;
    const auto dof = static_cast<Eigen::Index>(random_.below(static_cast<std::uint64_t>(settings_.dofs)));
    switch (random_.below(500)) {
      case 0: feedback.force_n[dof] = kNan; break;
      case 1: feedback.displacement_m[dof] = -kInfinity; break;
      case 2: feedback.force_n[dof] = 2.0e4; break;
      case 3: feedback.displacement_m[dof] = 0.3; break;
      case 4: feedback.force_n[dof] += random_.uniform(-8e3, 8e3); break;
      case 5: feedback.displacement_m[dof] += random_.uniform(-0.05, 0.05); break;
      case 6: stuck_ = static_cast<int>(random_.below(100)); break;
      case 7: return RigStatus::fault;
      default: break;
    }
    return RigStatus::healthy;
  }

  void demand(InterlockKind kind) {
    const InterlockRule& rule = settings_.rules[static_cast<std::size_t>(kind)];
    const bool is_final = rule.action > SafetyAction::hold || rule.clears == ClearCondition::never;
    demanded_now_ = std::max(demanded_now_, rule.action);
    if (is_final && rule.action > SafetyAction::warn) required_ = std::max(required_, rule.action);
  }

  void find_violations(RigStatus status, const RigFeedback& feedback) {
    demanded_now_ = SafetyAction::none;
    const SiteLimits& limits = settings_.limits;
    if (status == RigStatus::fault) demand(InterlockKind::rig_status);
    const bool is_finite = feedback.displacement_m.allFinite() && feedback.force_n.allFinite();
    if (!is_finite) demand(InterlockKind::not_finite);
    // Comparisons with NaN are false.
    const auto is_beyond = [](double value, double limit) { return std::isfinite(value) && std::abs(value) > limit; };
    for (Eigen::Index k = 0; k < settings_.dofs; ++k) {
      if (is_beyond(feedback.displacement_m[k], limits.displacement_m)) demand(InterlockKind::displacement);
      if (is_beyond(feedback.force_n[k], limits.force_n)) demand(InterlockKind::force);
      if (!has_measured_) continue;
      const double step_m = feedback.displacement_m[k] - measured_.displacement_m[k];
      if (is_beyond(step_m, limits.displacement_step_m.value_or(kInfinity))) demand(InterlockKind::displacement_step);
      const double step_n = feedback.force_n[k] - measured_.force_n[k];
      if (is_beyond(step_n, limits.force_step_n.value_or(kInfinity))) demand(InterlockKind::force_step);
    }
    measured_ = feedback;
    has_measured_ = true;
  }

  /// What the sample before demanded, this command shows.
  void check_command(const ActuatorCommand& command) {
    const std::size_t count = bench_.rig.commands.size();
    SiteVector before_m = SiteVector::Zero(settings_.dofs);
    if (count > 1) before_m = bench_.rig.commands[count - 2].displacement_m;
    if (command.sample != static_cast<std::int64_t>(count) - 1) wrong("a control period is missing");
    if (!command.displacement_m.allFinite()) wrong("a command that is no number");
    const double reach_m = settings_.limits.velocity_m_per_s * LoopBench::kPeriod_s;
    const SafetyAction action = std::max(required_, demanded_now_);
    for (Eigen::Index k = 0; k < settings_.dofs; ++k) {
      const double now_m = command.displacement_m[k];
      if (std::abs(now_m) > settings_.limits.displacement_m) wrong("a command beyond the displacement limit");
      // Made by adding the reach to the one before: rounded once.
      if (std::abs(now_m - before_m[k]) > reach_m + kEpsilon * settings_.limits.displacement_m) {
        wrong("a command faster than the velocity limit");
      }
      const bool is_closer = std::abs(now_m) <= std::abs(before_m[k]) && now_m * before_m[k] >= 0.0;
      if (action == SafetyAction::hold && !was_stopped_ && now_m != before_m[k]) {
        // A graver one that the rig cannot see may have come first: its report will tell.
        (is_closer ? returns_instead_ : moves_instead_) = true;
      }
      if (action == SafetyAction::ramp_to_zero && !was_stopped_ && !is_closer) wrong("it did not return");
      if (action == SafetyAction::release) wrong("it moved after it should have released");
    }
  }

  void interfere() {
    const double draw = random_.uniform();
    if (wants_target_ && draw < 0.7) {
      wants_target_ = false;
      const double bound_m = random_.uniform() < 0.02 ? 1.0 : 0.0005;
      displacement_m_ += random_.uniform(-bound_m, bound_m);
      const double velocity = random_.uniform() < 0.01 ? 100.0 : random_.uniform(-0.1, 0.1);
      const double acceleration = random_.uniform() < 0.01 ? 1.0e5 : random_.uniform(-5.0, 5.0);
      bench_.target(++step_, random_.uniform() < 0.005 ? kNan : displacement_m_, velocity, acceleration);
    }
    if (draw > 0.990) bench_.ask(loop_request::Pause{});
    if (draw > 0.980 && draw < 0.990) bench_.ask(loop_request::Resume{});
    if (draw > 0.978 && draw < 0.980) stop(loop_request::Stop{});
    if (draw > 0.977 && draw < 0.978) stop(loop_request::EmergencyStop{});
  }

  void stop(const LoopRequest& request) {
    was_stopped_ = true;
    if (std::holds_alternative<loop_request::EmergencyStop>(request)) required_ = SafetyAction::release;
    bench_.ask(request);
  }

  void heed_reports() {
    const bool returns_instead = std::exchange(returns_instead_, false);
    for (const LoopReport& report : bench_.take_reports()) {
      if (const auto* fault = std::get_if<loop_report::Fault>(&report)) {
        // Also those that the rig does not see, such as a target beyond the limits.
        for (std::size_t i = 0; i < kInterlockCount; ++i) {
          if (fault_of(static_cast<InterlockKind>(i)) != fault->fault) continue;
          if (settings_.rules[i].action > SafetyAction::warn) {
            required_ = std::max(required_, settings_.rules[i].action);
          }
        }
      }
      if (std::holds_alternative<loop_report::Cleared>(report)) has_cleared_ = true;
      if (std::holds_alternative<loop_report::AtRest>(report) && !was_stopped_) wrong("at rest unasked");
      const auto* measured = std::get_if<StepMeasurement>(&report);
      if (measured == nullptr) continue;
      if (measured->step != ++answered_) wrong("a step was answered twice or never");
      if (!measured->force_n.allFinite()) wrong("a force that is no number was sent");
      wants_target_ = true;
    }
    if (moves_instead_ || (returns_instead && required_ < SafetyAction::ramp_to_zero)) wrong("it did not hold");
  }

  void wrong(const char* what) { wrongs_.emplace_back(what); }

  Random random_;
  ControlLoopSettings settings_;
  SiteVector place_m_ = SiteVector::Zero(2);
  int stuck_ = 0;
  RigFeedback measured_;
  bool has_measured_ = false;
  SafetyAction required_ = SafetyAction::none;      // for good
  SafetyAction demanded_now_ = SafetyAction::none;  // of the next command
  std::vector<std::string> wrongs_;
  bool returns_instead_ = false;
  bool moves_instead_ = false;
  bool has_cleared_ = false;
  bool wants_target_ = false;
  bool was_stopped_ = false;
  double displacement_m_ = 0.0;
  Step step_ = 0;
  Step answered_ = kNoStep;
  LoopBench bench_;
};

/// Of so many sequences, what happened in how many.
struct Count {
  int wrong = 0;
  int ended = 0;
  int cleared = 0;
  std::string first;  // what was wrong first
};

Count run_sequences(std::uint64_t sequences, Sabotage sabotage = nothing) {
  Count count;
  for (std::uint64_t seed = 1; seed <= sequences; ++seed) {
    FaultSequence sequence{seed, sabotage};
    sequence.run();
    count.ended += sequence.has_ended() ? 1 : 0;
    count.cleared += sequence.has_cleared() ? 1 : 0;
    if (sequence.wrongs().empty()) continue;
    ++count.wrong;
    if (count.first.empty()) count.first = "seed " + std::to_string(seed) + ": " + sequence.wrongs().front();
  }
  return count;
}

TEST(FaultSequencesTest, CommandsStayInLimitsAndTripsActWithinAPeriod) {
  const Count count = run_sequences(10000);
  EXPECT_EQ(count.wrong, 0) << count.first;
  EXPECT_GE(count.ended, 3000) << "the sequences must provoke faults";
  EXPECT_LE(count.ended, 9900) << "and leave some loops running";
  EXPECT_GE(count.cleared, 500) << "some of them holds that clear";
}

TEST(FaultSequencesTest, DetectsMissingInterlock) {
  for (const InterlockKind kind : {InterlockKind::not_finite, InterlockKind::rig_status, InterlockKind::displacement,
                                   InterlockKind::force, InterlockKind::displacement_step, InterlockKind::force_step}) {
    static InterlockKind missing;
    missing = kind;
    const Count count = run_sequences(200, [](ControlLoopSettings& settings) {
      settings.rules[static_cast<std::size_t>(missing)].action = SafetyAction::none;
    });
    EXPECT_GE(count.wrong, 1) << name(kind);
  }
}

TEST(FaultSequencesTest, DetectsLimitThatIsTooWide) {
  EXPECT_GE(run_sequences(500, [](ControlLoopSettings& settings) { settings.limits.displacement_m *= 3.0; }).wrong, 1);
  EXPECT_GE(run_sequences(500, [](ControlLoopSettings& settings) { settings.limits.velocity_m_per_s *= 3.0; }).wrong,
            1);
}

TEST(FaultSequencesTest, DetectsActionThatIsTooMild) {
  const Count count = run_sequences(200, [](ControlLoopSettings& settings) {
    for (InterlockRule& rule : settings.rules) {
      if (rule.action == SafetyAction::release) rule.action = SafetyAction::hold;
    }
  });
  EXPECT_GE(count.wrong, 1);
}

}  // namespace
}  // namespace hybridtest
