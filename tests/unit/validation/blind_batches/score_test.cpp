#include "validation/blind_batches/score/score.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
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
  for (const Cause& effect : effects) {
    key.effects.push_back({effect.interface, effect.effect, {{"amount_n", 100.0}}});
    key.effect_acceptable.push_back({effect});
    key.effect_gaps_to_floor.push_back(gap_to_floor);
  }
  if (truth != TruthClass::unknown) key.acceptable = effects;
  key.gap_at = "specimen";
  key.gap_to_floor = key.held_out_gap_to_floor = gap_to_floor;
  key.variance_removed = 0.99;
  return key;
}

const Cause kFriction{"specimen", "coulomb_friction"};
const Cause kBias{"force_sensor", "bias"};

/// A hundred of each class, so that an interval can meet a target.
std::vector<KeyCase> six_hundred_cases() {
  std::vector<KeyCase> keys;
  for (int i = 0; i < 100; ++i) {
    keys.push_back(key_case(TruthClass::none, {}));
    keys.push_back(key_case(TruthClass::named, {kFriction}));
    keys.push_back(key_case(TruthClass::pair, {kFriction, kBias}));
    keys.push_back(key_case(TruthClass::unknown, {{"specimen", "cogging"}}));
    keys.push_back(key_case(TruthClass::law, {{"specimen", "hysteresis_law"}}));
    keys.back().acceptable = {{"specimen", "hysteresis_law", "pinching"}};
    keys.push_back(key_case(TruthClass::partial, {kFriction, {"specimen", "cogging"}}));
    keys.back().acceptable = {kFriction};
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
                              {"law", cause.law},
                              {"probability", probability},
                              {"parameters", {{"amount_n", {{"value", 110.0}, {"ci95", {90.0, 120.0}}}}}}});
  }
  json["shrink"] = {{"interface", {{"variance_removed", 0.97}}}};
  return json.dump();
}

Score scored(const std::function<std::optional<Answer>(const KeyCase&)>& answering) {
  std::vector<MarkedCase> marked;
  for (const KeyCase& key : six_hundred_cases()) marked.push_back(mark(key, answering(key)));
  return score_of(marked);
}

const Figure& figure(const Score& score, const std::string& name) {
  for (const Figure& of_score : score.clear) {
    if (of_score.name == name) return of_score;
  }
  throw std::runtime_error{name};
}

double value(const Score& score, const std::string& name) { return figure(score, name).estimate.value().value; }

/// Peeks at the truth.
Answer right_answer(const KeyCase& key) {
  if (key.truth == TruthClass::none) return read_answer(diagnosis("none", {}, 0.0));
  if (key.truth == TruthClass::unknown) return read_answer(diagnosis("unknown", {}, 0.0));
  return read_answer(diagnosis(key.truth == TruthClass::partial ? "partial" : "named", key.acceptable, 1.0));
}

TEST(Score, OneThatPeeksMeetsEveryTarget) {
  const Score score = scored(right_answer);
  for (const Figure& of_score : score.clear) {
    if (of_score.name == "true_parameter_in_interval") continue;  // all of them inside: too wide
    EXPECT_TRUE(of_score.is_met().value_or(true)) << of_score.name;
  }
  EXPECT_DOUBLE_EQ(value(score, "interface_right"), 1.0);
  EXPECT_DOUBLE_EQ(value(score, "effect_right_or_in_set"), 1.0);
  EXPECT_DOUBLE_EQ(value(score, "single_name_right_where_separable"), 1.0);
  EXPECT_DOUBLE_EQ(value(score, "both_of_a_pair_found"), 1.0);
  EXPECT_DOUBLE_EQ(value(score, "law_right"), 1.0);
  EXPECT_DOUBLE_EQ(value(score, "partial_called_partial"), 1.0);
  EXPECT_DOUBLE_EQ(value(score, "sure_and_wrong"), 0.0);
  EXPECT_DOUBLE_EQ(value(score, "mean_set_size"), 1.0);
  EXPECT_DOUBLE_EQ(value(score, "false_names_on_none_and_unknown"), 0.0);
  EXPECT_NEAR(value(score, "expected_calibration_error"), 0.0, 1e-12);
  EXPECT_NEAR(value(score, "variance_short_of_true_model"), 0.02, 1e-12);
  EXPECT_NEAR(value(score, "median_relative_parameter_error"), 0.1, 1e-12);
  EXPECT_DOUBLE_EQ(value(score, "true_parameter_in_interval"), 1.0);
  EXPECT_FALSE(figure(score, "true_parameter_in_interval").is_met().value());
  EXPECT_TRUE(score.wrong.empty());
  EXPECT_EQ(score.clear_confusion.at("named").at("named"), 100U);
  EXPECT_EQ(score.clear_confusion.at("unknown").at("unknown"), 100U);
}

