#include "validation/blind_batches/score/sealed_key.hpp"

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "validation/blind_batches/batch_files.hpp"

namespace hybridtest::blind {
namespace {

using Json = nlohmann::ordered_json;

TruthClass class_named(const std::string& name) {
  for (const TruthClass kind : {TruthClass::none, TruthClass::named, TruthClass::unknown, TruthClass::pair}) {
    if (name_of(kind) == name) return kind;
  }
  throw std::runtime_error{"the key has a truth of no class: '" + name + "'"};
}

KeyCase read_case(const Json& json) {
  KeyCase result;
  result.name = json.at("case").get<std::string>();
  result.truth = class_named(json.at("truth").get<std::string>());
  for (const Json& effect : json.at("effects")) {
    result.effects.push_back({effect.at("interface").get<std::string>(), effect.at("effect").get<std::string>(),
                              effect.at("parameters").get<Parameters>()});
  }
  for (const Json& cause : json.at("acceptable")) {
    result.acceptable.push_back({cause.at("interface").get<std::string>(), cause.at("effect").get<std::string>()});
  }
  result.gap_at = json.at("gap_at").get<std::string>();
  result.gap_to_floor = json.at("gap_to_floor").get<double>();
  result.held_out_gap_to_floor = json.at("held_out_gap_to_floor").get<double>();
  result.variance_removed = json.at("variance_removed_by_true_model").get<double>();
  return result;
}

}  // namespace

std::vector<KeyCase> read_key(std::string_view text) {
  try {
    const Json json = Json::parse(text);
    if (json.at("schema") != "hybridtest/blind_key/1") throw std::runtime_error{"no key of hybridtest/blind_key/1"};
    std::vector<KeyCase> cases;
    for (const Json& of_case : json.at("cases")) cases.push_back(read_case(of_case));
    return cases;
  } catch (const Json::exception& error) {
    throw std::runtime_error{std::string{"the key cannot be read: "} + error.what()};
  }
}

}  // namespace hybridtest::blind
