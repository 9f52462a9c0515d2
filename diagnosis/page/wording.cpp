#include "diagnosis/page/wording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <iterator>
#include <vector>

namespace hybridtest::report {
namespace {

struct Prefix {
  double factor;
  std::string_view symbol;
};
/// Keeps a number and its unit on one line.
constexpr std::string_view kNoBreak = "\u00a0";
constexpr std::array<Prefix, 6> kPrefixes{{{1e9, "G"}, {1e6, "M"}, {1e3, "k"}, {1.0, ""}, {1e-3, "m"}, {1e-6, "µ"}}};

/// Units that take a prefix (k, m, ...); all others are shown without one.
bool takes_prefix(std::string_view unit) {
  return !unit.empty() && std::string_view{"mNsJ"}.find(unit.front()) != std::string_view::npos;
}

std::string three_digits(double value) {
  const double magnitude = std::abs(value);
  if (magnitude >= 99.95) return fmt::format("{:.0f}", value);
  if (magnitude >= 9.995) return fmt::format("{:.1f}", value);
  return fmt::format("{:.2f}", value);
}

std::string in_words(const RankedCause& cause) {
  return plain(cause.effect) + law_in_words(cause) + input_in_words(cause) + corrected_in_words(cause);
}

using Causes = std::vector<const RankedCause*>;

Causes causes(const DiagnosisReport& report) {
  Causes found;
  for (const RankedCause& cause : report.ranking) {
    if (cause.is_cause) found.push_back(&cause);
  }
  return found;
}

/// Whether all of them are at the interface with the largest gap, or no gap has a place.
bool are_at_main_fault(const DiagnosisReport& report, const Causes& list) {
  const InterfaceGap* fault = main_fault(report);
  return fault == nullptr ||
         std::ranges::all_of(list, [&](const RankedCause* cause) { return cause->interface == fault->interface; });
}

std::string in_words_with_place(const RankedCause& cause) {
  return fmt::format("{} of the {}", in_words(cause), plain(cause.interface));
}

/// Each with its interface, unless the sentence has said already where they all are.
std::vector<std::string> placed_names(const DiagnosisReport& report, const Causes& list) {
  const bool is_said = are_at_main_fault(report, list);
  std::vector<std::string> names;
  for (const RankedCause* const cause : list) names.push_back(is_said ? in_words(*cause) : in_words_with_place(*cause));
  return names;
}

std::string placed(const DiagnosisReport& report, const Causes& list) { return joined(placed_names(report, list)); }

/// Each with its interface where they are not all at one.
std::vector<std::string> in_words(const Causes& members) {
  const bool at_one_interface = std::ranges::all_of(
      members, [&](const RankedCause* member) { return member->interface == members.front()->interface; });
  std::vector<std::string> names;
  for (const RankedCause* const member : members) {
    names.push_back(at_one_interface ? in_words(*member) : in_words_with_place(*member));
  }
  return names;
}

/// Members of a set by their names. What was found together, as the two numbers of a law, is one of them.
std::string as_alternatives(const Causes& members, const std::vector<std::string>& names) {
  std::vector<std::string> together;
  std::vector<std::string> others;
  for (std::size_t i = 0; i < members.size(); ++i) {
    const bool was_found = members[i]->is_indistinguishable && members[i]->share > 0.0;
    (was_found ? together : others).push_back(names[i]);
  }
  if (together.size() < 2 || others.empty()) return joined(names);
  return fmt::format("{} together from {}", joined(together), joined(others));
}

std::string where_it_lies(const DiagnosisReport& report) {
  const InterfaceGap* fault = main_fault(report);
  if (fault == nullptr) return "The model does not agree with the recordings";
  return fmt::format("The gap is {} the {} ({} of the whole gap)",
                     are_at_main_fault(report, causes(report)) ? "at" : "largest at", plain(fault->interface),
                     percent(fault->share));
}

/// Continues a sentence that names causes.
std::string removal(const DiagnosisReport& report) {
  if (!report.interface_shrink) return ".";
  const Shrink& shrink = *report.interface_shrink;
  // Of a gap larger than the output itself, hardly anything seems to be left.
  if (shrink.nrmse_before > 1.0) {
    const double left = std::max(0.0, std::pow(shrink.nrmse_after, 2) - std::pow(shrink.floor_nrmse, 2));
    return fmt::format(": the gap was {:.3g} times the output, and {} of the output's energy is left above the noise.",
                       shrink.nrmse_before, percent(left));
  }
  return fmt::format(": {} of the energy of the gap is explained, {} is left above the noise.",
                     percent(shrink.variance_removed), percent(shrink.unknown_share));
}

/// The share of a gap says little where a model is far off: what is left of the output does.
std::string remainder(const DiagnosisReport& report) {
  if (!report.interface_shrink || !(report.interface_shrink->floor_nrmse > 0.0)) return {};
  const Shrink& shrink = *report.interface_shrink;
  return fmt::format(" The residual is {} of the output, {:.2g} times its noise floor.", percent(shrink.nrmse_after),
                     shrink.nrmse_after / shrink.floor_nrmse);
}

/// Of a cause that is named or told in part, which effect it is.
std::string in_doubt(const DiagnosisReport& report) {
  std::vector<const RankedCause*> alike;
  for (const RankedCause& cause : report.ranking) {
    if (cause.is_indistinguishable) alike.push_back(&cause);
  }
  if (report.verdict == Verdict::set || alike.size() < 2) return {};
  return fmt::format(" These recordings cannot distinguish {}.", as_alternatives(alike, in_words(alike)));
}

std::string named_sentence(const DiagnosisReport& report) {
  const Causes list = causes(report);
  std::string text = where_it_lies(report);
  if (list.size() == 1) {
    text += "; its cause is ";
  } else {
    text += are_at_main_fault(report, list) ? "; its causes are " : "; the causes are ";
  }
  text += placed(report, list);
  if (list.size() == 1) text += fmt::format(" (probability {})", percent(report.ranking.front().probability));
  return text + removal(report) + in_doubt(report);
}

/// Causes that are named in part because they may be absent.
std::string doubt_sentence(const DiagnosisReport& report) {
  std::vector<const RankedCause*> doubtful;
  for (const RankedCause& cause : report.ranking) {
    if (cause.is_cause && cause.may_be_absent) doubtful.push_back(&cause);
  }
  if (doubtful.empty()) return {};
  const std::string names = joined(in_words(doubtful));
  if (doubtful.size() == 1) {
    return fmt::format(" The 95{}% interval of {} holds the value at which it is absent: it may not be there.",
                       kNoBreak, names);
  }
  return fmt::format(" The 95{}% intervals of {} hold the values at which they are absent: they may not be there.",
                     kNoBreak, names);
}

/// Why causes are told in part only.
std::string doubts(const DiagnosisReport& report) {
  std::string text = doubt_sentence(report);
  if (report.is_pieced_together) {
    text +=
        " So many effects of the specimen together are rarely right: they may stand for one that the library lacks.";
  }
  return text;
}

/// Whether what no effect explains was seen to come back, after a sentence about it.
std::string recurrence(const DiagnosisReport& report) {
  const InterfaceGap* const gap = main_fault(report);
  if (gap == nullptr || !gap->recurrence) return {};
  const std::string repetitions = gap->repeatability ? fmt::format("repetitions of the test differ by {} of the output",
                                                                   percent(gap->repeatability->nrmse))
                                                     : std::string{};
  if (!gap->recurrence->is_seen()) {
    return fmt::format(" It was not seen to repeat: {}.",
                       repetitions.empty()
                           ? "no function of the motion predicts it in cycles to which it was not fitted"
                           : repetitions);
  }
  if (gap->recurrence->follows_motion) {
    return fmt::format(
        " It repeats with the motion: a function of the motion without a name removes {} of its energy from cycles to "
        "which it was not fitted.",
        percent(gap->recurrence->removed_by_function));
  }
  return fmt::format(" It repeats: {}.", repetitions);
}

std::string partial_sentence(const DiagnosisReport& report) {
  const std::string doubt = doubts(report);
  return named_sentence(report) + remainder(report) +
         (doubt.empty() ? " No effect in the library explains what is left." + recurrence(report) : doubt);
}

std::string set_sentence(const DiagnosisReport& report) {
  const Causes alike = indistinguishable(report);
  Causes others = causes(report);
  std::erase_if(others, [&](const RankedCause* cause) { return std::ranges::find(alike, cause) != alike.end(); });
  std::string text = where_it_lies(report) + "; these recordings cannot distinguish " +
                     as_alternatives(alike, placed_names(report, alike));
  if (!others.empty()) {
    text += (others.size() > 1 ? "; further causes are " : "; a further cause is ") + placed(report, others);
  }
  text += removal(report);
  return report.set_leaves_a_part ? text + remainder(report) + " No effect in the library explains what is left."
                                  : text;
}

/// What is wrong with the channel for which an interface is not judged.
std::optional<std::string> unusable_channel(const DiagnosisReport& report) {
  for (const Finding& finding : report.findings) {
    const auto is_reason = [&](const InterfaceGap& gap) { return !gap.is_judged && gap.why_not == finding.what; };
    if (std::ranges::any_of(report.where, is_reason)) return finding.what;
  }
  return {};
}

}  // namespace

std::vector<const RankedCause*> indistinguishable(const DiagnosisReport& report) {
  const bool is_cause_marked = std::ranges::any_of(
      report.ranking, [](const RankedCause& cause) { return cause.is_cause && cause.is_indistinguishable; });
  std::vector<const RankedCause*> members;
  for (const RankedCause& cause : report.ranking) {
    if (cause.is_indistinguishable || (cause.is_cause && !is_cause_marked)) members.push_back(&cause);
  }
  return members;
}

std::string alternatives_in_words(const DiagnosisReport& report) {
  const Causes members = indistinguishable(report);
  return as_alternatives(members, in_words(members));
}

std::string plain(std::string_view name) {
  std::string text{name};
  std::ranges::replace(text, '_', ' ');
  return text;
}

std::string law_in_words(const RankedCause& cause) {
  if (cause.law.empty()) return {};
  // Less is not seen in a plot of force against displacement.
  constexpr double kWorthSaying = 0.02;
  const std::string lost =
      cause.lost_stiffness < kWorthSaying
          ? ""
          : fmt::format(", and has lost {} of its stiffness by the end", percent(cause.lost_stiffness));
  return fmt::format(" ({}: the specimen {}{})", plain(cause.law), cause.in_words, lost);
}

std::string input_in_words(const RankedCause& cause) {
  if (cause.input.empty() || cause.is_formula || cause.parameters.empty()) return {};
  const ReportedParameter& slope = cause.parameters.front();  // of what it does per unit of the input
  constexpr std::string_view kPerUnit = "per unit";
  std::string_view unit = slope.unit;
  unit.remove_suffix(std::min(kPerUnit.size(), unit.size()));
  const bool is_share = unit.empty();
  std::string what = is_share ? "force" : plain_parameter(slope.name, slope.unit);
  const double size = std::abs(slope.value);
  return fmt::format(" (the {} {} by {} per unit of {})", what, slope.value < 0.0 ? "falls" : "grows",
                     is_share ? percent(size) : quantity(size, unit.substr(0, unit.size() - 1)), cause.input);
}

bool is_corrected(const ReportedParameter& parameter) {
  if (!parameter.in_model) return false;
  const double value = *parameter.in_model;
  return parameter.ci95 ? value < parameter.ci95->low || value > parameter.ci95->high : value != parameter.value;
}

std::string corrected_in_words(const RankedCause& cause) {
  std::vector<std::string> numbers;
  for (const ReportedParameter& parameter : cause.parameters) {
    if (!is_corrected(parameter)) continue;
    numbers.push_back(fmt::format("{} {} instead of {}", plain_parameter(parameter.name, parameter.unit),
                                  quantity(parameter.value, parameter.unit),
                                  quantity(*parameter.in_model, parameter.unit)));
  }
  return numbers.empty() ? "" : " (" + joined(numbers) + ")";
}

std::string plain_parameter(std::string_view name, std::string_view unit) {
  std::string ending = "_";
  for (const char letter : unit) {
    if (letter == '/') {
      ending += "_per_";
    } else if (letter == ' ' || letter == '*') {
      ending += '_';
    } else if (letter == '\xB2' || letter == '\xB3') {  // the last byte of a raised 2 or 3
      ending += letter == '\xB2' ? '2' : '3';
    } else if (letter != '\xC2') {  // the first byte of both
      ending += static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    }
  }
  if (!unit.empty() && name.size() > ending.size() && name.ends_with(ending)) name.remove_suffix(ending.size());
  return plain(name);
}

std::string sees(std::string_view interface) {
  if (interface == "network") return "sent to received target";
  if (interface == "compensator") return "target to command";
  if (interface == "transfer_system") return "command to displacement";
  if (interface == "displacement_sensor") return "true to measured displacement";
  if (interface == "specimen") return "displacement to force";
  if (interface == "force_sensor") return "true to measured force";
  if (interface == "numerical_substructure") return "forces to commands";
  return "";
}

std::string quantity(double value, std::string_view unit) {
  if (!std::isfinite(value)) return "not known";
  if (!takes_prefix(unit) || value == 0.0) {
    return fmt::format("{:.4g}{}{}", value, unit.empty() ? "" : kNoBreak, unit);
  }
  const auto fits =
      std::ranges::find_if(kPrefixes, [&](const Prefix& prefix) { return std::abs(value) >= 0.9995 * prefix.factor; });
  const Prefix& prefix = fits == kPrefixes.end() ? kPrefixes.back() : *fits;
  return fmt::format("{}{}{}{}", three_digits(value / prefix.factor), kNoBreak, prefix.symbol, unit);
}

std::string percent(double share) {
  const double value = 100.0 * share;
  const double to_end = std::min(std::abs(value), std::abs(100.0 - value));
  if (to_end == 0.0 || to_end >= 10.0) return fmt::format("{:.0f}{}%", value, kNoBreak);
  return fmt::format("{:.{}f}{}%", value, to_end >= 0.995 ? 1 : 2, kNoBreak);
}

std::string between(const Interval& interval, std::string_view unit) {
  return quantity(interval.low, unit) + " to " + quantity(interval.high, unit);
}

std::string between_percent(const Interval& interval) {
  return percent(interval.low) + " to " + percent(interval.high);
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) text += i + 1 == words.size() ? " and " : ", ";
    text += words[i];
  }
  return text;
}