TEST(Score, OneThatNamesAtRandomIsRightByChanceOnly) {
  const std::vector<Cause> causes{
      kFriction, kBias, {"specimen", "inertia"}, {"transfer_system", "delay"}, {"force_sensor", "gain"}};
  RandomStream random{1, 0, "guess"};
  const Score score =
      scored([&](const KeyCase&) { return read_answer(diagnosis("named", {causes[random.index(5)]}, 0.96)); });
  // One in five of 100 named, two in five of 100 pairs, none of 100 laws; four deviations.
  EXPECT_NEAR(value(score, "effect_right_or_in_set"), 0.2, 4.0 * std::sqrt(0.2 * 0.8 / 300.0));
  EXPECT_NEAR(value(score, "single_name_right_where_separable"), 0.2, 4.0 * std::sqrt(0.2 * 0.8 / 100.0));
  EXPECT_DOUBLE_EQ(value(score, "false_names_on_none_and_unknown"), 1.0);
  EXPECT_DOUBLE_EQ(value(score, "both_of_a_pair_found"), 0.0);
  EXPECT_DOUBLE_EQ(value(score, "law_right"), 0.0);
  EXPECT_DOUBLE_EQ(value(score, "partial_called_partial"), 0.0);
  EXPECT_GT(value(score, "sure_and_wrong"), 0.8);
  EXPECT_GT(value(score, "expected_calibration_error"), 0.7);
  for (const char* name : {"interface_right", "effect_right_or_in_set", "single_name_right_where_separable",
                           "false_names_on_none_and_unknown", "expected_calibration_error", "both_of_a_pair_found"}) {
    EXPECT_FALSE(figure(score, name).is_met().value()) << name;
  }
}

TEST(Score, OneThatAlwaysSaysNoneIsRightAboutNoneOnly) {
  const Score score = scored([](const KeyCase&) { return read_answer(diagnosis("none", {}, 0.0)); });
  EXPECT_DOUBLE_EQ(value(score, "none_called_none"), 1.0);
  EXPECT_DOUBLE_EQ(value(score, "interface_right"), 0.0);
  EXPECT_DOUBLE_EQ(value(score, "effect_right_or_in_set"), 0.0);
  EXPECT_DOUBLE_EQ(value(score, "both_of_a_pair_found"), 0.0);
  EXPECT_DOUBLE_EQ(value(score, "false_names_on_none_and_unknown"), 0.0);
  EXPECT_DOUBLE_EQ(value(score, "unknown_called_unknown"), 0.0);
  EXPECT_FALSE(figure(score, "expected_calibration_error").is_met().has_value());
  EXPECT_EQ(score.wrong.size(), 500U);  // what is partial or unknown fails by its interface
}

TEST(Score, OneThatPeeksAtDrawnCasesIsRight) {
  Json key{{"schema", "hybridtest/blind_key/1"}, {"cases", Json::array()}};
  for (std::uint64_t i = 0; i < 6; ++i) key["cases"].push_back(truth_json(case_name(i), draw_case(77, i)));
  std::vector<MarkedCase> peeked;
  std::vector<MarkedCase> silent;
  for (const KeyCase& of_key : read_key(key.dump())) {
    peeked.push_back(mark(of_key, right_answer(of_key)));
    silent.push_back(mark(of_key, read_answer(diagnosis("none", {}, 0.0))));
  }
  EXPECT_DOUBLE_EQ(value(score_of(peeked), "effect_right_or_in_set"), 1.0);
  EXPECT_DOUBLE_EQ(value(score_of(peeked), "false_names_on_none_and_unknown"), 0.0);
  EXPECT_DOUBLE_EQ(value(score_of(silent), "effect_right_or_in_set"), 0.0);
}

