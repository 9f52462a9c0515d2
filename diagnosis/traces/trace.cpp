#include "diagnosis/traces/trace.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "diagnosis/localisation/gap_signals.hpp"
#include "diagnosis/traces/network_lags.hpp"
#include "diagnosis/traces/reading_steps.hpp"
#include "diagnosis/tuning.hpp"

namespace hybridtest {
namespace {

bool has(const SiteModel& model, const EffectType* type) {
  return std::ranges::any_of(model.effects, [type](const EffectSetting& effect) { return effect.type == type; });
}

/// Coarse steps of one sensor, unless they are finer than what no model is expected to reproduce.
std::optional<Trace> trace_of_sensor(EffectInterface sensor, Channel channel, const std::vector<double>& values) {
  const double step = steps_of_readings(values).step;
  const EffectType* const type = find_effect(sensor, DigitTrace::rounding);
  const double variance =
      step * step / 12.0;  // Widrow and Kollar (2008): of an even error between half a step each way
  const double all = mean_square(values);
  if (type == nullptr || !(variance > tuning::kModelAllowance * tuning::kModelAllowance * all)) return {};
  return Trace{.effect = {.type = type, .values = {step}}, .in = channel, .gap_share = variance / all};
}

std::vector<Trace> traces_of(const DofRecording& dof, double period_s) {
  std::vector<Trace> traces;
  const auto add = [&](std::optional<Trace> trace) {
    if (trace) traces.push_back(std::move(*trace));
  };
  if (dof.has(Channel::sent_displacement) && dof.has(Channel::target_displacement)) {
    add(trace_of_network(dof.of(Channel::sent_displacement), dof.of(Channel::target_displacement), period_s));
  }
  add(trace_of_sensor(EffectInterface::displacement_sensor, Channel::measured_displacement,
                      dof.of(Channel::measured_displacement)));
  add(trace_of_sensor(EffectInterface::force_sensor, Channel::measured_force, dof.of(Channel::measured_force)));
  return traces;
}

}  // namespace

bool shows_in_digits(const EffectType& effect) noexcept { return effect.traits.digits != DigitTrace::none; }

std::vector<Trace> find_traces(const SiteModel& model, std::span<const Recording> recordings, std::size_t dof) {
  std::vector<Trace> found;
  for (const Recording& recording : recordings) {
    if (recording.role != RecordingRole::fit || recording.dofs.size() <= dof) continue;
    for (Trace& trace : traces_of(recording.dofs[dof], recording.sample_period_s)) {
      if (has(model, trace.effect.type)) continue;
      const auto known =
          std::ranges::find_if(found, [&](const Trace& other) { return other.effect.type == trace.effect.type; });
      if (known == found.end()) {
        found.push_back(std::move(trace));
      } else {
        known->gap_share += trace.gap_share;
      }
    }
  }
  return found;
}

}  // namespace hybridtest
