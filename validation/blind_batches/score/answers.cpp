#include "validation/blind_batches/score/answers.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>
#include <stdexcept>

#include "core/random.hpp"
#include "validation/blind_batches/batch.hpp"

namespace hybridtest::blind {

namespace {

constexpr double kNormal95 = 1.959963984540054;
constexpr std::size_t kDraws = 2000;
constexpr std::uint64_t kSeed = 1;
constexpr std::size_t kBins = 10;

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

}  // namespace

std::optional<Estimate> proportion(std::size_t successes, std::size_t trials) {
  if (trials == 0) return {};
  const auto n = static_cast<double>(trials);
  const double share = static_cast<double>(successes) / n;
  const double z2 = kNormal95 * kNormal95;
  const double centre = (share + z2 / (2.0 * n)) / (1.0 + z2 / n);
  const double half = kNormal95 / (1.0 + z2 / n) * std::sqrt(share * (1.0 - share) / n + z2 / (4.0 * n * n));
  return Estimate{share, std::max(0.0, centre - half), std::min(1.0, centre + half), trials};
}

std::optional<Estimate> bootstrap(std::size_t count, const Statistic& statistic) {
  if (count == 0) return {};
  std::vector<std::size_t> drawn(count);
  std::iota(drawn.begin(), drawn.end(), 0U);
  const double value = statistic(drawn);
  Random random{kSeed};
  std::vector<double> values(kDraws);
  for (double& of_draw : values) {
    for (std::size_t& index : drawn) index = random.below(count);
    of_draw = statistic(drawn);
  }
  std::ranges::sort(values);
  return Estimate{value, values[kDraws / 40], values[kDraws - 1 - kDraws / 40], count};
}

std::optional<Estimate> mean(const std::vector<double>& values) {
  return bootstrap(values.size(), [&](const std::vector<std::size_t>& drawn) {
    double sum = 0.0;
    for (const std::size_t i : drawn) sum += values[i];
    return sum / static_cast<double>(drawn.size());
  });
}

std::optional<Estimate> median(const std::vector<double>& values) {
  return bootstrap(values.size(), [&](const std::vector<std::size_t>& drawn) {
    std::vector<double> chosen;
    chosen.reserve(drawn.size());
    for (const std::size_t i : drawn) chosen.push_back(values[i]);
    return median_of(std::move(chosen));
  });
}

std::optional<Estimate> calibration_error(const std::vector<Forecast>& forecasts) {
  return bootstrap(forecasts.size(), [&](const std::vector<std::size_t>& drawn) {
    std::array<double, kBins> excess{};  // sum of probabilities minus number of right answers, per bin
    for (const std::size_t i : drawn) {
      const auto bin = static_cast<std::size_t>(forecasts[i].probability * static_cast<double>(kBins));
      excess[std::min(bin, kBins - 1)] += forecasts[i].probability - (forecasts[i].came_true ? 1.0 : 0.0);
    }
    double sum = 0.0;
    for (const double of_bin : excess) sum += std::abs(of_bin);
    return sum / static_cast<double>(drawn.size());
  });
}

namespace {

using Json = nlohmann::ordered_json;

/// A number; nothing if the key is missing or null, which stands for a value that is not finite.
std::optional<double> number_in(const Json& json, const char* name) {
  const auto found = json.find(name);
  if (found == json.end() || !found->is_number()) return {};
  return found->get<double>();
}

AnsweredCause read_cause(const Json& json) {
  AnsweredCause cause;
  cause.interface = json.at("interface").get<std::string>();
  cause.effect = json.at("effect").get<std::string>();
  if (const auto law = json.find("law"); law != json.end() && law->is_string()) cause.law = law->get<std::string>();
  cause.probability = number_in(json, "probability").value_or(0.0);
  const Json parameters = json.value("parameters", Json::object());
  for (const auto& [name, parameter] : parameters.items()) {
    const std::optional<double> value = number_in(parameter, "value");
    if (!value) continue;
    AnsweredParameter& answered = cause.parameters[name];
    answered.value = *value;
    const auto interval = parameter.find("ci95");
    if (interval == parameter.end() || !interval->is_array() || interval->size() != 2) continue;
    if (!(*interval)[0].is_number() || !(*interval)[1].is_number()) continue;
    answered.ci95.emplace((*interval)[0].get<double>(), (*interval)[1].get<double>());
  }
  return cause;
}

}  // namespace

Answer read_answer(std::string_view text) {
  try {
    const Json json = Json::parse(text);
    Answer answer;
    answer.verdict = json.at("verdict").get<std::string>();
    if (std::ranges::find(known_verdicts(), answer.verdict) == known_verdicts().end() || answer.verdict == "missing") {
      throw std::runtime_error{"verdict: '" + answer.verdict +
                               "' is unknown; expected none, named, set, partial, unknown or "
                               "not_excited"};
    }
    for (const Json& cause : json.at("causes")) answer.causes.push_back(read_cause(cause));
    // Causes of different gaps are in the order of their shares; their probabilities do not compare.
    if (answer.is_set()) {
      std::ranges::stable_sort(answer.causes, std::ranges::greater{}, &AnsweredCause::probability);
    }
    const Json corrections = json.value("corrections", Json::array());
    for (const Json& number : corrections) answer.corrections.push_back(read_cause(number));
    double largest = 0.0;
    std::string at_largest;
    const Json places = json.value("where", Json::array());
    for (const Json& place : places) {
      const std::string interface = place.at("interface").get<std::string>();
      const auto verdict = place.find("verdict");
      if (verdict != place.end() && *verdict == "unknown") answer.faulty_interfaces.push_back(interface);
      const double share = number_in(place, "share").value_or(0.0);
      if (share <= largest) continue;
      largest = share;
      at_largest = interface;
    }
    if (!at_largest.empty()) answer.faulty_interfaces.push_back(at_largest);
    const Json shrink = json.value("shrink", Json::object());
    if (const auto at = shrink.find("interface"); at != shrink.end() && at->is_object()) {
      answer.variance_removed = number_in(*at, "variance_removed");
    }
    return answer;
  } catch (const Json::exception& error) {
    throw std::runtime_error{error.what()};
  }
}

const std::vector<std::string>& known_verdicts() {
  static const std::vector<std::string> verdicts{"none",    "named",       "set",    "partial",
                                                 "unknown", "not_excited", "missing"};
  return verdicts;
}

namespace {

using Json = nlohmann::ordered_json;

TruthClass class_named(const std::string& name) {
  for (const TruthClass kind : {TruthClass::none, TruthClass::named, TruthClass::law, TruthClass::pair,
                                TruthClass::partial, TruthClass::unknown}) {
    if (name_of(kind) == name) return kind;
  }
  throw std::runtime_error{"truth: '" + name + "' is unknown; expected none, named, law, pair, partial or unknown"};
}

/// Keys of earlier batches have fewer lists.
std::vector<Cause> causes_in(const Json& json, const char* name) {
  std::vector<Cause> causes;
  for (const Json& cause : json.value(name, Json::array())) {
    causes.push_back({cause.at("interface").get<std::string>(), cause.at("effect").get<std::string>(),
                      cause.value("law", std::string{})});
  }
  return causes;
}

PlantEffect read_effect(const Json& json) {
  return {json.at("interface").get<std::string>(), json.at("effect").get<std::string>(),
          json.at("parameters").get<Parameters>(), json.value("plant_law", std::string{})};
}

/// A gap that the plant could not compute was written as null.
double gap_in(const Json& json, const char* field) {
  const Json& gap = json.at(field);
  return gap.is_null() ? std::numeric_limits<double>::quiet_NaN() : gap.get<double>();
}

KeyCase read_case(const Json& json) {
  KeyCase result;
  result.name = json.at("case").get<std::string>();
  result.truth = class_named(json.at("truth").get<std::string>());
  result.gap_to_floor = gap_in(json, "gap_to_floor");
  for (const Json& effect : json.at("effects")) {
    PlantEffect read = read_effect(effect);
    std::vector<Cause> acceptable = causes_in(effect, "acceptable");
    if (!effect.contains("acceptable")) acceptable = {{read.interface, read.name}};
    result.effects.push_back(std::move(read));
    result.effect_acceptable.push_back(std::move(acceptable));
    result.effect_gaps_to_floor.push_back(effect.contains("gap_to_floor") ? gap_in(effect, "gap_to_floor")
                                                                          : result.gap_to_floor);
  }
  for (const Json& beside : json.value("besides", Json::array())) result.besides.push_back(read_effect(beside));
  result.acceptable = causes_in(json, "acceptable");
  result.acceptable_in_part = causes_in(json, "acceptable_in_part");
  result.tolerated = causes_in(json, "tolerated");
  result.is_separable = json.value("is_separable", result.acceptable.size() == 1);
  result.is_closed_loop = json.value("is_closed_loop", false);
  result.gap_at = json.at("gap_at").get<std::string>();
  result.held_out_gap_to_floor = gap_in(json, "held_out_gap_to_floor");
  result.variance_removed = json.at("variance_removed_by_true_model").get<double>();
  return result;
}

}  // namespace

bool KeyCase::can_be_scored() const noexcept {
  return std::isfinite(gap_to_floor) && std::isfinite(held_out_gap_to_floor);
}

std::vector<KeyCase> read_key(std::string_view text) {
  try {
    const Json json = Json::parse(text);
    if (json.at("schema") != "hybridtest/blind_key/1")
      throw std::runtime_error{"schema: unknown; expected hybridtest/blind_key/1"};
    std::vector<KeyCase> cases;
    for (const Json& of_case : json.at("cases")) cases.push_back(read_case(of_case));
    return cases;
  } catch (const Json::exception& error) {
    throw std::runtime_error{std::string{"the key cannot be read: "} + error.what()};
  }
}

namespace {

constexpr double kClearGapToFloor = 2.0;
/// An effect below the noise floor is correctly not found.
constexpr double kHiddenGapToFloor = 1.0;
/// From here on an answer is sure.
constexpr double kSure = 0.9;

bool is_in(const std::vector<Cause>& causes, const AnsweredCause& answered) {
  return std::ranges::any_of(causes, [&](const Cause& cause) {
    const bool is_law_right =
        cause.law.empty() || cause.law == answered.law || (answered.law.empty() && cause.law == kUnsaidLaw);
    return cause.interface == answered.interface && cause.effect == answered.effect && is_law_right;
  });
}

bool is(const PlantEffect& effect, const AnsweredCause& cause) {
  return effect.interface == cause.interface && effect.name == cause.effect;
}

/// Whether a cause is right in an answer with this verdict.
bool is_acceptable(const KeyCase& key, const Answer& answer, const AnsweredCause& cause) {
  return is_in(key.acceptable, cause) || (answer.verdict == "partial" && is_in(key.acceptable_in_part, cause));
}

std::set<std::string> right_interfaces(const KeyCase& key) {
  std::set<std::string> interfaces;
  for (const PlantEffect& effect : key.effects) interfaces.insert(effect.interface);
  for (const Cause& cause : key.acceptable) interfaces.insert(cause.interface);
  // If no effect of the library acts, the right answer can only name the interface of the residual.
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
    return answer.verdict == "unknown" &&
           std::ranges::any_of(answer.faulty_interfaces, [&](const std::string& at) { return right.contains(at); });
  }
  if (answer.is_set()) {
    return std::ranges::any_of(answer.causes, [&](const AnsweredCause& c) { return right.contains(c.interface); });
  }
  return right.contains(answer.causes.front().interface);
}

bool cause_is_right(const KeyCase& key, const Answer& answer) {
  if (!answer.names_a_cause() || answer.causes.empty()) return false;
  const auto is_right = [&](const AnsweredCause& cause) { return is_acceptable(key, answer, cause); };
  return answer.is_set() ? std::ranges::any_of(answer.causes, is_right) : is_right(answer.causes.front());
}

/// The probability that the named effect is right; of a set, that one of its members is.
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

/// Of the true ones that the answer has, as causes or as corrections.
std::vector<ParameterError> errors_of(const PlantEffects& effects, const Answer& answer) {
  std::vector<AnsweredCause> said = answer.corrections;
  if (answer.names_a_cause()) said.insert(said.end(), answer.causes.begin(), answer.causes.end());
  std::vector<ParameterError> errors;
  for (const PlantEffect& effect : effects) {
    for (const AnsweredCause& cause : said) {
      if (is(effect, cause)) std::ranges::move(errors_of(effect, cause), std::back_inserter(errors));
    }
  }
  return errors;
}

void mark_named(const KeyCase& key, const Answer& answer, MarkedCase& marked) {
  const bool has_causes = answer.names_a_cause() && !answer.causes.empty();
  if (key.is_separable) {
    marked.is_single_name_right = has_causes && !answer.is_set() && cause_is_right(key, answer);
  }
  if (!has_causes) return;
  marked.causes_answered = answer.is_set() ? answer.causes.size() : 1;
  if (answer.is_set()) {
    marked.is_true_one_covered =
        std::ranges::any_of(answer.causes, [&](const AnsweredCause& cause) { return is(key.effects.front(), cause); });
  }
}

/// Each effect by a cause of its own: an order of the causes whose first ones are right for the effects.
bool finds_all(const KeyCase& key, const Answer& answer) {
  if (!answer.names_a_cause() || answer.causes.size() < key.effects.size()) return false;
  std::vector<std::size_t> order(answer.causes.size());
  std::iota(order.begin(), order.end(), 0U);
  do {
    bool all = true;
    for (std::size_t e = 0; e < key.effects.size(); ++e) {
      all = all && is_in(key.effect_acceptable[e], answer.causes[order[e]]);
    }
    if (all) return true;
  } while (std::ranges::next_permutation(order).found);
  return false;
}

bool is_of_the_library(const KeyCase& key) {
  return key.truth == TruthClass::named || key.truth == TruthClass::law || key.truth == TruthClass::pair;
}

}  // namespace

