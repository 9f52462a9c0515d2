#include "validation/blind_batches/score/score.hpp"

#include <algorithm>

#include "validation/blind_batches/batch_files.hpp"

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

std::vector<ParameterError> all_parameter_errors(const Cases& cases) {
  std::vector<ParameterError> errors;
  for (const MarkedCase* of_case : cases) {
    errors.insert(errors.end(), of_case->parameter_errors.begin(), of_case->parameter_errors.end());
  }
  return errors;
}

std::optional<Estimate> interval_coverage(const Cases& cases) {
  std::size_t inside = 0;
  std::size_t given = 0;
  for (const ParameterError& error : all_parameter_errors(cases)) {
    if (!error.is_in_interval) continue;
    ++given;
    inside += *error.is_in_interval ? 1U : 0U;
  }
  return proportion(inside, given);
}

std::optional<Estimate> nothing_called_nothing(const Cases& cases) {
  std::size_t none = 0;
  std::size_t right = 0;
  for (const MarkedCase* of_case : cases) {
    if (of_case->key.truth != TruthClass::none) continue;
    ++none;
    right += of_case->answer.verdict == "none" ? 1U : 0U;
  }
  return proportion(right, none);
}

std::optional<Estimate> unknown_called_unknown(const Cases& cases) {
  std::size_t unknown = 0;
  std::size_t right = 0;
  for (const MarkedCase* of_case : cases) {
    if (of_case->key.truth != TruthClass::unknown) continue;
    ++unknown;
    right += of_case->answer.verdict == "unknown" ? 1U : 0U;
  }
  return proportion(right, unknown);
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
  for (const ParameterError& error : all_parameter_errors(cases)) errors.push_back(error.relative);
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
      {"both_of_a_pair_found", share_of(cases, &MarkedCase::are_both_found), {}, {}},
      {"none_called_none", nothing_called_nothing(cases), {}, {}},
      {"unknown_called_unknown", unknown_called_unknown(cases), {}, {}},
      {"median_relative_parameter_error", median(errors), {}, {}},
      {"true_parameter_in_interval", interval_coverage(cases), {}, {}},
  };
  if (!is_target) {
    for (Figure& figure : figures) figure.at_least = figure.at_most = std::nullopt;
  }
  return figures;
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
  return (!at_least || estimate->value >= *at_least) && (!at_most || estimate->value <= *at_most);
}

Score score_of(const std::vector<MarkedCase>& cases) {
  Cases all;
  Cases clear;
  Score score;
  for (const MarkedCase& of_case : cases) {
    all.push_back(&of_case);
    if (!of_case.is_clear()) continue;
    clear.push_back(&of_case);
    if (of_case.is_wrong()) score.wrong.push_back(of_case);
    if (of_case.key.truth != TruthClass::named) continue;
    const PlantEffect& effect = of_case.key.effects.front();
    auto& [right, count] = score.effects[effect.interface + "." + effect.name];
    right += of_case.is_effect_right.value_or(false) ? 1U : 0U;
    ++count;
  }
  score.cases = all.size();
  score.clear_cases = clear.size();
  score.confusion = confusion_of(all);
  score.clear_confusion = confusion_of(clear);
  score.overall = figures_of(all, false);
  score.clear = figures_of(clear, true);
  std::ranges::stable_sort(score.wrong, std::ranges::greater{}, [](const MarkedCase& m) { return m.key.gap_to_floor; });
  return score;
}

}  // namespace hybridtest::blind
