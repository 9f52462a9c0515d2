#include "experimental_site/interlocks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/message_copies.hpp"

namespace hybridtest {
namespace {

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

/// Input of one interlock in one control sample.
struct Finding {
  bool is_judged = false;  // there is a limit and a value to compare with it
  bool is_passed = false;
  double observed = 0.0;
  double limit = 0.0;
};

/// NaN counts as zero here, so that it hides no other value; the interlock `not_finite` acts on it.
/// @param values   a vector, or a difference of two that is not stored.
template <class Values>
[[nodiscard]] double largest(const Eigen::MatrixBase<Values>& values) noexcept {
  double largest = 0.0;
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    const double value = values.coeff(k);
    if (std::isfinite(value)) largest = std::max(largest, std::fabs(value));
  }
  return largest;
}

[[nodiscard]] bool is_finite(const InterlockInput& input) noexcept {
  return input.target_displacement_m.allFinite() && input.command_displacement_m.allFinite() &&
         input.measured_displacement_m.allFinite() && input.force_n.allFinite();
}

[[nodiscard]] Finding against(double observed, double limit) noexcept {
  return {true, observed > limit, observed, limit};
}

[[nodiscard]] Finding against(double observed, const std::optional<double>& limit) noexcept {
  return limit ? against(observed, *limit) : Finding{};
}

/// A sensor with constant readings is stuck when the command has moved in the meantime. The samples before that do
/// not count: a site that stood still for long may answer its first command with a delay.
void count_stuck(bool is_same, double command_m, double while_moving_m, InterlockState::Stuck& stuck) noexcept {
  if (!is_same) {
    stuck = {.command_then_m = command_m};
    return;
  }
  stuck.command_moved_m = std::max(stuck.command_moved_m, std::fabs(command_m - stuck.command_then_m));
  if (stuck.command_moved_m > while_moving_m) ++stuck.samples;
}

void count_same_readings(const SiteLimits& limits, const InterlockInput& input, InterlockState& state) noexcept {
  // A rig with a fault repeats its last readings: there is nothing to be learnt of its sensors.
  const bool compares = state.has_sample && !input.rig_fault;
  for (Eigen::Index k = 0; k < input.measured_displacement_m.size(); ++k) {
    const auto dof = static_cast<std::size_t>(k);
    const double command_m = input.command_displacement_m[k];
    count_stuck(compares && input.measured_displacement_m[k] == state.measured_displacement_m[k], command_m,
                limits.stuck_while_moving_m, state.displacement_stuck[dof]);
    count_stuck(compares && input.force_n[k] == state.measured_force_n[k], command_m, limits.stuck_while_moving_m,
                state.force_stuck[dof]);
  }
}

void remember(const InterlockInput& input, InterlockState& state) noexcept {
  state.has_sample = true;
  copy_values(input.measured_displacement_m, state.measured_displacement_m);
  copy_values(input.force_n, state.measured_force_n);
}

[[nodiscard]] Finding find_stuck(const SiteLimits& limits, const InterlockInput& input,
                                 const InterlockState& state) noexcept {
  if (!limits.stuck_samples || !input.is_new_sample) return {};
  int samples = 0;
  const auto dofs = static_cast<std::size_t>(input.force_n.size());
  for (std::size_t k = 0; k < dofs; ++k) {
    samples = std::max(samples, state.displacement_stuck[k].samples);
    if (limits.stuck_judges_force) samples = std::max(samples, state.force_stuck[k].samples);
  }
  return {true, samples >= *limits.stuck_samples, static_cast<double>(samples),
          static_cast<double>(*limits.stuck_samples)};
}

[[nodiscard]] double displacement_of(const InterlockInput& input) noexcept {
  const double measured_m = largest(input.measured_displacement_m);
  return input.phase == SitePhase::resting ? measured_m : std::max(measured_m, largest(input.target_displacement_m));
}

/// The value measured one control sample earlier.
struct Before {
  bool is_known;
  const SiteVector& displacement_m;
  const SiteVector& force_n;
};

[[nodiscard]] Finding find_step(const InterlockInput& input, const SiteVector& value, bool is_known,
                                const SiteVector& before, const std::optional<double>& limit) noexcept {
  if (!limit || !input.is_new_sample || !is_known || before.size() != value.size()) return {};
  return against(largest(value - before), *limit);
}

[[nodiscard]] Finding find(InterlockKind kind, const SiteLimits& limits, const InterlockInput& input,
                           const Before& before, const InterlockState& state) noexcept {
  switch (kind) {
    case InterlockKind::not_finite: return {true, !is_finite(input), kNotANumber, 0.0};
    case InterlockKind::rig_status: return {true, input.rig_fault, 0.0, 0.0};
    case InterlockKind::emergency_stop: return {true, input.emergency_stop, 0.0, 0.0};
    case InterlockKind::command_age:
      if (!input.expects_commands) return {true, false, 0.0, limits.command_age_s};
      return against(input.command_age_s, limits.command_age_s);
    case InterlockKind::displacement: return against(displacement_of(input), limits.displacement_m);
    case InterlockKind::force: return against(largest(input.force_n), limits.force_n);
    case InterlockKind::displacement_step:
      return find_step(input, input.measured_displacement_m, before.is_known, before.displacement_m,
                       limits.displacement_step_m);
    case InterlockKind::force_step:
      return find_step(input, input.force_n, before.is_known, before.force_n, limits.force_step_n);
    case InterlockKind::stuck_sensor: return find_stuck(limits, input, state);
    default: break;
  }
  if (input.phase != SitePhase::running) return {};  // there is no target to follow
  switch (kind) {
    case InterlockKind::velocity: return against(largest(input.target_velocity_m_per_s), limits.velocity_m_per_s);
    case InterlockKind::tracking_error:
      if (!limits.tracking_error_m) return {};
      return against(largest(input.target_displacement_m - input.measured_displacement_m), *limits.tracking_error_m);
    case InterlockKind::energy_error: return against(std::fabs(input.energy_error_ratio), limits.energy_error_ratio);
    case InterlockKind::tracking_indicator:
      return against(std::fabs(input.tracking_lag_sine), limits.tracking_indicator);
    default: return {};
  }
}

[[nodiscard]] bool is_final(const InterlockRule& rule) noexcept {
  return rule.action > SafetyAction::hold || rule.clears == ClearCondition::never;
}

/// @return whether the interlock cleared.
[[nodiscard]] bool clear(const InterlockRule& rule, const Finding& finding, const InterlockInput& input,
                         InterlockState::Latch& latch) noexcept {
  if (finding.is_passed) latch.clear_for_s = 0.0;
  if (!finding.is_judged || finding.is_passed || !input.is_new_sample) return false;
  latch.clear_for_s += input.period_s;
  if (is_final(rule) || rule.clears != ClearCondition::when_cleared || latch.clear_for_s < kClearAfter_s) return false;
  latch = {};
  return true;
}

void add(InterlockVerdict& verdict, const InterlockTrip& trip) noexcept {
  auto* const begin = verdict.trips.begin();
  auto* const end = begin + verdict.trip_count++;
  auto* const place = std::find_if(begin, end, [&](const InterlockTrip& other) { return other.action < trip.action; });
  std::move_backward(place, end, end + 1);
  *place = trip;
}

[[nodiscard]] bool is_within(double magnitude, const std::optional<double>& limit) noexcept {
  return !limit || magnitude <= *limit;
}

/// Whether nothing can have tripped, in one pass over the values. Nearly every sample ends here. Where a value is not
/// finite, a rule has no action or a value is not judged in this phase, false says nothing: conclude() finds out.
[[nodiscard]] bool is_plainly_safe(const SiteLimits& limits, const InterlockInput& input, const Before& before,
                                   const InterlockState& state) noexcept {
  if (input.rig_fault || input.emergency_stop) return false;
  if (input.expects_commands && !(input.command_age_s <= limits.command_age_s)) return false;
  if (!is_within(std::fabs(input.energy_error_ratio), limits.energy_error_ratio)) return false;
  if (!is_within(std::fabs(input.tracking_lag_sine), limits.tracking_indicator)) return false;
  if (find_stuck(limits, input, state).is_passed) return false;
  for (Eigen::Index k = 0; k < input.measured_displacement_m.size(); ++k) {
    const double target_m = input.target_displacement_m[k];
    const double measured_m = input.measured_displacement_m[k];
    const double force_n = input.force_n[k];
    // A sum is finite where all its terms are.
    const double sum = target_m + measured_m + force_n + input.command_displacement_m[k];
    if (!std::isfinite(sum)) return false;
    if (std::max(std::fabs(target_m), std::fabs(measured_m)) > limits.displacement_m) return false;
    if (std::fabs(force_n) > limits.force_n) return false;
    if (!(std::fabs(input.target_velocity_m_per_s[k]) <= limits.velocity_m_per_s)) return false;
    if (!is_within(std::fabs(target_m - measured_m), limits.tracking_error_m)) return false;
    if (!before.is_known || !input.is_new_sample) continue;
    if (!is_within(std::fabs(measured_m - before.displacement_m[k]), limits.displacement_step_m)) return false;
    if (!is_within(std::fabs(force_n - before.force_n[k]), limits.force_step_n)) return false;
  }
  return true;
}

[[nodiscard]] bool has_tripped(const InterlockState& state) noexcept {
  return std::ranges::any_of(state.latches, &InterlockState::Latch::is_tripped);
}

/// Latches what exceeds its limit, and clears what may clear.
[[gnu::noinline]] void conclude(const SiteLimits& limits, const InterlockRules& rules, const InterlockInput& input,
                                const Before& before, InterlockState& state, InterlockVerdict& verdict) noexcept {
  for (std::size_t i = 0; i < kInterlockCount; ++i) {
    const InterlockRule& rule = rules[i];
    if (rule.action == SafetyAction::none) continue;
    const auto kind = static_cast<InterlockKind>(i);
    InterlockState::Latch& latch = state.latches[i];
    const Finding finding = find(kind, limits, input, before, state);
    if (latch.is_tripped) {
      if (clear(rule, finding, input, latch)) verdict.has_cleared = true;
    } else if (finding.is_judged && finding.is_passed) {
      latch = {true, 0.0};
      add(verdict, {kind, rule.action, is_final(rule), finding.observed, finding.limit});
    }
    if (!latch.is_tripped) continue;
    if (rule.action > verdict.action) verdict.is_final = false;
    verdict.action = std::max(verdict.action, rule.action);
    if (rule.action == verdict.action) verdict.is_final = verdict.is_final || is_final(rule);
  }
  state.has_tripped = has_tripped(state);
}

}  // namespace

