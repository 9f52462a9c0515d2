#include "scenario/loop_sections.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hybridtest {
namespace {
using config::Section;

constexpr Range kCommandAge{.low = 0.01, .high = 86400.0};

// Of the defaults, see read_loop().
constexpr double kTrackingShare = 0.1;  // of the displacement limit
constexpr double kStuckMotionShare = 0.001;
constexpr double kResolutionSteps = 2.0;  // of coarse readings, where that is more
constexpr double kStuckTime_s = 0.1;
constexpr double kStuckSamplesMin = 10.0;
constexpr int kStuckSamplesMax = 1'000'000;

std::string seconds_text(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g s", seconds);
  return text;
}

/// The sections `limits`, the short form, and `interlocks`, each interlock in full.
class SafetySections {
 public:
  SafetySections(Section& site, CouplingMode mode, double link_s)
      : limits_{site.section_or_empty("limits")},
        interlocks_{site.section_or_empty("interlocks")},
        mode_{mode},
        link_s_{link_s} {}

  void read(const TrackingExpectation& rig, LoopScenario& loop) {
    loop_ = &loop;
    loop.limits.displacement_m = required(InterlockKind::displacement, "displacement_m", "limit_m");
    loop.limits.velocity_m_per_s = required(InterlockKind::velocity, "velocity_m_per_s", "limit_m_per_s");
    loop.limits.force_n = required(InterlockKind::force, "force_n", "limit_n");
    read_tracking_error(rig);
    loop.limits.energy_error_ratio = optional(InterlockKind::energy_error, "energy_error_ratio", "limit_ratio");
    loop.limits.displacement_step_m = optional(InterlockKind::displacement_step, "displacement_step_m", "limit_m");
    loop.limits.force_step_n = optional(InterlockKind::force_step, "force_step_n", "limit_n");
    read_command_age();
    read_tracking_indicator();
    read_stuck_sensor(rig);
    for (const InterlockKind kind : {InterlockKind::not_finite, InterlockKind::rig_status}) {
      Section section = interlocks_.section_or_empty(name(kind));
      read_rule(kind, section);
    }
    limits_.finish();
    interlocks_.finish();
  }

 private:
  /// The limit from wherever it stands; the interlock's rule with it.
  std::optional<double> optional(InterlockKind kind, std::string_view short_key, std::string_view key,
                                 std::optional<double> fallback = {}) {
    const bool is_short = limits_.has(short_key);
    std::optional<double> limit;
    if (is_short) limit = limits_.number(short_key, kPositive);
    if (!is_short && !interlocks_.has(name(kind)) && !fallback) return {};
    Section section = interlocks_.section_or_empty(name(kind));
    if (is_short && section.has(key)) {
      section.error(key, "this limit is given under limits." + std::string{short_key} + " already");
      static_cast<void>(section.number(key));
    } else if (!is_short) {
      limit = section.number(key, kPositive, fallback);
    }
    read_rule(kind, section);
    return limit;
  }

  double required(InterlockKind kind, std::string_view short_key, std::string_view key) {
    if (const auto limit = optional(kind, short_key, key)) return *limit;
    return limits_.number(short_key, kPositive);  // which reports it as missing
  }

  void read_command_age() {
    Section section = interlocks_.section_or_empty("command_age");
    const bool is_long = section.has("limit_s");
    if (is_long && limits_.has("command_age_s")) {
      section.error("limit_s", "this limit is given under limits.command_age_s already");
    }
    const double fallback_s = mode_ == CouplingMode::lockstep ? std::max(1.0, link_s_) : 1.0;
    loop_->limits.command_age_s =
        is_long ? section.number("limit_s", kCommandAge) : limits_.number("command_age_s", kCommandAge, fallback_s);
    read_rule(InterlockKind::command_age, section, mode_ == CouplingMode::paced && link_s_ > 0.0);
  }

  void read_tracking_indicator() {
    if (!interlocks_.has("tracking_indicator")) return;
    Section section = interlocks_.section("tracking_indicator");
    loop_->limits.tracking_indicator = section.number("limit_lag_sine", {.low = 0.0, .high = 1.0, .low_open = true});
    loop_->tracking_window_s = section.number("window_s", {.low = 0.01, .high = 3600.0}, 1.0);
    read_rule(InterlockKind::tracking_indicator, section);
  }

  void read_tracking_error(const TrackingExpectation& rig) {
    constexpr InterlockKind kKind = InterlockKind::tracking_error;
    if (interlocks_.reads_off(name(kKind))) return;
    if (limits_.reads_off("tracking_error_m")) {
      if (!interlocks_.has_optional(name(kKind))) return;
      interlocks_.error(name(kKind), "this interlock is off by limits.tracking_error_m already");
      return;
    }
    std::optional<double> fallback;
    if (rig.follows_commands) {
      fallback = kTrackingShare * loop_->limits.displacement_m + loop_->limits.velocity_m_per_s * rig.remaining_delay_s;
    }
    loop_->limits.tracking_error_m = optional(kKind, "tracking_error_m", "limit_m", fallback);
  }

