#include "validation/blind_batches/score/score.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <stdexcept>

#include "validation/blind_batches/batch.hpp"

namespace hybridtest::blind {

namespace {

using Cases = std::vector<const MarkedCase*>;

std::optional<Estimate> share_of(const Cases& cases, std::optional<bool> MarkedCase::*mark) {
  std::size_t right = 0;
  std::size_t marked = 0;
  for (const MarkedCase* of_case : cases) {
    if (!(of_case->*mark)) continue;
    ++marked;
    right += *(of_case->*mark) ? 1U : 0U;
  }
  return proportion(right, marked);
}

using Errors = std::vector<ParameterError> MarkedCase::*;

std::vector<ParameterError> all_errors(const Cases& cases, std::initializer_list<Errors> kinds) {
  std::vector<ParameterError> errors;
  for (const MarkedCase* of_case : cases) {
    for (const Errors kind : kinds) {
      errors.insert(errors.end(), (of_case->*kind).begin(), (of_case->*kind).end());
    }
  }
  return errors;
}

/// Each parameter counts by itself, though those of one case may miss together.
std::optional<Estimate> interval_coverage(const Cases& cases, std::initializer_list<Errors> kinds) {
  std::size_t inside = 0;
  std::size_t given = 0;
  for (const ParameterError& error : all_errors(cases, kinds)) {
    if (!error.is_in_interval) continue;
    ++given;
    inside += *error.is_in_interval ? 1U : 0U;
  }
  return proportion(inside, given);
}

std::optional<Estimate> interval_coverage(const Cases& cases) {
  return interval_coverage(cases, {&MarkedCase::parameter_errors, &MarkedCase::number_errors});
}

/// Of the cases of a class, how many got a verdict.
std::optional<Estimate> called(const Cases& cases, TruthClass truth, const char* verdict) {
  std::size_t of_class = 0;
  std::size_t right = 0;
  for (const MarkedCase* of_case : cases) {
    if (of_case->key.truth != truth) continue;
    ++of_class;
    right += of_case->answer.verdict == verdict ? 1U : 0U;
  }
  return proportion(right, of_class);
}

std::optional<Estimate> sure_and_wrong(const Cases& cases) {
  return proportion(static_cast<std::size_t>(std::ranges::count_if(cases, &MarkedCase::is_sure_and_wrong)),
                    cases.size());
}

template <class Predicate>
Cases those(const Cases& cases, Predicate is_one) {
  Cases some;
  std::ranges::copy_if(cases, std::back_inserter(some), is_one);
  return some;
}

std::optional<Estimate> effects_right(const Cases& cases, TruthClass truth) {
  return share_of(those(cases, [&](const MarkedCase* m) { return m->key.truth == truth; }),
                  &MarkedCase::is_effect_right);
}

/// @param is_target   the targets of the specification are for these cases.
std::vector<Figure> figures_of(const Cases& cases, bool is_target) {
  std::vector<double> set_sizes;
  std::vector<Forecast> forecasts;
  std::vector<double> variance_short;
  std::vector<double> errors;
  for (const MarkedCase* of_case : cases) {
    if (of_case->causes_answered) set_sizes.push_back(static_cast<double>(*of_case->causes_answered));
    if (of_case->forecast) forecasts.push_back(*of_case->forecast);
    if (of_case->variance_short) variance_short.push_back(*of_case->variance_short);
  }
  for (const ParameterError& error : all_errors(cases, {&MarkedCase::parameter_errors}))
    errors.push_back(error.relative);
  std::vector<Figure> figures{
      {"interface_right", share_of(cases, &MarkedCase::is_interface_right), 0.95, {}},
      {"effect_right_or_in_set", share_of(cases, &MarkedCase::is_effect_right), 0.95, {}},
      {"mean_set_size", mean(set_sizes), {}, 1.6},
      {"single_name_right_where_separable", share_of(cases, &MarkedCase::is_single_name_right), 0.90, {}},
      {"false_names_on_none_and_unknown", share_of(cases, &MarkedCase::is_falsely_named), {}, 0.05},
      {"expected_calibration_error", calibration_error(forecasts), {}, 0.07},
      {"variance_short_of_true_model", mean(variance_short), {}, 0.03},
      {"median_variance_short_of_true_model", median(variance_short), {}, {}},
      {"true_effect_in_answered_set", share_of(cases, &MarkedCase::is_true_one_covered), {}, {}},
      {"both_of_a_pair_found", share_of(cases, &MarkedCase::are_both_found), 0.85, {}},
      {"true_parameter_in_interval", interval_coverage(cases), 0.93, 0.97},
      {"of_effects_in_interval", interval_coverage(cases, {&MarkedCase::parameter_errors}), {}, {}},
      {"sure_and_wrong", sure_and_wrong(cases), {}, {}},
      {"law_right", effects_right(cases, TruthClass::law), {}, {}},
      {"partial_called_partial", share_of(cases, &MarkedCase::is_partial_right), {}, {}},
      {"another_cause_beside_the_right_one", share_of(cases, &MarkedCase::has_spurious_cause), {}, {}},
      {"effect_right_in_closed_loop",
       share_of(those(cases, [](const MarkedCase* m) { return m->key.is_closed_loop; }), &MarkedCase::is_effect_right),
       {},
       {}},
      {"none_called_none", called(cases, TruthClass::none, "none"), {}, {}},
      {"unknown_called_unknown", called(cases, TruthClass::unknown, "unknown"), {}, {}},
      {"median_relative_parameter_error", median(errors), {}, {}},
  };
  if (!is_target) {
    for (Figure& figure : figures) figure.at_least = figure.at_most = std::nullopt;
  }
  return figures;
}

std::string full_name(const PlantEffect& effect) {
  return effect.interface + "." + effect.name + (effect.law.empty() ? "" : " (" + effect.law + ")");
}

ConfusionMatrix confusion_of(const Cases& cases) {
  ConfusionMatrix matrix;
  for (const MarkedCase* of_case : cases) {
    const bool is_hidden = of_case->key.truth != TruthClass::none && of_case->key.gap_to_floor < 1.0;
    const std::string row = is_hidden ? "hidden" : std::string{name_of(of_case->key.truth)};
    ++matrix[row][of_case->answer.verdict];
  }
  return matrix;
}

}  // namespace

std::optional<bool> Figure::is_met() const {
  if (!estimate || (!at_least && !at_most)) return {};
  const double high = at_least ? estimate->value : estimate->high;
  return (!at_least || estimate->low >= *at_least) && (!at_most || high <= *at_most);
}

namespace {

std::vector<SeverityRow> severities_of(const Cases& cases) {
  static constexpr std::array kLimits{0.0, 1.0, 2.0, 4.0, 8.0, 16.0, HUGE_VAL};
  std::vector<SeverityRow> rows;
  for (std::size_t i = 0; i + 1 < kLimits.size(); ++i) {
    SeverityRow row{kLimits[i], kLimits[i + 1], {}};
    const Cases inside = those(cases, [&](const MarkedCase* m) {
      return m->key.truth != TruthClass::none && m->key.gap_to_floor >= row.from && m->key.gap_to_floor < row.below;
    });
    row.figures = {{"interface_right", share_of(inside, &MarkedCase::is_interface_right), {}, {}},
                   {"effect_right_or_in_set", share_of(inside, &MarkedCase::is_effect_right), {}, {}},
                   {"true_parameter_in_interval", interval_coverage(inside), {}, {}},
                   {"sure_and_wrong", sure_and_wrong(inside), {}, {}}};
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace

Score score_of(const std::vector<MarkedCase>& cases) {
  Cases all;
  Cases clear;
  Score score;
  for (const MarkedCase& of_case : cases) {
    all.push_back(&of_case);
    if (!of_case.is_clear()) continue;
    clear.push_back(&of_case);
    if (of_case.is_wrong()) score.wrong.push_back(of_case);
    if (of_case.key.truth != TruthClass::named && of_case.key.truth != TruthClass::law) continue;
    auto& [right, count] = score.effects[full_name(of_case.key.effects.front())];
    right += of_case.is_effect_right.value_or(false) ? 1U : 0U;
    ++count;
  }
  score.cases = all.size();
  score.clear_cases = clear.size();
  score.confusion = confusion_of(all);
  score.clear_confusion = confusion_of(clear);
  score.overall = figures_of(all, false);
  score.clear = figures_of(clear, true);
  score.severities = severities_of(all);
  std::ranges::stable_sort(score.wrong, std::ranges::greater{}, [](const MarkedCase& m) { return m.key.gap_to_floor; });
  return score;
}

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kWrongShown = 25;

template <class... Values>
std::string printed(const char* format, Values... values) {
  std::array<char, 512> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

std::string confusion_text(const ConfusionMatrix& confusion) {
  std::string text = printed("%-10s", "");
  for (const std::string& verdict : known_verdicts()) text += printed("%12s", verdict.c_str());
  text += '\n';
  for (const char* truth : {"none", "named", "law", "pair", "partial", "unknown", "hidden"}) {
    const auto row = confusion.find(truth);
    if (row == confusion.end()) continue;
    text += printed("%-10s", truth);
    for (const std::string& verdict : known_verdicts()) {
      const auto found = row->second.find(verdict);
      text += printed("%12zu", found == row->second.end() ? std::size_t{0} : found->second);
    }
    text += '\n';
  }
  return text;
}

std::string target_text(const Figure& figure) {
  std::string asked;
  if (figure.at_least) asked += printed("at least %.2f", *figure.at_least);
  if (figure.at_most) asked += (asked.empty() ? "" : ", ") + printed("at most %.2f", *figure.at_most);
  if (asked.empty()) return {};
  if (!figure.estimate) return "   not judged (" + asked + ")";
  return (*figure.is_met() ? "   met    (" : "   MISSED (") + asked + ")";
}

std::string figures_text(const std::vector<Figure>& figures) {
  std::string text;
  for (const Figure& figure : figures) {
    text += printed("  %-40s", figure.name.c_str());
    if (figure.estimate) {
      const Estimate& e = *figure.estimate;
      text += printed("%8.3f  [%7.3f, %7.3f]  of %4zu", e.value, e.low, e.high, e.count);
    } else {
      text += printed("%8s", "-");
    }
    text += target_text(figure) + '\n';
  }
  return text;
}

std::string severities_text(const std::vector<SeverityRow>& rows) {
  std::string text = printed("  %-16s", "gap over floor");
  for (const Figure& figure : rows.front().figures) text += printed("%36s", figure.name.c_str());
  for (const SeverityRow& row : rows) {
    text += printed("\n  %4.3g to %-8.3g", row.from, row.below);
    for (const Figure& figure : row.figures) {
      text += figure.estimate ? printed("%12.3f [%.3f, %.3f] of %3zu", figure.estimate->value, figure.estimate->low,
                                        figure.estimate->high, figure.estimate->count)
                              : printed("%36s", "-");
    }
  }
  return text + "\n";
}

std::string truth_of(const KeyCase& key) {
  std::string text{name_of(key.truth)};
  for (const PlantEffect& effect : key.effects) text += " " + full_name(effect);
  return text;
}

std::string said_in(const Answer& answer) {
  std::string text = answer.verdict;
  for (const AnsweredCause& cause : answer.causes) {
    text += " " + cause.interface + "." + cause.effect + (cause.law.empty() ? "" : ":" + cause.law) +
            printed(" (%.2f)", cause.probability);
  }
  return text;
}

Json figures_json(const std::vector<Figure>& figures) {
  Json json;
  for (const Figure& figure : figures) {
    Json& entry = json[figure.name];
    entry = Json::object();
    if (figure.estimate) {
      entry["value"] = figure.estimate->value;
      entry["ci95"] = {figure.estimate->low, figure.estimate->high};
      entry["count"] = figure.estimate->count;
    }
    if (figure.at_least) entry["at_least"] = *figure.at_least;
    if (figure.at_most) entry["at_most"] = *figure.at_most;
    if (const auto is_met = figure.is_met()) entry["met"] = *is_met;
  }
  return json;
}

}  // namespace

std::string score_text(const Score& score) {
  std::string text = printed("%zu cases; truth against verdict (hidden: an effect below the floor)\n\n", score.cases);
  text += confusion_text(score.confusion) + "\nOver all cases, with 95 % intervals\n\n";
  text += figures_text(score.overall);
  text += printed("\n%zu cases at twice the floor or above, and those without an effect\n\n", score.clear_cases);
  text += confusion_text(score.clear_confusion) + "\n" + figures_text(score.clear);
  text += "\nBy severity, all cases with an effect\n\n" + severities_text(score.severities);
  text += "\nEffects and laws alone, right of how many\n\n";
  for (const auto& [name, counts] : score.effects) {
    text += printed("  %-44s%3zu of %3zu\n", name.c_str(), counts[0], counts[1]);
  }
  if (!score.wrong.empty()) text += printed("\n%zu wrong, the clearest first\n\n", score.wrong.size());
  for (std::size_t i = 0; i < std::min(kWrongShown, score.wrong.size()); ++i) {
    const MarkedCase& wrong = score.wrong[i];
    text += "  " + wrong.key.name + printed("  gap %.3g floors  ", wrong.key.gap_to_floor) + truth_of(wrong.key) +
            "\n             said: " + said_in(wrong.given) + "\n";
  }
  return text;
}

Json score_json(const Score& score) {
  Json json{{"schema", "hybridtest/blind_score/2"}, {"cases", score.cases}, {"clear_cases", score.clear_cases}};
  json["confusion"] = score.confusion;
  json["clear_confusion"] = score.clear_confusion;
  json["overall"] = figures_json(score.overall);
  json["clear"] = figures_json(score.clear);
  json["by_severity"] = Json::array();
  for (const SeverityRow& row : score.severities) {
    Json entry{{"from", row.from}};
    if (std::isfinite(row.below)) entry["below"] = row.below;
    entry["figures"] = figures_json(row.figures);
    json["by_severity"].push_back(std::move(entry));
  }
  json["effects"] = Json::object();
  for (const auto& [name, counts] : score.effects) json["effects"][name] = {{"right", counts[0]}, {"of", counts[1]}};
  json["wrong"] = Json::array();
  for (const MarkedCase& wrong : score.wrong) {
    json["wrong"].push_back({{"case", wrong.key.name},
                             {"gap_to_floor", wrong.key.gap_to_floor},
                             {"truth", truth_of(wrong.key)},
                             {"said", said_in(wrong.given)}});
  }
  return json;
}

std::string published_row(const Score& score) {
  static constexpr std::array kColumns{"interface_right",
                                       "effect_right_or_in_set",
                                       "mean_set_size",
                                       "single_name_right_where_separable",
                                       "false_names_on_none_and_unknown",
                                       "expected_calibration_error",
                                       "variance_short_of_true_model",
                                       "true_parameter_in_interval",
                                       "both_of_a_pair_found",
                                       "law_right",
                                       "partial_called_partial",
                                       "sure_and_wrong"};
  std::string row = "|";
  for (const char* column : kColumns) {
    const auto figure = std::ranges::find(score.clear, column, &Figure::name);
    if (!figure->estimate) {
      row += " |";
      continue;
    }
    row += printed(" %.3f [%.3f, %.3f]", figure->estimate->value, figure->estimate->low, figure->estimate->high);
    // Of how many, where it is not the cases.
    if (figure->name == "true_parameter_in_interval") row += printed(" of %zu", figure->estimate->count);
    row += " |";
  }
  return row;
}

BatchScore score_batches(const std::vector<AnsweredBatch>& batches, const Digest& digest) {
  std::vector<MarkedCase> marked;
  std::string seals;
  Json of_batches = Json::array();
  for (const AnsweredBatch& batch : batches) {
    const std::vector<KeyCase> cases = read_key(open_key(batch.batch, batch.key, digest));
    std::vector<std::string> names;
    for (const KeyCase& of_case : cases) names.push_back(of_case.name);
    const GivenAnswers given = open_answers(batch.batch, batch.answers, names, digest);
    std::string left_out;
    for (std::size_t i = 0; i < cases.size(); ++i) {
      if (!cases[i].can_be_scored()) {
        left_out.append(" ").append(names[i]);
        continue;
      }
      try {
        marked.push_back(mark(cases[i], given.texts[i] ? std::optional{read_answer(*given.texts[i])} : std::nullopt));
      } catch (const std::runtime_error& error) {
        throw std::runtime_error{(batch.answers / names[i]).string() + "/diagnosis.json: " + error.what()};
      }
      if (batches.size() > 1) marked.back().key.name = batch.batch.filename().string() + "/" + names[i];
    }
    const std::string whose = batches.size() > 1 ? " to " + batch.batch.string() : "";
    seals += "The answers" + whose + (given.are_sealed ? " are as they were sealed.\n" : " are not sealed.\n");
    if (!left_out.empty())
      seals.append("Left out").append(whose).append(", as the key has no gap of it:").append(left_out).append("\n");
    const std::string hash = digest(read_batch_file(batch.batch / "batch.json"));
    if (std::ranges::any_of(of_batches, [&](const Json& other) { return other["batch_sha256"] == hash; })) {
      throw std::runtime_error{batch.batch.string() + ": this batch is given twice; expected each batch once"};
    }
    of_batches.push_back({{"batch_sha256", hash}, {"cases", cases.size()}, {"answers_sealed", given.are_sealed}});
  }
  const Score score = score_of(marked);
  Json json = score_json(score);
  json["batches"] = std::move(of_batches);
  return {seals + score_text(score) + "\nFor the table of docs/blind_batches.md:\n" + published_row(score) + "\n",
          json.dump(1) + "\n"};
}

}  // namespace hybridtest::blind