const InterfaceGap* main_fault(const DiagnosisReport& report) {
  const InterfaceGap* largest = nullptr;
  for (const InterfaceGap& gap : report.where) {
    if (gap.is_judged && gap.is_at_fault && (largest == nullptr || gap.share > largest->share)) largest = &gap;
  }
  return largest;
}

std::string corrections_sentence(const DiagnosisReport& report) {
  std::vector<std::string> numbers;
  for (const RankedCause& correction : report.corrections) {
    for (const ReportedParameter& parameter : correction.parameters) {
      if (!parameter.ci95 && !parameter.is_at_bound) continue;
      const std::string known =
          parameter.ci95 ? between(*parameter.ci95, parameter.unit) : "the limit of its search range";
      numbers.push_back(fmt::format("{} of the {}: {} {} ({})", plain(correction.effect), plain(correction.interface),
                                    plain_parameter(parameter.name, parameter.unit),
                                    quantity(parameter.value, parameter.unit), known));
    }
  }
  if (numbers.empty()) return {};
  return "Numbers of the model that are slightly off, each within what the policy allows: " + joined(numbers) +
         ". They are corrected in augmented_model.yaml and are no causes.";
}

std::string verdict_sentence(const DiagnosisReport& report) {
  switch (report.verdict) {
    case Verdict::none:
      return report.corrections.empty()
                 ? "The model agrees with the recordings: no gap is larger than its noise floor."
                 : "The model lacks nothing. Some of its numbers are slightly off, and correcting them closes the gap.";
    case Verdict::named: return named_sentence(report);
    case Verdict::set: return set_sentence(report);
    case Verdict::partial: return partial_sentence(report);
    case Verdict::unknown:
      return where_it_lies(report) + ". No effect in the library explains it." + recurrence(report);
    case Verdict::not_excited:
      return fmt::format("These recordings are not sufficient to check the model: {}.",
                         unusable_channel(report).value_or("the motion is too small against the noise, or channels are "
                                                           "missing"));
  }
  return "";
}

}  // namespace hybridtest::report