  void read_stuck_sensor(const TrackingExpectation& rig) {
    constexpr std::string_view kKey = "stuck_sensor";
    if (interlocks_.reads_off(kKey) || (!rig.follows_commands && !interlocks_.has(kKey))) return;
    Section section = interlocks_.section_or_empty(kKey);
    SiteLimits& limits = loop_->limits;
    const double samples = std::ceil((rig.reading_delay_s + kStuckTime_s) / rig.control_period_s);
    limits.stuck_samples = static_cast<int>(
        section.integer("limit_samples", 2, kStuckSamplesMax,
                        static_cast<std::int64_t>(std::clamp<double>(samples, kStuckSamplesMin, kStuckSamplesMax))));
    limits.stuck_while_moving_m = section.number(
        "while_moving_m", kPositive,
        std::max(kStuckMotionShare * limits.displacement_m, kResolutionSteps * rig.displacement_resolution_m));
    limits.stuck_judges_force =
        section.choice("sensors", {"displacement", "displacement_and_force"},
                       rig.force_always_varies ? "displacement_and_force" : "displacement") == 1;
    read_rule(InterlockKind::stuck_sensor, section);
  }

  void read_rule(InterlockKind kind, Section& section, bool clears_by_default = false) {
    static const std::vector<std::string> kActions{"warn", "hold", "ramp_to_zero", "release"};
    static const std::vector<std::string> kClears{"when_cleared", "operator_reset", "never"};
    InterlockRule& rule = loop_->rules[static_cast<std::size_t>(kind)];
    const std::size_t fallback = static_cast<std::size_t>(rule.action) - 1;
    rule.action = static_cast<SafetyAction>(section.choice("action", kActions, kActions[fallback]) + 1);
    const bool may_clear = clears_by_default && rule.action <= SafetyAction::hold;
    rule.clears = static_cast<ClearCondition>(section.choice("clears", kClears, may_clear ? "when_cleared" : "never"));
    if (kind == InterlockKind::not_finite && rule.action == SafetyAction::warn) {
      section.error(
          "action",
          "warn is not possible here, because NaN or infinity cannot be commanded; expected hold, ramp_to_zero "
          "or release");
    }
    if (rule.clears != ClearCondition::never && rule.action > SafetyAction::hold) {
      section.error("clears", "a site that returns or releases has left the test: expected never");
    }
    if (rule.clears != ClearCondition::never && rule.action == SafetyAction::hold && mode_ != CouplingMode::paced) {
      section.error("clears", mode_ == CouplingMode::lockstep
                                  ? "in lockstep a site that holds measures nothing that could clear: expected never"
                                  : "in real time the test does not wait for a site that holds: expected never");
    }
    section.finish();
  }

  Section limits_;
  Section interlocks_;
  CouplingMode mode_;
  double link_s_;
  LoopScenario* loop_ = nullptr;
};

TrajectorySettings read_trajectory(Section section) {
  TrajectorySettings trajectory;
  if (section.choice("type", {"predictor_corrector", "ramp_and_hold"}, "predictor_corrector") == 0) {
    trajectory.order = static_cast<int>(section.integer("order", 1, 3, trajectory.order));
  } else {
    trajectory.type = TrajectoryType::ramp_and_hold;
    trajectory.hold_share =
        section.number("hold_share", {.low = 0.0, .high = 1.0, .high_open = true}, trajectory.hold_share);
  }
  section.finish();
  return trajectory;
}

}  // namespace

LoopScenario read_loop(Section& site, CouplingMode mode, double site_step_s, double link_s,
                       const TrackingExpectation& rig) {
  LoopScenario loop;
  SafetySections{site, mode, link_s}.read(rig, loop);
  if (mode != CouplingMode::lockstep && loop.limits.command_age_s <= site_step_s) {
    site.error("limits", "command_age_s of " + seconds_text(loop.limits.command_age_s) +
                             " is no longer than a step, step_s times time_scale, of " + seconds_text(site_step_s) +
                             ": every command would be overdue");
  }
  loop.trajectory = read_trajectory(site.section_or_empty("trajectory"));
  constexpr Range kDuration{.low = 0.0, .high = 3600.0};
  loop.ramp_in_s = site.number("ramp_in_s", kDuration, 0.0);
  loop.captures_zero_offsets = site.choice("zero_offsets", {"none", "capture"}, "none") == 1;
  loop.returns_at_end = site.choice("at_end", {"return", "hold"}, "return") == 0;
  loop.return_time_s = site.number("return_time_s", kDuration, 2.0);
  return loop;
}

RealTimeRequest read_real_time(Section& parent, bool has_deadlines) {
  RealTimeRequest request;
  if (!has_deadlines && !parent.has("real_time")) return request;
  Section section = parent.section_or_empty("real_time");
  request.priority = static_cast<int>(section.integer("priority", 1, 99, request.priority));
  if (section.has("cpu")) request.cpu = static_cast<int>(section.integer("cpu", 0, 1023));
  request.allow_degraded = section.boolean("allow_degraded", true);
  section.finish();
  return request;
}

}  // namespace hybridtest
