#include "validation/blind_batches/score/score.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

// Answers of which the score is known beforehand.
namespace hybridtest::blind {
namespace {

using testing::HasSubstr;
using Json = nlohmann::ordered_json;

KeyCase key_case(TruthClass truth, const std::vector<Cause>& effects, double gap_to_floor = 50.0) {
  KeyCase key;
  key.name = "case_0001";
  key.truth = truth;
  for (const Cause& effect : effects) key.effects.push_back({effect.interface, effect.effect, {{"amount_n", 100.0}}});
  if (truth != TruthClass::unknown) key.acceptable = effects;
  key.gap_at = "specimen";
  key.gap_to_floor = key.held_out_gap_to_floor = gap_to_floor;
  key.variance_removed = 0.99;
  return key;
}

/// Ten of each class; friction, or friction and bias.
std::vector<KeyCase> forty_cases() {
  const Cause friction{"specimen", "coulomb_friction"};
  std::vector<KeyCase> keys;
  for (int i = 0; i < 10; ++i) {
    keys.push_back(key_case(TruthClass::none, {}));
    keys.push_back(key_case(TruthClass::named, {friction}));
    keys.push_back(key_case(TruthClass::pair, {friction, {"force_sensor", "bias"}}));
    keys.push_back(key_case(TruthClass::unknown, {{"specimen", "cogging"}}));
  }
  return keys;
}

std::string diagnosis(const std::string& verdict, const std::vector<Cause>& causes, double probability) {
  Json json{{"schema", "hybridtest/diagnosis/1"}, {"verdict", verdict}};
  json["where"] = {{{"interface", "transfer_system"}, {"share", 0.1}}, {{"interface", "specimen"}, {"share", 0.9}}};
  json["causes"] = Json::array();
  for (const Cause& cause : causes) {
    json["causes"].push_back({{"interface", cause.interface},
                              {"effect", cause.effect},
                              {"probability", probability},
                              {"parameters", {{"amount_n", {{"value", 110.0}, {"ci95", {90.0, 120.0}}}}}}});
  }
  json["shrink"] = {{"interface", {{"variance_removed", 0.97}}}};
  return json.dump();
}

Score scored(const std::function<std::optional<Answer>(const KeyCase&)>& answering) {
  std::vector<MarkedCase> marked;
  for (const KeyCase& key : forty_cases()) marked.push_back(mark(key, answering(key)));
  return score_of(marked);
}

const Figure& figure(const Score& score, const std::string& name) {
  for (const Figure& of_score : score.clear) {
    if (of_score.name == name) return of_score;
  }
  throw std::runtime_error{name};
}

double value(const Score& score, const std::string& name) { return figure(score, name).estimate.value().value; }

Answer right_answer(const KeyCase& key) {
  if (key.truth == TruthClass::none) return read_answer(diagnosis("none", {}, 0.0));
  if (key.truth == TruthClass::unknown) return read_answer(diagnosis("unknown", {}, 0.0));
  return read_answer(diagnosis("named", key.acceptable, 1.0));
}

TEST(Score, AllRightMeetsEveryTarget) {
  const Score score = scored(right_answer);
  for (const Figure& of_score : score.clear) EXPECT_TRUE(of_score.is_met().value_or(true)) << of_score.name;
  EXPECT_DOUBLE_EQ(value(score, "interface_right"), 1.0);
  EXPECT_DOUBLE_EQ(value(score, "effect_right_or_in_set"), 1.0);
  EXPECT_DOUBLE_EQ(value(score, "single_name_right_where_separable"), 1.0);
  EXPECT_DOUBLE_EQ(value(score, "both_of_a_pair_found"), 1.0);
  EXPECT_DOUBLE_EQ(value(score, "mean_set_size"), 1.0);
  EXPECT_DOUBLE_EQ(value(score, "false_names_on_none_and_unknown"), 0.0);
  EXPECT_NEAR(value(score, "expected_calibration_error"), 0.0, 1e-12);
  EXPECT_NEAR(value(score, "variance_short_of_true_model"), 0.02, 1e-12);
  EXPECT_NEAR(value(score, "median_relative_parameter_error"), 0.1, 1e-12);
  EXPECT_DOUBLE_EQ(value(score, "true_parameter_in_interval"), 1.0);
  EXPECT_TRUE(score.wrong.empty());
  EXPECT_EQ(score.clear_confusion.at("named").at("named"), 10U);
  EXPECT_EQ(score.clear_confusion.at("unknown").at("unknown"), 10U);
}

TEST(Score, AllWrongMissesEveryNamedTarget) {
  const Score score = scored([](const KeyCase&) {
    return read_answer(diagnosis("named", {{"displacement_sensor", "drift"}}, 0.9));
  });
  for (const char* name : {"interface_right", "effect_right_or_in_set", "single_name_right_where_separable",
                           "false_names_on_none_and_unknown", "expected_calibration_error"}) {
    EXPECT_FALSE(figure(score, name).is_met().value()) << name;
  }
  EXPECT_DOUBLE_EQ(value(score, "effect_right_or_in_set"), 0.0);
  EXPECT_DOUBLE_EQ(value(score, "false_names_on_none_and_unknown"), 1.0);
  EXPECT_NEAR(value(score, "expected_calibration_error"), 0.9, 1e-12);
  EXPECT_FALSE(figure(score, "variance_short_of_true_model").estimate.has_value());
  EXPECT_EQ(score.wrong.size(), 40U);
}

TEST(Score, AllUnknownHasNoFalseNamesAndNoHits) {
  const Score score = scored([](const KeyCase&) { return read_answer(diagnosis("unknown", {}, 0.0)); });
  EXPECT_DOUBLE_EQ(value(score, "effect_right_or_in_set"), 0.0);
  EXPECT_DOUBLE_EQ(value(score, "false_names_on_none_and_unknown"), 0.0);
  EXPECT_DOUBLE_EQ(value(score, "interface_right"), 1.0);  // where: specimen
  EXPECT_DOUBLE_EQ(value(score, "unknown_called_unknown"), 1.0);
  EXPECT_DOUBLE_EQ(value(score, "none_called_none"), 0.0);
  EXPECT_FALSE(figure(score, "mean_set_size").estimate.has_value());
}

TEST(Score, MissingAnswerCountsAsWrong) {
  const Score score = scored([](const KeyCase&) { return std::optional<Answer>{}; });
  EXPECT_DOUBLE_EQ(value(score, "effect_right_or_in_set"), 0.0);
  EXPECT_DOUBLE_EQ(value(score, "interface_right"), 0.0);
  EXPECT_DOUBLE_EQ(value(score, "none_called_none"), 0.0);
  EXPECT_EQ(score.confusion.at("named").at("missing"), 10U);
}

TEST(Score, SetIsRightByAnyMemberAndCountedBySize) {
  const Cause friction{"specimen", "coulomb_friction"};
  const Cause stribeck{"specimen", "stribeck_friction"};
  const Answer answer = read_answer(diagnosis("set", {stribeck, friction}, 0.45));
  const MarkedCase marked = mark(key_case(TruthClass::named, {friction}), answer);
  EXPECT_TRUE(marked.is_effect_right.value());
  EXPECT_TRUE(marked.is_true_one_covered.value());
  EXPECT_FALSE(marked.is_single_name_right.value());
  EXPECT_EQ(marked.causes_answered.value(), 2U);
  EXPECT_NEAR(marked.forecast.value().probability, 0.9, 1e-12);
}

TEST(Score, EquivalentCauseCountsAsRight) {
  KeyCase key = key_case(TruthClass::named, {{"specimen", "stiffness_error"}});
  key.acceptable.push_back({"force_sensor", "gain"});
  const MarkedCase marked = mark(key, read_answer(diagnosis("named", {{"force_sensor", "gain"}}, 0.8)));
  EXPECT_TRUE(marked.is_effect_right.value());
  EXPECT_TRUE(marked.is_interface_right.value());
  EXPECT_FALSE(marked.is_single_name_right.has_value());
}

TEST(Score, HiddenEffectIsRightlyCalledNothing) {
  const KeyCase hidden = key_case(TruthClass::named, {{"specimen", "inertia"}}, 0.4);
  const MarkedCase marked = mark(hidden, read_answer(diagnosis("none", {}, 0.0)));
  EXPECT_TRUE(marked.is_effect_right.value());
  EXPECT_FALSE(marked.is_clear());
  EXPECT_FALSE(mark(key_case(TruthClass::named, {{"specimen", "inertia"}}, 1.5), right_answer(hidden)).is_clear());
}

TEST(Score, TextAndJsonListMissedTargets) {
  const Score score = scored([](const KeyCase& key) {
    if (key.truth != TruthClass::none) return right_answer(key);
    return read_answer(diagnosis("named", {{"specimen", "inertia"}}, 0.7));
  });
  const std::string text = score_text(score);
  EXPECT_THAT(text, HasSubstr("MISSED (at most 0.05)"));
  EXPECT_THAT(text, HasSubstr("met    (at least 0.95)"));
  EXPECT_THAT(text, HasSubstr("said: named specimen.inertia (0.70)"));
  const Json json = score_json(score);
  EXPECT_FALSE(json["clear"]["false_names_on_none_and_unknown"]["met"].get<bool>());
  EXPECT_DOUBLE_EQ(json["clear"]["false_names_on_none_and_unknown"]["value"].get<double>(), 0.5);
  EXPECT_EQ(json["wrong"].size(), 10U);
}

TEST(Answer, ReportsErrorsOfADiagnosis) {
  EXPECT_THROW((void)read_answer("{"), std::runtime_error);
  EXPECT_THROW((void)read_answer(R"({"verdict": "named"})"), std::runtime_error);
  try {
    (void)read_answer(R"({"verdict": "perhaps", "causes": []})");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("perhaps"));
  }
}

TEST(Answer, AcceptsMissingNumbers) {
  const Answer answer = read_answer(R"({"verdict": "named", "causes": [{"interface": "specimen", "effect": "gap",
      "probability": null, "parameters": {"clearance_m": {"value": null}}}], "shrink": {"interface": null}})");
  EXPECT_DOUBLE_EQ(answer.causes.front().probability, 0.0);
  EXPECT_TRUE(answer.causes.front().parameters.empty());
  EXPECT_FALSE(answer.variance_removed.has_value());
}

}  // namespace
}  // namespace hybridtest::blind