InterlockVerdict judge(const SiteLimits& limits, const InterlockRules& rules, const InterlockInput& input,
                       InterlockState& state) noexcept {
  const Before before{state.has_sample, state.measured_displacement_m, state.measured_force_n};
  if (input.is_new_sample) count_same_readings(limits, input, state);
  InterlockVerdict verdict;
  if (state.has_tripped || !is_plainly_safe(limits, input, before, state)) {
    conclude(limits, rules, input, before, state, verdict);
  }
  if (input.is_new_sample) remember(input, state);
  return verdict;
}

std::optional<InterlockLevel> level_of(InterlockKind kind, const SiteLimits& limits, const InterlockInput& input,
                                       const SiteVector& measured_displacement_m_before,
                                       const SiteVector& force_n_before) noexcept {
  switch (kind) {
    case InterlockKind::not_finite:
    case InterlockKind::rig_status:
    case InterlockKind::emergency_stop:
    case InterlockKind::stuck_sensor: return {};
    default: break;
  }
  const Finding finding = find(kind, limits, input, {true, measured_displacement_m_before, force_n_before}, {});
  if (!finding.is_judged) return {};
  return InterlockLevel{finding.observed, finding.limit};
}

bool reset_by_operator(const InterlockRules& rules, InterlockState& state) noexcept {
  bool has_reset = false;
  for (std::size_t i = 0; i < kInterlockCount; ++i) {
    if (is_final(rules[i]) || rules[i].clears != ClearCondition::operator_reset) continue;
    has_reset = has_reset || state.latches[i].is_tripped;
    state.latches[i] = {};
  }
  state.has_tripped = has_tripped(state);
  return has_reset;
}

