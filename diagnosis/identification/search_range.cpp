#include "diagnosis/identification/search_range.hpp"

#include <algorithm>
#include <cmath>

namespace hybridtest {
namespace {

/// Ranges of positive values wider than this are searched in their logarithm.
constexpr double kDecade = 10.0;

bool touches_several(const IdentificationProblem& problem, const EffectType& effect) {
  bool displacement = false;
  bool force = false;
  for (const FitSegment& fit : problem.segments) {
    if (!fit.segment.touched_by(effect)) continue;
    (fit.segment.to == Channel::measured_force ? force : displacement) = true;
  }
  return force && effect.interface == EffectInterface::displacement_sensor;
}

/// Damping of a specimen's law at rest in the middle, which an effect may take off.
double damping_of_law(const IdentificationProblem& problem) {
  if (!problem.model.make_law) return 0.0;
  const double velocity_m_per_s = problem.scales.of(ParameterScale::velocity_m_per_s);
  return problem.model.make_law()->trial(0.0, velocity_m_per_s) / velocity_m_per_s;
}

/// The least that real sites have of a linear parameter: what is searched for above zero only, none; of an amount, none
/// together with what the model has.
double least_of(const IdentificationProblem& problem, const EffectType& effect, std::size_t index) {
  const EffectParameter& parameter = effect.parameters[index];
  if (parameter.search_low >= 0.0) return std::max(0.0, parameter.low);
  if (!parameter.is_amount) return parameter.low;
  double has = parameter.scale == ParameterScale::damping_n_s_per_m ? damping_of_law(problem) : 0.0;
  for (const EffectSetting& known : problem.model.effects) {
    if (known.type == &effect) has += known.values[index];
  }
  return std::max(parameter.low, -std::max(0.0, has));
}

SearchedParameter searched(const IdentificationProblem& problem, const EffectType& effect, std::size_t position,
                           std::size_t index) {
  const EffectParameter& parameter = effect.parameters[index];
  const double scale = problem.scales.of(parameter.scale);
  SearchedParameter result{.effect = position, .parameter = index};
  result.low = std::clamp(parameter.search_low * scale, parameter.low, parameter.high);
  result.high = std::clamp(parameter.search_high * scale, parameter.low, parameter.high);
  const bool is_delay = effect.interface == EffectInterface::transfer_system && effect.name == "delay";
  if (is_delay) result.low = std::max(result.low, -problem.model.removable_delay_s);
  const DelaySetting& setting = problem.model.compensator_delay;
  if (effect.interface == EffectInterface::compensator && effect.name == "setting_mismatch" && setting.most_s > 0.0) {
    result.low = std::max(result.low, -setting.set_s);
    result.high = std::min(result.high, setting.most_s - setting.set_s);
  }
  result.is_instant = parameter.scale == ParameterScale::duration_s;
  result.logarithmic = result.low > 0.0 && result.high > kDecade * result.low;
  return result;
}

}  // namespace

bool is_fixed(const IdentificationProblem& problem, const EffectParameter& parameter) {
  const LawUse other = problem.law_is_spring ? LawUse::with_strength : LawUse::spring_or_none;
  return parameter.search_low == parameter.search_high || parameter.needs == other;
}

double SearchedParameter::at(double place) const noexcept {
  return logarithmic ? low * std::pow(high / low, place) : low + (high - low) * place;
}

double SearchedParameter::place_of(double value) const noexcept {
  const double inside = std::clamp(value, low, high);
  return logarithmic ? std::log(inside / low) / std::log(high / low) : (inside - low) / (high - low);
}

SearchPlan plan_search(const IdentificationProblem& problem, const std::vector<const EffectType*>& effects) {
  SearchPlan plan;
  plan.linear_ones_remove_all = true;
  for (std::size_t i = 0; i < effects.size(); ++i) {
    const EffectType& effect = *effects[i];
    const bool all_searched = touches_several(problem, effect);
    EffectSetting neutral{.type = &effect, .values = {}};
    bool removed_by_linear = false;
    for (std::size_t j = 0; j < effect.parameters.size(); ++j) {
      const EffectParameter& parameter = effect.parameters[j];
      const double unit = 0.5 * parameter.search_high * problem.scales.of(parameter.scale);
      if (is_fixed(problem, parameter)) {
        neutral.values.push_back(parameter.fallback);
      } else if (parameter.is_linear && !all_searched) {
        neutral.values.push_back(parameter.neutral);
        const double low = least_of(problem, effect, j);
        plan.linear.push_back({i, j, unit, low - parameter.neutral, parameter.high - parameter.neutral});
        removed_by_linear = true;
      } else {
        plan.searched.push_back(searched(problem, effect, i, j));
        neutral.values.push_back(plan.searched.back().at(0.5));
      }
    }
    plan.linear_ones_remove_all = plan.linear_ones_remove_all && removed_by_linear;
    plan.neutral.push_back(std::move(neutral));
  }
  return plan;
}

}  // namespace hybridtest
