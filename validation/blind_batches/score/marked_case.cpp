#include "validation/blind_batches/score/marked_case.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace hybridtest::blind {
namespace {

constexpr double kClearGapToFloor = 2.0;
/// An effect that noise hides is rightly not seen.
constexpr double kHiddenGapToFloor = 1.0;

bool is_acceptable(const KeyCase& key, const AnsweredCause& cause) {
  return std::ranges::find(key.acceptable, Cause{cause.interface, cause.effect}) != key.acceptable.end();
}

bool is(const PlantEffect& effect, const AnsweredCause& cause) {
  return effect.interface == cause.interface && effect.name == cause.effect;
}

std::set<std::string> right_interfaces(const KeyCase& key) {
  std::set<std::string> interfaces;
  for (const PlantEffect& effect : key.effects) interfaces.insert(effect.interface);
  for (const Cause& cause : key.acceptable) interfaces.insert(cause.interface);
  // Where nothing of the library acts, the place of the residual is as much as can be said.
  if (key.truth == TruthClass::unknown) interfaces.insert(key.gap_at);
  return interfaces;
}

bool is_rightly_silent(const KeyCase& key, const Answer& answer) {
  return key.gap_to_floor < kHiddenGapToFloor && (answer.verdict == "none" || answer.verdict == "not_excited");
}

bool interface_is_right(const KeyCase& key, const Answer& answer) {
  if (is_rightly_silent(key, answer)) return true;
  const std::set<std::string> right = right_interfaces(key);
  if (!answer.names_a_cause() || answer.causes.empty()) {
    return answer.verdict == "unknown" && right.contains(answer.faulty_interface);
  }
  if (answer.is_set()) {
    return std::ranges::any_of(answer.causes, [&](const AnsweredCause& c) { return right.contains(c.interface); });
  }
  return right.contains(answer.causes.front().interface);
}

bool cause_is_right(const KeyCase& key, const Answer& answer) {
  if (!answer.names_a_cause() || answer.causes.empty()) return false;
  if (!answer.is_set()) return is_acceptable(key, answer.causes.front());
  return std::ranges::any_of(answer.causes, [&](const AnsweredCause& cause) { return is_acceptable(key, cause); });
}

/// The probability that what is named holds: of a set, that one of its members does.
Forecast forecast_of(const KeyCase& key, const Answer& answer) {
  double probability = answer.causes.front().probability;
  if (answer.is_set()) {
    probability = 0.0;
    for (const AnsweredCause& cause : answer.causes) probability += cause.probability;
  }
  return {std::clamp(probability, 0.0, 1.0), cause_is_right(key, answer)};
}

std::vector<ParameterError> errors_of(const PlantEffect& effect, const AnsweredCause& cause) {
  std::vector<ParameterError> errors;
  for (const auto& [name, truth] : effect.parameters) {
    const auto found = cause.parameters.find(name);
    if (found == cause.parameters.end() || truth == 0.0) continue;
    ParameterError error{effect.name + "." + name, std::abs(found->second.value / truth - 1.0), {}};
    if (const auto& interval = found->second.ci95) {
      error.is_in_interval = interval->first <= truth && truth <= interval->second;
    }
    errors.push_back(std::move(error));
  }
  return errors;
}

void mark_named(const KeyCase& key, const Answer& answer, MarkedCase& marked) {
  const PlantEffect& effect = key.effects.front();
  const bool has_causes = answer.names_a_cause() && !answer.causes.empty();
  if (key.acceptable.size() == 1) {
    marked.is_single_name_right = has_causes && !answer.is_set() && is(effect, answer.causes.front());
  }
  if (!has_causes) return;
  marked.causes_answered = answer.is_set() ? answer.causes.size() : 1;
  if (answer.is_set()) {
    marked.is_true_one_covered =
        std::ranges::any_of(answer.causes, [&](const AnsweredCause& cause) { return is(effect, cause); });
  }
  for (const AnsweredCause& cause : answer.causes) {
    if (is(effect, cause)) marked.parameter_errors = errors_of(effect, cause);
  }
}

}  // namespace

bool MarkedCase::is_clear() const {
  return key.truth == TruthClass::none ||
         (key.gap_to_floor >= kClearGapToFloor && key.held_out_gap_to_floor >= kClearGapToFloor);
}

bool MarkedCase::is_wrong() const {
  return is_falsely_named.value_or(false) || !is_effect_right.value_or(true) || !is_interface_right.value_or(true);
}

MarkedCase mark(const KeyCase& key, const std::optional<Answer>& given) {
  MarkedCase marked;
  marked.key = key;
  marked.answer.verdict = "missing";
  if (given) marked.answer = *given;
  const Answer& answer = marked.answer;
  const bool is_known = key.truth == TruthClass::named || key.truth == TruthClass::pair;
  if (key.truth != TruthClass::none) marked.is_interface_right = interface_is_right(key, answer);
  if (!is_known) marked.is_falsely_named = answer.names_a_cause();
  if (is_known) marked.is_effect_right = is_rightly_silent(key, answer) || cause_is_right(key, answer);
  if (key.truth == TruthClass::named) mark_named(key, answer, marked);
  if (key.truth == TruthClass::pair) {
    marked.are_both_found = std::ranges::all_of(key.effects, [&](const PlantEffect& effect) {
      return std::ranges::any_of(answer.causes, [&](const AnsweredCause& cause) { return is(effect, cause); });
    });
  }
  if (answer.names_a_cause() && !answer.causes.empty()) marked.forecast = forecast_of(key, answer);
  if (is_known && cause_is_right(key, answer)) {
    marked.variance_short = std::max(0.0, key.variance_removed) - answer.variance_removed.value_or(0.0);
  }
  return marked;
}

}  // namespace hybridtest::blind