InterlockRules default_interlock_rules() noexcept {
  InterlockRules rules;
  const auto holds = {InterlockKind::not_finite, InterlockKind::rig_status,   InterlockKind::displacement_step,
                      InterlockKind::force_step, InterlockKind::stuck_sensor, InterlockKind::command_age};
  for (const InterlockKind kind : holds) rules[static_cast<std::size_t>(kind)].action = SafetyAction::hold;
  rules[static_cast<std::size_t>(InterlockKind::emergency_stop)].action = SafetyAction::release;
  return rules;
}

std::string_view name(InterlockKind kind) noexcept {
  constexpr std::array<std::string_view, kInterlockCount> kNames{
      "not_finite",         "rig_status",        "displacement",  "force",        "velocity",
      "tracking_error",     "displacement_step", "force_step",    "stuck_sensor", "energy_error",
      "tracking_indicator", "command_age",       "emergency_stop"};
  return kNames[static_cast<std::size_t>(kind)];
}

FaultFlags fault_of(InterlockKind kind) noexcept {
  constexpr std::array<FaultFlags, kInterlockCount> kFaults{
      FaultFlags::not_finite,     FaultFlags::rig_fault,      FaultFlags::displacement_limit, FaultFlags::force_limit,
      FaultFlags::velocity_limit, FaultFlags::tracking_error, FaultFlags::displacement_step,  FaultFlags::force_step,
      FaultFlags::stuck_sensor,   FaultFlags::energy_error,   FaultFlags::tracking_indicator, FaultFlags::command_age,
      FaultFlags::emergency_stop};
  return kFaults[static_cast<std::size_t>(kind)];
}

}  // namespace hybridtest
