#include "diagnosis/diagnose.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

#include "diagnosis/identification/continuation.hpp"
#include "diagnosis/identification/segment.hpp"
#include "diagnosis/localisation/sensor_checks.hpp"
#include "diagnosis/page/wording.hpp"
#include "diagnosis/sanity/channel_findings.hpp"
#include "diagnosis/signals/signals.hpp"
#include "diagnosis/traces/traces.hpp"
#include "diagnosis/tuning.hpp"
#include "diagnosis/verdict/causes.hpp"
#include "diagnosis/verdict/experiments.hpp"
#include "diagnosis/verdict/library_fits.hpp"
#include "diagnosis/verdict/shrink.hpp"
#include "diagnosis/verdict/where.hpp"

namespace hybridtest {
namespace {

using report::RankedCause;
using report::Verdict;

std::vector<Segment> segments_in_role(const SiteModel& model, std::span<const Recording> recordings, RecordingRole role,
                                      std::size_t dof) {
  std::vector<Segment> segments;
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    if (recordings[i].role != role || recordings[i].dofs.size() <= dof) continue;
    std::vector<Segment> own = modelled_segments(model, recordings[i], dof, i);
    carry_history(model, recordings, dof, own);
    std::ranges::move(own, std::back_inserter(segments));
  }
  return segments;
}

bool explains_all_of(std::span<const Trace> traces, const Segment& segment) {
  return segment.from == Channel::sent_displacement && std::ranges::any_of(traces, [&](const Trace& trace) {
           return trace.in == Channel::target_displacement && segment.to == trace.in;
         });
}

/// The causes of the verdict first, then the other candidates.
std::vector<RankedCause> rank(const IdentificationProblem& problem, const Selection& selection,
                              const Judgement& judgement, const PartProgress& progress) {
  std::vector<RankedCause> ranking;
  const bool has_causes = report::names_a_cause(judgement.verdict);
  std::vector<const EffectType*> listed;
  if (has_causes) {
    const std::vector<double> shares = cause_shares(problem, selection.baseline, selection.chosen, progress);
    for (std::size_t i = 0; i < selection.chosen.effects.size(); ++i) {
      RankedCause cause = ranked(selection.chosen.effects[i], selection.chosen.parameters[i]);
      cause.is_cause = true;
      cause.share = shares[i];
      listed.push_back(selection.chosen.effects[i].type);
      ranking.push_back(std::move(cause));
    }
    std::ranges::stable_sort(ranking, std::greater{}, &RankedCause::share);
  }
  for (std::size_t i = 0; i < selection.library.size() && ranking.size() < tuning::kRankingMax; ++i) {
    const Candidate& candidate = selection.library[i];
    const auto known = std::ranges::find(listed, candidate.type);
    const bool in_set = std::ranges::find(judgement.indistinguishable, i) != judgement.indistinguishable.end();
    if (known != listed.end()) {
      const auto entry = std::ranges::find_if(ranking, [&](const RankedCause& cause) {
        return cause.effect == candidate.type->name && cause.interface == name_of(candidate.type->interface);
      });
      entry->probability = selection.probabilities[i];
      entry->is_indistinguishable = judgement.verdict == Verdict::set;
      continue;
    }
    RankedCause cause = ranked(candidate.fit.effects.front(), candidate.fit.parameters.front());
    cause.probability = selection.probabilities[i];
    cause.is_indistinguishable = in_set && has_causes;
    cause.is_cause = cause.is_indistinguishable && judgement.verdict == Verdict::set;
    ranking.push_back(std::move(cause));
  }
  std::ranges::stable_sort(ranking,
                           [](const RankedCause& a, const RankedCause& b) { return a.is_cause && !b.is_cause; });
  // A second cause does not compete with the first one: its probability follows from its own share of the evidence.
  if (selection.chosen.effects.size() > 1 && has_causes) {
    for (RankedCause& cause : ranking) {
      if (cause.is_cause) cause.probability = 1.0 - judgement.gap_left;
    }
  }
  return ranking;
}

report::InterfaceSeries series_of(const SiteModel& model, const Segment& segment, const Recording& recording,
                                  const Diagnosis& diagnosis, std::size_t dof) {
  report::InterfaceSeries series;
  series.interface = name_of(segment.interface);
  series.dof = dof;
  series.recording = recording.file;
  series.is_held_out = recording.role == RecordingRole::held_out;
  series.sample_period_s = segment.period_s;
  series.is_quasi_static = segment.is_quasi_static;
  series.unit = segment.to == Channel::measured_force ? "N" : "m";
  for (const Motion& motion : segment.input) series.input_m.push_back(motion.displacement_m);
  series.measured = segment.measured;
  series.model = predict(model, segment);
  const bool touched = std::ranges::any_of(diagnosis.causes,
                                           [&](const EffectSetting& cause) { return segment.touched_by(*cause.type); });
  if (touched) series.augmented = predict(model, segment, diagnosis.causes);
  return series;
}

GapPlace place_of(const report::InterfaceSeries& series) {
  GapPlace place{.interface = series.interface, .time_windows = {}, .bands = {}, .regions = {}};
  if (series.measured.size() < tuning::kLocaliseSamplesMin) return place;
  std::vector<double> residual(series.measured.size());
  std::ranges::transform(series.measured, series.model, residual.begin(), std::minus{});
  const GapSignals signals{series.sample_period_s, series.input_m, series.measured, residual};
  place.time_windows =
      windows_holding(gap_over_time(signals, std::min(tuning::kPlaceWindows, signals.size())), tuning::kMainShare);
  if (series.is_quasi_static) return place;  // frequencies and velocities have no meaning
  const Spectra spectra = welch(signals.input_m, signals.residual, signals.period_s, welch_segment(signals.size()));
  place.bands = bands_holding(gap_over_frequency(signals, spectra), tuning::kMainShare);
  place.regions =
      regions_holding(gap_over_motion(signals, tuning::kMotionBins, tuning::kMotionBins), tuning::kMainShare);
  return place;
}

/// Interfaces changed by a cause first, then by size of the gap.
void worst_first(std::vector<report::InterfaceSeries>& series) {
  const auto rank = [](const report::InterfaceSeries& one) {
    double gap = 0.0;
    double size = 0.0;
    for (std::size_t i = 0; i < one.measured.size(); ++i) {
      gap += std::pow(one.measured[i] - one.model[i], 2);
      size += std::pow(one.measured[i], 2);
    }
    return std::pair{one.augmented.empty(), size > 0.0 ? -gap / size : 0.0};
  };
  std::ranges::stable_sort(series, {}, rank);
}

std::string next_experiment(const Selection& selection, const Judgement& judgement,
                            const std::vector<report::InterfaceGap>& where) {
  if (judgement.verdict == Verdict::set) {
    std::vector<const EffectType*> members;
    for (const std::size_t i : judgement.indistinguishable) members.push_back(selection.library[i].type);
    return experiment_that_splits(members);
  }
  if (judgement.verdict != Verdict::unknown && judgement.verdict != Verdict::partial) return {};
  for (const EffectInterface interface :
       {EffectInterface::network, EffectInterface::compensator, EffectInterface::transfer_system,
        EffectInterface::displacement_sensor, EffectInterface::specimen, EffectInterface::force_sensor}) {
    if (!where.empty() && where.front().interface == name_of(interface)) return experiment_for_unknown(interface);
  }
  return {};
}

std::vector<EffectSetting> causes_of(const Selection& selection, const Judgement& judgement,
                                     std::span<const Trace> traces) {
  std::vector<EffectSetting> causes;
  if (report::names_a_cause(judgement.verdict)) causes = selection.chosen.effects;
  std::ranges::transform(traces, std::back_inserter(causes), &Trace::effect);
  return causes;
}

/// The segments in which the fit found a gap. A channel that a cause also changes, but that is within its noise floor
/// with and without the cause, does not show how much of the gap is removed.
std::vector<Segment> with_a_gap(const IdentificationProblem& problem, std::span<const Segment> segments) {
  std::vector<Segment> kept;
  std::ranges::copy_if(segments, std::back_inserter(kept), [&](const Segment& segment) {
    const auto alike = [&](const FitSegment& fit) {
      return fit.segment.from == segment.from && fit.segment.to == segment.to;
    };
    return std::ranges::none_of(problem.segments, alike) ||
           std::ranges::any_of(problem.segments, [&](const FitSegment& fit) { return fit.is_suspect && alike(fit); });
  });
  return kept;
}

/// Of each kind of segment that the causes act on.
std::vector<report::Shrink> shrinks(const SiteModel& model, std::span<const EffectSetting> causes,
                                    std::span<const Segment> segments, std::uint64_t seed) {
  std::map<std::pair<Channel, Channel>, std::vector<Segment>> kinds;
  for (const Segment& segment : segments) {
    const bool touched =
        std::ranges::any_of(causes, [&](const EffectSetting& cause) { return segment.touched_by(*cause.type); });
    if (touched) kinds[{segment.from, segment.to}].push_back(segment);
  }
  std::vector<report::Shrink> result;
  for (const auto& [channels, alike] : kinds) result.push_back(shrink_on(model, causes, alike, seed));
  return result;
}

void drop_what_does_not_carry_over(const SiteModel& model, std::span<const Segment> held_out, std::uint64_t seed,
                                   const Selection& selection, Judgement& judgement, Diagnosis& diagnosis) {
  report::DiagnosisReport& report = diagnosis.report;
  const Verdict verdict = verdict_carried_over(judgement.verdict, shrinks(model, diagnosis.causes, held_out, seed));
  if (verdict == judgement.verdict) return;
  report.notes.push_back(std::string{selection.chosen.effects.front().type->name} +
                         " fits the fitted recordings but not the held-out ones.");
  judgement = {.verdict = verdict, .indistinguishable = {}, .gap_left = 1.0};
  report.interface_shrink.reset();
  diagnosis.causes.clear();
}

/// What is not known of a test without time.
void add_quasi_static_notes(const SiteModel& model, std::span<const Recording> recordings,
                            std::vector<std::string>& notes) {
  std::vector<std::string> files;
  for (const Recording& recording : recordings) {
    if (recording.is_quasi_static) files.push_back(recording.file);
  }
  if (files.empty()) return;
  notes.push_back("Quasi-static, without time: " + report::joined(files) +
                  ". Path takes the place of time: where this answer gives seconds, one stands for a cycle over the "
                  "whole range of the motion. Effects of rate, time and inertia are not judged. If this test was not "
                  "slow, give its time in an evenly sampled column time_s.");
  std::vector<std::string> left_out;
  for (const EffectSetting& effect : model.effects) {
    if (effect.type->traits.needs_time) left_out.emplace_back(effect.type->name);
  }
  if (!left_out.empty()) {
    notes.push_back("Left out of the model there, because it needs time: " + report::joined(left_out) + ".");
  }
}

void add_continuation_notes(std::span<const Recording> recordings, std::size_t dof, std::vector<std::string>& notes) {
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    const auto before = continued_by(recordings, i, dof);
    if (!before) continue;
    notes.push_back(recordings[i].file + " continues " + recordings[*before].file +
                    ": the specimen begins there with the history of the part before.");
  }
}

