#include "validation/blind_batches/score/answer.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace hybridtest::blind {
namespace {

using Json = nlohmann::ordered_json;

/// A number, or nothing where a diagnosis wrote null for one that is not finite.
std::optional<double> number_in(const Json& json, const char* name) {
  const auto found = json.find(name);
  if (found == json.end() || !found->is_number()) return {};
  return found->get<double>();
}

AnsweredCause read_cause(const Json& json) {
  AnsweredCause cause;
  cause.interface = json.at("interface").get<std::string>();
  cause.effect = json.at("effect").get<std::string>();
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
      throw std::runtime_error{"verdict: '" + answer.verdict + "' is none of those that a diagnosis has"};
    }
    for (const Json& cause : json.at("causes")) answer.causes.push_back(read_cause(cause));
    std::ranges::stable_sort(answer.causes, std::ranges::greater{}, &AnsweredCause::probability);
    double largest = 0.0;
    const Json places = json.value("where", Json::array());
    for (const Json& place : places) {
      const double share = number_in(place, "share").value_or(0.0);
      if (share <= largest) continue;
      largest = share;
      answer.faulty_interface = place.at("interface").get<std::string>();
    }
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

}  // namespace hybridtest::blind
