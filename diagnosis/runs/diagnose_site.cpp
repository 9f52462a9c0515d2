#include "diagnosis/runs/diagnose_site.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <set>
#include <string_view>
#include <utility>

#include "core/config_error.hpp"
#include "core/text/scalar.hpp"
#include "diagnosis/intake/units.hpp"
#include "diagnosis/page/diagnosis_json.hpp"
#include "diagnosis/page/diagnosis_page.hpp"
#include "diagnosis/page/wording.hpp"
#include "diagnosis/runs/prediction_file.hpp"
#include "diagnosis/runs/run_records.hpp"
#include "diagnosis/structure/structure_diagnosis.hpp"
#include "diagnosis/tuning.hpp"
#include "recording/error.hpp"
#include "runtime/version.hpp"

namespace hybridtest {
namespace {

using report::Verdict;

void write_file(const std::filesystem::path& file, const std::string& text) {
  std::ofstream out{file, std::ios::binary};
  out << text;
  if (!out.flush())
    throw ConfigError{file.string() +
                      ": this file cannot be written; check the permissions and the free space of the folder"};
}

/// The law of a cause that is one, and what an effect does that follows a recorded input.
std::string detail_of(const report::RankedCause& cause) {
  return report::law_in_words(cause) + report::input_in_words(cause);
}

/// Of a degree of freedom beside the one that the report is about; empty if it has no gap.
std::string other_dof_in_words(const SiteDiagnosis& other) {
  const report::DiagnosisReport& report = other.diagnosis.report;
  if (report.verdict == Verdict::none || report.verdict == Verdict::not_excited) return {};
  std::vector<std::string> causes;
  for (const report::RankedCause& cause : report.ranking) {
    if (!cause.is_cause) continue;
    causes.push_back(fmt::format("{}: {}{}", cause.interface, cause.effect, detail_of(cause)));
    if (cause.parameters.empty()) continue;
    const report::ReportedParameter& first = cause.parameters.front();
    causes.back() += fmt::format(" ({} {:.5g})", first.name, first.value);
  }
  std::vector<std::string> gaps;
  for (const report::InterfaceGap& gap : report.where) {
    if (!gap.is_at_fault) continue;
    gaps.push_back(fmt::format("{} (NRMSE {:.4f}, floor {:.4f})", gap.interface, gap.nrmse, gap.floor_nrmse));
  }
  std::string text =
      fmt::format("Degree of freedom {} has a gap too, verdict {}", other.dof + 1, report::name_of(report.verdict));
  if (!gaps.empty()) text += ", at " + report::joined(gaps);
  if (!causes.empty()) text += "; causes, also in the augmented model: " + report::joined(causes);
  return text + ".";
}

std::string in_words(const report::DiagnosisReport& report) {
  if (report.is_pieced_together) return "causes are named, but so many may stand for one that the library lacks";
  switch (report.verdict) {
    case Verdict::none: return "no gap is above the noise floor";
    case Verdict::named: return "the cause is named";
    case Verdict::set: return "one of several effects that these recordings cannot distinguish";
    case Verdict::partial: return "a cause is named, but it does not explain the whole gap";
    case Verdict::unknown: return "no effect in the library explains the gap";
    case Verdict::not_excited: return "the recordings are not sufficient to check the model";
  }
  return {};
}

std::string parameters_in_words(const report::RankedCause& cause) {
  std::string text;
  for (const report::ReportedParameter& parameter : cause.parameters) {
    text += fmt::format("      {:<32} {:.5g}", parameter.name, parameter.value);
    if (parameter.ci95) text += fmt::format("  [{:.5g}, {:.5g}]", parameter.ci95->low, parameter.ci95->high);
    if (report::is_corrected(parameter)) text += fmt::format("  instead of {:.5g}", *parameter.in_model);
    if (parameter.is_at_least) {
      text += "  or more: these recordings do not show how much";
    } else if (parameter.is_at_bound) {
      text += "  at the limit of its search range";
    }
    text += '\n';
  }
  return text;
}

/// As the list `effects` of a scenario, or for --set.
std::string written_in_one_line(std::span<const EffectSetting> effects) {
  std::string list;
  for (const EffectSetting& effect : effects) {
    list += fmt::format("{}{{interface: {}, effect: {}, {}: {}}}", list.empty() ? "" : ", ",
                        name_of(effect.type->interface), effect.type->name, effect.type->parameters.front().name,
                        written_number(effect.values.front()));
  }
  return "effects=[" + list + "]";
}

std::string response_in_words(const report::ResponseShrink& response) {
  std::string text = fmt::format("\n  response of the whole test against {}\n", response.recording);
  const auto add = [&](std::string_view what, double before, double after,
                       const std::optional<report::Interval>& interval) {
    text += fmt::format("    {:<22} {:.4f} before, {:.4f}{} after\n", what, before, after,
                        interval ? fmt::format(" [{:.4f}, {:.4f}]", interval->low, interval->high) : "");
  };
  add("displacement, NRMSE", response.nrmse_before, response.nrmse_after, response.nrmse_after_ci95);
  add("peak error", response.peak_error_before, response.peak_error_after, response.peak_error_after_ci95);
  if (response.energy_error_before && response.energy_error_after) {
    add("energy error", *response.energy_error_before, *response.energy_error_after, response.energy_error_after_ci95);
  }
  if (!response.floor_nrmse || !response.unknown_share || !response.ci95) return text;
  text += fmt::format("    {:<22} {:.4f}\n", "noise floor, NRMSE", *response.floor_nrmse);
  text += fmt::format("    {:<22} {:.2f} % [{:.2f}, {:.2f}], unknown {:.2f} %\n", "variance removed",
                      100.0 * response.variance_removed, 100.0 * response.ci95->low, 100.0 * response.ci95->high,
                      100.0 * *response.unknown_share);
  for (const report::PredictedNumber& peak : response.peaks) {
    text += fmt::format("    {:<22} {:.5g} m recorded, {:.5g} [{:.5g}, {:.5g}] predicted\n", "peak of " + peak.of,
                        peak.recorded, peak.predicted, peak.ci95.low, peak.ci95.high);
  }
  return text;
}

}  // namespace

std::vector<ListedEffect> SiteDiagnosis::listed_causes(const SiteModelFile& model) const {
  std::vector<ListedEffect> listed;
  for (const EffectSetting& cause : diagnosis.causes) {
    listed.push_back({cause, model.dofs.size() > 1 ? std::optional{static_cast<int>(dof)} : std::nullopt});
  }
  listed.insert(listed.end(), other_causes.begin(), other_causes.end());
  return listed;
}

std::vector<Eigen::MatrixXd> SiteDiagnosis::doubts() const {
  std::vector<Eigen::MatrixXd> all = diagnosis.doubts;
  all.insert(all.end(), other_doubts.begin(), other_doubts.end());
  return all;
}

TimeBase time_base_of(const SiteModelFile& model) noexcept {
  return model.is_quasi_static ? TimeBase::quasi_static : TimeBase::recorded;
}

namespace {

/// Inputs that effects of the model follow and that a recording lacks.
std::vector<std::string> missing_inputs(const SiteModelFile& model, const Recording& recording) {
  std::set<std::string> missing;
  for (const SiteModel& dof : model.dofs) {
    for (const EffectSetting& effect : dof.effects) {
      const std::string_view input = effect.type->input;
      if (!input.empty() && !recording.has_input(input)) missing.emplace(input);
    }
  }
  return {missing.begin(), missing.end()};
}

/// What is wrong with the formulas that are suspected.
std::vector<ConfigIssue> formula_issues(const SiteModelFile& model, std::span<const Recording> recordings) {
  std::vector<ConfigIssue> issues;
  for (const EffectType* formula : model.dofs.front().suspected) {
    const std::string_view input = formula->input;
    const auto has_input = [&](const Recording& recording) { return recording.has_input(input); };
    if (!input.empty() && std::ranges::none_of(recordings, has_input)) {
      issues.push_back({.file = {},
                        .what = fmt::format("the formula {} uses the input {}, and no recording has a column {}{}",
                                            formula->name, input, kInputPrefix, input)});
    }
    const auto is_namesake = [&](const EffectSetting& effect) { return effect.type->name == formula->name; };
    if (std::ranges::any_of(model.dofs,
                            [&](const SiteModel& dof) { return std::ranges::any_of(dof.effects, is_namesake); })) {
      issues.push_back({.file = {},
                        .what = fmt::format("the model {} has a formula named {}; expected another name",
                                            model.file.string(), formula->name)});
    }
  }
  return issues;
}

}  // namespace

void require_match(const SiteModelFile& model, std::span<const Recording> recordings) {
  std::vector<ConfigIssue> issues = formula_issues(model, recordings);
  for (const Recording& recording : recordings) {
    if (recording.dofs.size() != model.dofs.size()) {
      issues.push_back(
          {.file = {},
           .what = fmt::format("{} has {} degrees of freedom, the model {} has {}; expected the same number. "
                               "A list under specimen or transfer_system has an entry for each degree of "
                               "freedom; laws in parallel on one degree of freedom are written "
                               "{{type: parallel, laws: [...]}}",
                               recording.file, recording.dofs.size(), model.file.string(), model.dofs.size())});
      continue;
    }
    const std::vector<std::string> missing = missing_inputs(model, recording);
    for (const std::string& input : missing) {
      issues.push_back(
          {.file = {},
           .what = fmt::format("{} has no column {}{}, and an effect of the model {} follows the input {}; "
                               "expected the column in each recording",
                               recording.file, kInputPrefix, input, model.file.string(), input)});
    }
    for (std::size_t dof = 0; dof < model.dofs.size() && missing.empty(); ++dof) {
      for (const IntakeFinding& finding : check_units_against(model.dofs[dof], recording, dof)) {
        issues.push_back({.file = {}, .what = finding.text(recording.file)});
      }
    }
  }
  if (!issues.empty()) throw ConfigError{std::move(issues)};
}

GapOfDof gap_of(const report::DiagnosisReport& report) {
  GapOfDof largest{.has_verdict = report.verdict != Verdict::none && report.verdict != Verdict::not_excited};
  for (const report::InterfaceGap& gap : report.where) {
    const double floor = std::hypot(gap.floor_nrmse, tuning::kModelAllowance);
    largest.is_clear = largest.is_clear || gap.nrmse > tuning::kNearFloor * floor;
    largest.above_floor = std::max(largest.above_floor, std::pow(gap.nrmse, 2) - std::pow(gap.floor_nrmse, 2));
  }
  return largest;
}

SiteDiagnosis diagnose_site(const SiteModelFile& model, std::span<const Recording> recordings,
                            DiagnoseSettings settings) {
  settings.site = model.name.empty() ? model.file.stem().string() : model.name;
  settings.model_file = model.file.string();
  settings.model_part = model.part;
  settings.made_by = software_version();
  const std::size_t dofs = model.dofs.size();
  require_match(model, recordings);
  std::vector<SiteDiagnosis> all;
  const PartProgress whole = settings.progress;
  for (std::size_t dof = 0; dof < dofs; ++dof) {
    settings.dof = dof;
    settings.progress = whole.round(dof, dofs);
    all.push_back({diagnose(model.dofs[dof], recordings, settings), dof, {}, {}, {}});
  }
  const auto largest =
      std::ranges::max_element(all, {}, [](const SiteDiagnosis& one) { return gap_of(one.diagnosis.report); });
  SiteDiagnosis worst = std::move(*largest);
  all.erase(largest);
  std::vector<std::string>& notes = worst.diagnosis.report.notes;
  if (dofs > 1) {
    notes.push_back(fmt::format("This diagnosis is of degree of freedom {} of {}, which has the largest gap.",
                                worst.dof + 1, dofs));
  }
  for (const SiteDiagnosis& other : all) {
    if (std::string text = other_dof_in_words(other); !text.empty()) notes.push_back(std::move(text));
    std::ranges::move(other.listed_causes(model), std::back_inserter(worst.other_causes));
    std::ranges::move(other.doubts(), std::back_inserter(worst.other_doubts));
  }
  if (model.compensators_were_given) {
    worst.diagnosis.report.notes.emplace_back("The model names no compensator. That of the run was used.");
  }
  return worst;
}

void diagnose_structure_of(SiteDiagnosis& diagnosis, const std::filesystem::path& run,
                           const std::filesystem::path& scenario, const PartProgress& progress) {
  progress.report("structure recomputed", 0, 1);
  report::DiagnosisReport& report = diagnosis.diagnosis.report;
  try {
    const StructureRecord record = structure_record(run, read_scenario(scenario, {}));
    const StructureDiagnosis structure = diagnose_structure(record.model, record.recording);
    add_structure(structure, diagnosis.diagnosis);
    diagnosis.structure_causes = causes_of(structure);
    report.notes.insert(report.notes.end(), record.notes.begin(), record.notes.end());
  } catch (const RecordingError& error) {
    report.notes.push_back(fmt::format("The numerical substructure is not judged: {}.", error.what()));
  }
  if (!diagnosis.structure_causes.empty()) {
    report.notes.push_back(
        "Write effects of the numerical substructure into the scenario, not into the model of the site: " +
        written_in_one_line(diagnosis.structure_causes));
  }
}

void write_diagnosis(const SiteDiagnosis& diagnosis, const SiteModelFile& model, const std::filesystem::path& directory,
                     const PartProgress& progress) {
  progress.report("pages written", 0, 1);
  std::error_code failed;
  std::filesystem::create_directories(directory, failed);
  if (failed) throw ConfigError{"--out " + directory.string() + ": " + failed.message()};
  write_file(directory / "diagnosis.json", diagnosis_json(diagnosis.diagnosis));
  write_file(directory / "diagnosis.html", report::diagnosis_page(diagnosis.diagnosis.report));
  write_file(directory / kPredictionFile, prediction_csv(diagnosis.diagnosis.report));
  write_file(directory / "augmented_model.yaml", model.with_effects(diagnosis.listed_causes(model)).text);
  progress.report("pages written", 1, 1);
}

std::string summary_of(const SiteDiagnosis& site) {
  const report::DiagnosisReport& report = site.diagnosis.report;
  std::string text = fmt::format("{}: {}{}\n", report::name_of(report.verdict), in_words(report),
                                 report.set_leaves_a_part ? "; none explains all of the gap" : "");
  if (!report.where.empty()) text += "\n  where                      share of the gap        NRMSE      floor\n";
  for (const report::InterfaceGap& gap : report.where) {
    if (!gap.is_judged) {
      text += fmt::format("    {:<22} not judged: {}\n", gap.interface, gap.why_not);
      continue;
    }
    text +=
        fmt::format("    {:<22} {:>5.1f} % [{:>5.1f}, {:>5.1f}] {:>9.4f} {:>10.4f}\n", gap.interface, 100.0 * gap.share,
                    100.0 * gap.share_ci95.low, 100.0 * gap.share_ci95.high, gap.nrmse, gap.floor_nrmse);
  }
  bool are_causes = true;
  for (const report::RankedCause& cause : report.ranking) {
    if (!cause.is_cause && cause.probability < 1e-3 && !cause.is_indistinguishable) continue;
    if (&cause == &report.ranking.front() && cause.is_cause) text += "\n  causes\n";
    if (are_causes && !cause.is_cause) {
      text += "\n  also considered\n";
      are_causes = false;
    }
    text += fmt::format("    {}: {}{}, probability {:.3f}\n", cause.interface, cause.effect, detail_of(cause),
                        cause.probability);
    if (cause.is_cause) text += parameters_in_words(cause);
  }
  if (!report.corrections.empty()) text += "\n  " + report::corrections_sentence(report) + "\n";
  if (report.interface_shrink) {
    const report::Shrink& shrink = *report.interface_shrink;
    text += fmt::format("\n  gap there, NRMSE         {:.4f} before, {:.4f} after, floor {:.4f}\n", shrink.nrmse_before,
                        shrink.nrmse_after, shrink.floor_nrmse);
    text += fmt::format("  variance removed         {:.2f} %", 100.0 * shrink.variance_removed);
    if (shrink.ci95) text += fmt::format(" [{:.2f}, {:.2f}]", 100.0 * shrink.ci95->low, 100.0 * shrink.ci95->high);
    text += '\n';
  }
  if (report.response_shrink) {
    text += response_in_words(*report.response_shrink);
  } else if (!report.why_no_response.empty()) {
    text += "\n  response of the whole test: not known, " + report.why_no_response + "\n";
  }
  if (!report.next_experiment.empty()) text += "\n  next: " + report.next_experiment + "\n";
  for (const std::string& note : report.notes) text += "  note: " + note + "\n";
  return text;
}

}  // namespace hybridtest