TEST(Score, CaseWithoutAGapInItsKeyCannotBeScored) {
  Json key{{"schema", "hybridtest/blind_key/1"}, {"cases", Json::array()}};
  BlindCase of_case = draw_case(77, 0);
  key["cases"].push_back(truth_json("whole", of_case));
  of_case.truth.held_out_gap_to_floor = std::numeric_limits<double>::infinity();
  key["cases"].push_back(truth_json("without", of_case));
  const std::vector<KeyCase> cases = read_key(key.dump());
  EXPECT_TRUE(cases[0].can_be_scored());
  EXPECT_FALSE(cases[1].can_be_scored());
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

TEST(Score, TargetIsMetByTheEndOfTheInterval) {
  Figure figure{"share", proportion(96, 100), 0.95, {}};  // 0.96, from 0.90 on
  EXPECT_FALSE(figure.is_met().value());
  figure.estimate = proportion(980, 1000);
  EXPECT_TRUE(figure.is_met().value());
  figure.at_least.reset();
  figure.at_most = 0.985;  // up to 0.987
  EXPECT_FALSE(figure.is_met().value());
  figure.at_least = 0.93;
  EXPECT_TRUE(figure.is_met().value());  // a range: the figure itself at its upper limit
}

TEST(Score, SeverityRowsHoldEachCaseOnce) {
  std::vector<MarkedCase> marked;
  for (const double gap : {0.5, 1.5, 3.0, 6.0, 12.0, 100.0}) {
    const KeyCase key = key_case(TruthClass::named, {kFriction}, gap);
    marked.push_back(mark(key, gap < 2.0 ? read_answer(diagnosis("none", {}, 0.0)) : right_answer(key)));
  }
  const std::vector<SeverityRow> rows = score_of(marked).severities;
  ASSERT_EQ(rows.size(), 6U);
  for (const SeverityRow& row : rows) {
    EXPECT_EQ(row.figures[1].name, "effect_right_or_in_set");
    EXPECT_EQ(row.figures[1].estimate.value().count, 1U);
    // Below the floor silence is right, between once and twice it is not.
    EXPECT_DOUBLE_EQ(row.figures[1].estimate.value().value, row.from == 1.0 ? 0.0 : 1.0);
  }
}

TEST(Score, LawIsRightByItsNameAndInPartByAnAddition) {
  KeyCase key = key_case(TruthClass::law, {{"specimen", "hysteresis_law"}});
  key.acceptable = {{"specimen", "hysteresis_law", "pinching"}};
  key.acceptable_in_part = {kFriction};
  const auto is_right = [&](const std::string& verdict, const Cause& cause) {
    return mark(key, read_answer(diagnosis(verdict, {cause}, 0.99))).is_effect_right.value();
  };
  EXPECT_TRUE(is_right("named", {"specimen", "hysteresis_law", "pinching"}));
  EXPECT_FALSE(is_right("named", {"specimen", "hysteresis_law", "takeda"}));
  EXPECT_FALSE(is_right("named", kFriction));
  EXPECT_TRUE(is_right("partial", kFriction));
  EXPECT_FALSE(is_right("partial", kBias));
}

TEST(Score, YieldingMayTellItsLawButNotAnother) {
  KeyCase key = key_case(TruthClass::named, {{"specimen", "yielding"}});
  key.acceptable = {{"specimen", "yielding", kUnsaidLaw}, {"specimen", "yielding", "bouc_wen"}};
  const auto is_right = [&](const std::string& law) {
    return mark(key, read_answer(diagnosis("named", {{"specimen", "yielding", law}}, 0.9))).is_effect_right.value();
  };
  EXPECT_TRUE(is_right(""));
  EXPECT_TRUE(is_right("bouc_wen"));
  EXPECT_FALSE(is_right("pinching"));
  key.acceptable = {{"specimen", "yielding", "pinching"}};  // of a specimen that pinches
  EXPECT_TRUE(is_right("pinching"));
  EXPECT_FALSE(is_right(""));
}

TEST(Score, WrongNumbersAreNeitherRightNorWrong) {
  const Cause stiffness{"specimen", "stiffness_error"};
  KeyCase none = key_case(TruthClass::none, {});
  KeyCase friction = key_case(TruthClass::named, {kFriction});
  none.tolerated = friction.tolerated = {stiffness};
  const auto named = [](const std::string& verdict, const std::vector<Cause>& causes) {
    return read_answer(diagnosis(verdict, causes, verdict == "set" ? 0.48 : 0.97));
  };
  EXPECT_FALSE(mark(none, named("named", {stiffness})).is_falsely_named.value());
  EXPECT_EQ(mark(none, named("set", {kBias, stiffness})).answer.verdict, "none");
  EXPECT_EQ(mark(none, named("partial", {stiffness})).answer.verdict, "unknown");  // there is no rest
  EXPECT_TRUE(mark(none, named("named", {stiffness, kBias})).is_falsely_named.value());
  EXPECT_TRUE(mark(friction, named("named", {stiffness, kFriction})).is_effect_right.value());
  EXPECT_FALSE(mark(friction, named("named", {stiffness, kFriction})).has_spurious_cause.value());
  EXPECT_TRUE(mark(friction, named("named", {kFriction, kBias})).has_spurious_cause.value());
  EXPECT_FALSE(mark(friction, named("named", {stiffness})).is_effect_right.value());
}

TEST(Score, NameBesideASetOfWrongNumbersIsAName) {
  const Cause stiffness{"specimen", "stiffness_error"};
  const Cause gain{"force_sensor", "gain"};
  KeyCase key = key_case(TruthClass::named, {kFriction});
  key.tolerated = {stiffness, gain};
  Answer answer = read_answer(diagnosis("set", {kFriction, stiffness, gain}, 0.47));
  EXPECT_FALSE(mark(key, answer).is_single_name_right.value()) << "control: a member of the set";
  answer.causes.front().probability = 0.93;
  EXPECT_TRUE(mark(key, answer).is_single_name_right.value());
  EXPECT_EQ(mark(key, answer).causes_answered.value(), 1U);
  key.acceptable = {kBias};
  EXPECT_FALSE(mark(key, answer).is_effect_right.value()) << "a wrong name is a name, too";
  EXPECT_TRUE(mark(key, answer).is_sure_and_wrong);
}

TEST(Score, IntervalsOfWrongNumbersCountToo) {
  KeyCase key = key_case(TruthClass::none, {});
  key.besides = {{"transfer_system", "gain", {{"gain_error", 0.03}}}, {"specimen", "inertia", {{"mass_kg", 5.0}}}};
  Answer answer;
  answer.verdict = "none";
  answer.corrections = {{.interface = "transfer_system", .effect = "gain", .parameters = {}}};
  answer.corrections[0].parameters["gain_error"] = {.value = 0.0305, .ci95 = std::pair{0.0302, 0.0308}};
  const MarkedCase marked = mark(key, answer);
  ASSERT_EQ(marked.number_errors.size(), 1U);  // of the one that was told
  EXPECT_FALSE(marked.number_errors[0].is_in_interval.value());
  EXPECT_TRUE(marked.parameter_errors.empty());
  const Score score = score_of({marked});
  EXPECT_EQ(figure(score, "true_parameter_in_interval").estimate.value().count, 1U);
  EXPECT_FALSE(figure(score, "of_effects_in_interval").estimate.has_value());
}

TEST(Score, CorrectionCountsWhereItIsTheTruth) {
  const Cause gain{"transfer_system", "gain"};
  Answer corrected;
  corrected.verdict = "none";
  corrected.corrections = {{.interface = gain.interface, .effect = gain.effect, .probability = 1.0, .parameters = {}}};
  KeyCase key = key_case(TruthClass::named, {kFriction});
  EXPECT_FALSE(mark(key, corrected).is_effect_right.value());
  EXPECT_EQ(mark(key, corrected).answer.verdict, "none");
  key.acceptable = {gain};
  EXPECT_TRUE(mark(key, corrected).is_effect_right.value());
  EXPECT_EQ(mark(key, corrected).answer.verdict, "named");
  EXPECT_FALSE(mark(key_case(TruthClass::none, {}), corrected).is_falsely_named.value());
}

TEST(Score, PairNeedsACauseForEachEffectAtTwiceTheFloor) {
  KeyCase key = key_case(TruthClass::pair, {kFriction, kBias});
  const Cause stribeck{"specimen", "stribeck_friction"};
  key.effect_acceptable[0].push_back(stribeck);
  EXPECT_TRUE(mark(key, read_answer(diagnosis("named", {kBias, stribeck}, 1.0))).are_both_found.value());
  EXPECT_FALSE(mark(key, read_answer(diagnosis("named", {kFriction, stribeck}, 1.0))).are_both_found.value());
  key.effect_gaps_to_floor[1] = 1.5;
  EXPECT_FALSE(mark(key, right_answer(key)).are_both_found.has_value());
}

TEST(Score, PublishedRowHasTwelveColumns) {
  const std::string row = published_row(scored(right_answer));
  EXPECT_EQ(std::ranges::count(row, '|'), 13);
  EXPECT_THAT(row, HasSubstr(" 1.000 [0.98"));
}

TEST(Score, MissingAnswerCountsAsWrong) {
  const Score score = scored([](const KeyCase&) { return std::optional<Answer>{}; });
  EXPECT_DOUBLE_EQ(value(score, "effect_right_or_in_set"), 0.0);
  EXPECT_DOUBLE_EQ(value(score, "interface_right"), 0.0);
  EXPECT_DOUBLE_EQ(value(score, "none_called_none"), 0.0);
  EXPECT_EQ(score.confusion.at("named").at("missing"), 100U);
}

TEST(Score, SetIsRightByAnyMemberAndCountedBySize) {
  const Cause friction = kFriction;
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
  key.is_separable = false;
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
  EXPECT_EQ(json["wrong"].size(), 100U);
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