Answer with_true_corrections(const KeyCase& key, Answer answer) {
  const bool was_silent = answer.causes.empty();
  for (const AnsweredCause& number : answer.corrections) {
    if (is_in(key.acceptable, number)) answer.causes.push_back(number);
  }
  if (was_silent && !answer.causes.empty() && answer.verdict == "none") answer.verdict = "named";
  return answer;
}

Answer without_tolerated(const KeyCase& key, Answer given) {
  if (!given.names_a_cause()) return given;
  Answer answer = given;
  const std::size_t dropped =
      std::erase_if(answer.causes, [&](const AnsweredCause& cause) { return is_in(key.tolerated, cause); });
  if (dropped == 0) return given;
  // Members of a set share its probability. What has one of its own is a name, beside a set of what is tolerated.
  const bool are_names = !answer.is_set() || std::ranges::all_of(answer.causes, [](const AnsweredCause& cause) {
    return cause.probability >= kSure;
  });
  if (are_names && !answer.causes.empty()) {
    if (answer.is_set()) answer.verdict = "named";
    return answer;
  }
  if (given.is_set() && cause_is_right(key, given)) return given;
  answer.causes.clear();
  answer.verdict = answer.verdict == "partial" ? "unknown" : "none";
  return answer;
}

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
  marked.given.verdict = "missing";
  if (given) marked.given = *given;
  marked.answer = without_tolerated(key, with_true_corrections(key, marked.given));
  const Answer& answer = marked.answer;
  const bool is_right = cause_is_right(key, answer);
  const bool is_cleared = key.truth == TruthClass::none || key.truth == TruthClass::unknown;
  if (key.truth != TruthClass::none) marked.is_interface_right = interface_is_right(key, answer);
  if (is_cleared) marked.is_falsely_named = answer.names_a_cause() && !is_right;
  if (is_of_the_library(key)) marked.is_effect_right = is_rightly_silent(key, answer) || is_right;
  if (key.truth == TruthClass::partial) marked.is_partial_right = answer.verdict == "partial" && is_right;
  if (key.truth == TruthClass::named) mark_named(key, answer, marked);
  const bool is_single = key.truth == TruthClass::named || key.truth == TruthClass::law;
  if (is_single && is_right && !answer.is_set()) {
    marked.has_spurious_cause = std::ranges::any_of(
        answer.causes, [&](const AnsweredCause& cause) { return !is_acceptable(key, answer, cause); });
  }
  if (key.truth == TruthClass::pair &&
      std::ranges::all_of(key.effect_gaps_to_floor, [](double gap) { return gap >= kClearGapToFloor; })) {
    marked.are_both_found = finds_all(key, answer);
  }
  marked.parameter_errors = errors_of(key.effects, marked.given);
  marked.number_errors = errors_of(key.besides, marked.given);
  if (answer.names_a_cause() && !answer.causes.empty()) {
    marked.forecast = forecast_of(key, answer);
    marked.is_sure_and_wrong = answer.verdict != "partial" && marked.forecast->probability >= kSure && !is_right;
  }
  if (is_of_the_library(key) && is_right) {
    marked.variance_short = std::max(0.0, key.variance_removed) - answer.variance_removed.value_or(0.0);
  }
  return marked;
}

}  // namespace hybridtest::blind
