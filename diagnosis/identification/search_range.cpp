#include "diagnosis/identification/search_range.hpp"

#include <algorithm>
#include <cmath>

#include "diagnosis/identification/search_table.hpp"

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
double least_of(const IdentificationProblem& problem, const EffectType& effect, std::size_t index,
                const SearchRange& range) {
  const EffectParameter& parameter = effect.parameters[index];
  if (range.low >= 0.0) return std::max(0.0, parameter.low);
  if (!range.restriction.is_amount) return parameter.low;
  double has = range.scale == ParameterScale::damping_n_s_per_m ? damping_of_law(problem) : 0.0;
  for (const EffectSetting& known : problem.model.effects) {
    if (known.type == &effect) has += known.values[index];
  }
  return std::max(parameter.low, -std::max(0.0, has));
}

SearchedParameter searched(const IdentificationProblem& problem, const EffectType& effect, std::size_t position,
                           std::size_t index, const SearchRange& range) {
  const EffectParameter& parameter = effect.parameters[index];
  const double scale = problem.scales.of(range.scale);
  SearchedParameter result{.effect = position, .parameter = index};
  result.low = std::clamp(range.low * scale, parameter.low, parameter.high);
  result.high = std::clamp(range.high * scale, parameter.low, parameter.high);
  const DelaySetting& setting = problem.model.compensator_delay;
  switch (range.restriction.limit) {
    case SearchLimit::none: break;
    case SearchLimit::removable_delay: result.low = std::max(result.low, -problem.model.removable_delay_s); break;
    case SearchLimit::compensator_setting:
      if (setting.most_s <= 0.0) break;
      result.low = std::max(result.low, -setting.set_s);
      result.high = std::min(result.high, setting.most_s - setting.set_s);
      break;
  }
  result.is_instant = range.scale == ParameterScale::duration_s;
  result.logarithmic = result.low > 0.0 && result.high > kDecade * result.low;
  return result;
}

}  // namespace

bool is_fixed(const IdentificationProblem& problem, const EffectType& effect, const EffectParameter& parameter) {
  const LawUse other = problem.law_is_spring ? LawUse::with_strength : LawUse::spring_or_none;
  const SearchRange* const range = search_range(effect, parameter);
  return range == nullptr || range->restriction.beside == other;
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
      if (is_fixed(problem, effect, parameter)) {
        neutral.values.push_back(parameter.fallback);
        continue;
      }
      const SearchRange& range = *search_range(effect, parameter);
      if (parameter.is_linear && !all_searched) {
        neutral.values.push_back(parameter.neutral);
        const double unit = 0.5 * range.high * problem.scales.of(range.scale);
        const double low = least_of(problem, effect, j, range);
        plan.linear.push_back({i, j, unit, low - parameter.neutral, parameter.high - parameter.neutral});
        removed_by_linear = true;
      } else {
        plan.searched.push_back(searched(problem, effect, i, j, range));
        neutral.values.push_back(plan.searched.back().at(0.5));
      }
    }
    plan.linear_ones_remove_all = plan.linear_ones_remove_all && removed_by_linear;
    plan.neutral.push_back(std::move(neutral));
  }
  return plan;
}

}  // namespace hybridtest