void add_notes(Diagnosis& diagnosis, std::span<const Segment> segments) {
  const auto sees = [&](Channel to) {
    return std::ranges::any_of(segments, [&](const Segment& s) { return s.to == to; });
  };
  if (!sees(Channel::measured_force)) {
    diagnosis.report.notes.emplace_back(
        "The specimen is not judged: it needs measured displacement, measured force and a specimen in the model.");
  }
  if (!sees(Channel::measured_displacement)) {
    diagnosis.report.notes.emplace_back(
        "The transfer system is not judged: it needs command and measured displacement.");
  }
  for (const RankedCause& cause : diagnosis.report.ranking) {
    for (const report::ReportedParameter& parameter : cause.parameters) {
      if (cause.is_cause && parameter.is_at_bound) {
        diagnosis.report.notes.push_back(cause.effect + ": " + parameter.name +
                                         " is at the limit of its search range.");
      }
    }
  }
}

}  // namespace

Diagnosis diagnose(const SiteModel& model, std::span<const Recording> given, const DiagnoseSettings& settings) {
  const std::vector<ChannelFinding> findings = check_channels(model, given, settings.dof);
  std::vector<Recording> without_unusable;
  const std::span<const Recording> recordings = usable_part(given, settings.dof, findings, without_unusable);
  Diagnosis diagnosis;
  report::DiagnosisReport& report = diagnosis.report;
  report.site = settings.site;
  report.model_file = settings.model_file;
  report.model_part = settings.model_part;
  report.made_at_utc = settings.made_at_utc;
  report.made_by = settings.made_by;
  for (const Recording& recording : recordings) {
    report.recordings.push_back({recording.file, recording.sha256, recording.role,
                                 recording.sample_period_s * static_cast<double>(recording.samples),
                                 recording.sample_period_s, recording.is_quasi_static});
  }
  for (const Recording& recording : given) {
    if (recording.dofs.size() > settings.dof) add_sensor_facts(recording, settings.dof, report);
  }
  const PartProgress& progress = settings.progress;
  progress.report("recordings examined", 0, 1);
  const std::vector<Trace> traces = find_traces(model, recordings, settings.dof);
  std::vector<Segment> segments = segments_in_role(model, recordings, RecordingRole::fit, settings.dof);
  // Random network faults are found by their traces only.
  std::erase_if(segments, [&](const Segment& segment) { return explains_all_of(traces, segment); });
  if (segments.empty() && traces.empty()) {
    add_unjudged(model, recordings, settings.dof, report.where);
    report.verdict = Verdict::not_excited;
    report.next_experiment =
        "Record command and measured displacement, or measured displacement and measured force, of one test.";
    report.notes.emplace_back(
        "The recordings do not contain input and output of any interface that the model predicts.");
    add_findings(findings, report);
    return diagnosis;
  }
  IdentificationProblem problem = make_problem(model, segments);
  std::vector<Segment> thin;
  for (const Segment& segment : segments) thin.push_back(thinned(segment, tuning::kFitRate_hz));
  const IdentificationProblem coarse = make_problem(model, std::move(thin));
  const Selection selection =
      select_effects(problem, coarse, settings.threads, progress.part(tuning::kPrepared, tuning::kSelected));
  settle_noise(problem, selection.chosen);
  Judgement judgement = judge(problem, selection);
  diagnosis.causes = causes_of(selection, judgement, traces);
  const std::vector<Segment> held_out = segments_in_role(model, recordings, RecordingRole::held_out, settings.dof);
  const std::span<const Segment> judged = held_out.empty() ? segments : held_out;
  if (!diagnosis.causes.empty()) {
    const std::vector<Segment> with_gap = with_a_gap(problem, judged);
    report.interface_shrink = shrink_on(model, diagnosis.causes, with_gap, settings.seed);
    if (held_out.empty()) {
      report.notes.emplace_back(
          "No recording was held out: the gap that remains is measured on the fitted recordings.");
    } else if (traces.empty()) {
      drop_what_does_not_carry_over(model, with_gap, settings.seed, selection, judgement, diagnosis);
    }
  }
  const GapParts parts = gap_parts(problem, selection, judgement, traces);
  report.verdict = verdict_with(traces, judgement, parts);
  report.ranking = rank(problem, selection, judgement, progress.part(tuning::kSelected, tuning::kRanked));
  report.where =
      locate(problem, selection.baseline,
             report::names_a_cause(judgement.verdict) ? selection.chosen : selection.baseline, settings.seed);
  add_traces(traces, parts, report.ranking);
  add_traces(traces, parts, report.where);
  report.next_experiment = next_experiment(selection, judgement, report.where);
  const std::vector<Excitation> excitations = excitations_of(problem);
  leave_out_unexcited(excitations, report.where);
  add_repeatability(model, segments, report.where);
  add_unjudged(model, recordings, settings.dof, report.where);
  if (report.verdict == Verdict::none && cannot_tell(excitations)) {
    report.verdict = Verdict::not_excited;
    report.next_experiment = experiment_that_excites(excitations);
    report.ranking.clear();
  }

  for (const Segment& segment : judged) {
    progress.part(tuning::kRanked, 1.0).report("curves computed", report.series.size(), judged.size());
    report.series.push_back(series_of(model, segment, recordings[segment.recording], diagnosis, settings.dof));
  }
  worst_first(report.series);
  for (const report::InterfaceSeries& series : report.series) diagnosis.places.push_back(place_of(series));
  report.why_no_response = "it needs a run directory; these recordings contain only the site, not the structure";
  add_quasi_static_notes(model, recordings, report.notes);
  add_continuation_notes(recordings, settings.dof, report.notes);
  add_notes(diagnosis, segments);
  add_findings(findings, report);
  return diagnosis;
}

}  // namespace hybridtest
