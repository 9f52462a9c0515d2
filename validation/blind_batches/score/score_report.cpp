#include "validation/blind_batches/score/score_report.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

#include "validation/blind_batches/batch_files.hpp"

namespace hybridtest::blind {
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
  for (const char* truth : {"none", "named", "pair", "unknown", "hidden"}) {
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
  const std::string asked = figure.at_least  ? printed("at least %.2f", *figure.at_least)
                            : figure.at_most ? printed("at most %.2f", *figure.at_most)
                                             : std::string{};
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

std::string truth_of(const KeyCase& key) {
  std::string text{name_of(key.truth)};
  for (const PlantEffect& effect : key.effects) text += " " + effect.interface + "." + effect.name;
  return text;
}

std::string said_in(const Answer& answer) {
  std::string text = answer.verdict;
  for (const AnsweredCause& cause : answer.causes) {
    text += " " + cause.interface + "." + cause.effect + printed(" (%.2f)", cause.probability);
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
  text += "\nEffects alone, right of how many\n\n";
  for (const auto& [name, counts] : score.effects) {
    text += printed("  %-44s%3zu of %3zu\n", name.c_str(), counts[0], counts[1]);
  }
  if (!score.wrong.empty()) text += printed("\n%zu wrong, the clearest first\n\n", score.wrong.size());
  for (std::size_t i = 0; i < std::min(kWrongShown, score.wrong.size()); ++i) {
    const MarkedCase& wrong = score.wrong[i];
    text += "  " + wrong.key.name + printed("  gap %.3g floors  ", wrong.key.gap_to_floor) + truth_of(wrong.key) +
            "\n             said: " + said_in(wrong.answer) + "\n";
  }
  return text;
}

Json score_json(const Score& score) {
  Json json{{"schema", "hybridtest/blind_score/1"}, {"cases", score.cases}, {"clear_cases", score.clear_cases}};
  json["confusion"] = score.confusion;
  json["clear_confusion"] = score.clear_confusion;
  json["overall"] = figures_json(score.overall);
  json["clear"] = figures_json(score.clear);
  json["effects"] = Json::object();
  for (const auto& [name, counts] : score.effects) json["effects"][name] = {{"right", counts[0]}, {"of", counts[1]}};
  json["wrong"] = Json::array();
  for (const MarkedCase& wrong : score.wrong) {
    json["wrong"].push_back({{"case", wrong.key.name},
                             {"gap_to_floor", wrong.key.gap_to_floor},
                             {"truth", truth_of(wrong.key)},
                             {"said", said_in(wrong.answer)}});
  }
  return json;
}

}  // namespace hybridtest::blind
