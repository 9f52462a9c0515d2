#include "diagnosis/diagnose.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <utility>

#include "diagnosis/identification/continuation.hpp"
#include "diagnosis/identification/law_candidates.hpp"
#include "diagnosis/identification/segment.hpp"
#include "diagnosis/identification/smoothing_choice.hpp"
#include "diagnosis/localisation/sensor_checks.hpp"
#include "diagnosis/page/wording.hpp"
#include "diagnosis/sanity/channel_findings.hpp"
#include "diagnosis/sanity/mains_hum.hpp"
#include "diagnosis/signals/signals.hpp"
#include "diagnosis/traces/traces.hpp"
#include "diagnosis/tuning.hpp"
#include "diagnosis/verdict/causes.hpp"
#include "diagnosis/verdict/experiments.hpp"
#include "diagnosis/verdict/recurrence.hpp"
#include "diagnosis/verdict/rivals.hpp"
#include "diagnosis/verdict/shrink.hpp"
#include "diagnosis/verdict/stages.hpp"
#include "diagnosis/verdict/stiffness_loss.hpp"
#include "diagnosis/verdict/where.hpp"

namespace hybridtest {
namespace {

using report::RankedCause;
using report::Verdict;

/// @param segments_of_one   of a recording at its position.
template <class SegmentsOfOne>
std::vector<Segment> segments_in_role(const SiteModel& model, std::span<const Recording> recordings, RecordingRole role,
                                      std::size_t dof, const Workers& workers, SegmentsOfOne&& segments_of_one) {
  std::vector<std::vector<Segment>> of_recordings(recordings.size());
  workers.for_each(recordings.size(), [&](std::size_t i) {
    if (recordings[i].role != role || recordings[i].dofs.size() <= dof) return;
    of_recordings[i] = segments_of_one(recordings[i], i);
    carry_history(model, recordings, dof, of_recordings[i]);
  });
  std::vector<Segment> segments;
  for (std::vector<Segment>& own : of_recordings) std::ranges::move(own, std::back_inserter(segments));
  return segments;
}

bool explains_all_of(std::span<const Trace> traces, const Segment& segment) {
  return segment.from == Channel::sent_displacement && std::ranges::any_of(traces, [&](const Trace& trace) {
           return trace.in == Channel::target_displacement && segment.to == trace.in;
         });
}

/// Of a law in place of the specimen's own, over the recording in which it has lost most; 0 for an effect, and for a
/// law that does not soften.
double stiffness_lost_in(const IdentificationProblem& problem, const EffectSetting& cause) {
  double most = 0.0;
  if (cause.type->replacement == nullptr || !law_candidate(*cause.type).softens) return most;
  const std::unique_ptr<Law> law = cause.type->replacement->make(cause.values);
  for (const FitSegment& fit : problem.segments) {
    if (law != nullptr && fit.segment.to == Channel::measured_force) {
      most = std::max(most, lost_stiffness(*law, fit.segment.input));
    }
  }
  return most;
}

/// Whether a chosen effect has rivals, or goes with one that has.
bool is_in_doubt(const std::vector<EffectSetting>& chosen, const Judgement& judgement, std::size_t position) {
  if (!judgement.rivals) return false;
  const std::size_t with_rivals = judgement.rivals->chosen;
  return position == with_rivals || go_together(*chosen[position].type, *chosen[with_rivals].type);
}

/// The causes of the verdict first, then the other candidates.
/// @param part   of the whole explained gap, that this stage explains.
std::vector<RankedCause> rank(const Stage& stage, double part) {
  const Selection& selection = stage.selection;
  const Judgement& judgement = stage.judgement;
  std::vector<RankedCause> ranking;
  if (judgement.verdict == Verdict::none) return ranking;
  std::vector<const EffectType*> listed;
  const bool is_set = judgement.verdict == Verdict::set;
  if (stage.has_causes()) {
    for (std::size_t i = 0; i < selection.chosen.effects.size(); ++i) {
      listed.push_back(selection.chosen.effects[i].type);
      if (judgement.is_correction(i)) continue;
      RankedCause cause = ranked(stage.problem.model, selection.chosen, i);
      cause.is_cause = true;
      cause.may_be_absent = std::ranges::find(judgement.may_be_absent, i) != judgement.may_be_absent.end();
      cause.lost_stiffness = stiffness_lost_in(stage.problem, selection.chosen.effects[i]);
      cause.share = part * selection.shares[i];
      cause.probability = tuning::kAnswerRight * selection.chosen_probabilities[i];
      cause.is_indistinguishable = judgement.indistinguishable.size() > 1 &&
                                   std::ranges::any_of(judgement.indistinguishable, [&](std::size_t member) {
                                     return selection.library[member].type == selection.chosen.effects[i].type;
                                   });
      if (is_in_doubt(selection.chosen.effects, judgement, i)) {
        cause.probability = tuning::kAnswerRight * judgement.rivals->probability;
        cause.is_indistinguishable = true;
      }
      ranking.push_back(std::move(cause));
    }
    std::ranges::stable_sort(ranking, std::greater{}, &RankedCause::share);
    if (judgement.rivals) {
      for (const Candidate& rival : judgement.rivals->fitted) {
        listed.push_back(rival.type);
        RankedCause cause = ranked(stage.problem.model, rival.fit, 0);
        cause.probability = tuning::kAnswerRight * judgement.rivals->probability;
        cause.is_indistinguishable = true;
        cause.is_cause = is_set;
        ranking.push_back(std::move(cause));
      }
    }
  }
  for (std::size_t i = 0; i < selection.library.size() && ranking.size() < tuning::kRankingMax; ++i) {
    const Candidate& candidate = selection.library[i];
    if (std::ranges::find(listed, candidate.type) != listed.end()) continue;
    const bool in_set = std::ranges::find(judgement.indistinguishable, i) != judgement.indistinguishable.end();
    const auto alike = std::ranges::find(selection.alike, candidate.type, &AlikeLeader::type);
    const FitOutcome& fit = alike == selection.alike.end() ? candidate.fit : alike->fit;
    // Beside numbers of the model it need not come first.
    const auto own = std::ranges::find(fit.effects, candidate.type, &EffectSetting::type);
    RankedCause cause = ranked(stage.problem.model, fit, static_cast<std::size_t>(own - fit.effects.begin()));
    cause.probability = tuning::kAnswerRight * candidate.probability;
    cause.is_indistinguishable = in_set;
    cause.is_cause = in_set && is_set;
    ranking.push_back(std::move(cause));
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
  if (segment.touched_by(diagnosis.causes)) series.augmented = predict(model, segment, diagnosis.causes);
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

std::string next_experiment(std::span<const Stage> stages, const std::vector<report::InterfaceGap>& where) {
  for (const Stage& stage : stages) {
    if (stage.judgement.verdict != Verdict::set) continue;
    std::vector<const EffectType*> members;
    for (const std::size_t i : stage.judgement.indistinguishable) members.push_back(stage.selection.library[i].type);
    if (const auto& rivals = stage.judgement.rivals) {
      members.push_back(stage.selection.chosen.effects[rivals->chosen].type);
      std::ranges::transform(rivals->fitted, std::back_inserter(members), &Candidate::type);
    }
    return experiment_that_splits(members);
  }
  std::vector<const EffectType*> causes;
  std::ranges::transform(causes_of(stages, {}), std::back_inserter(causes), &EffectSetting::type);
  if (std::string within_range = experiment_within_range(causes); !within_range.empty()) return within_range;
  const auto is_open = [](const Stage& stage) {
    return stage.judgement.verdict == Verdict::unknown || stage.judgement.verdict == Verdict::partial;
  };
  for (const report::InterfaceGap& gap : where) {
    const bool open = std::ranges::any_of(
        stages, [&](const Stage& stage) { return is_open(stage) && stage.concerns(gap.interface); });
    if (!open) continue;
    for (const EffectInterface interface :
         {EffectInterface::network, EffectInterface::compensator, EffectInterface::transfer_system,
          EffectInterface::displacement_sensor, EffectInterface::specimen, EffectInterface::force_sensor}) {
      if (gap.interface != name_of(interface)) continue;
      return experiment_for_unknown(interface, !gap.recurrence || gap.recurrence->is_seen());
    }
  }
  return {};
}

/// Numbers of the model that are slightly off.
std::vector<RankedCause> corrections_of(std::span<const Stage> stages) {
  std::vector<RankedCause> corrections;
  for (const Stage& stage : stages) {
    for (const std::size_t i : stage.judgement.corrections) {
      corrections.push_back(ranked(stage.problem.model, stage.selection.chosen, i));
      corrections.back().probability = tuning::kAnswerRight * stage.selection.chosen_probabilities[i];
      corrections.back().share = stage.selection.shares[i];
    }
  }
  return corrections;
}

SiteModel with_effects(SiteModel model, std::span<const EffectSetting> effects) {
  for (const EffectSetting& effect : effects) add_effect(model, effect);
  return model;
}

/// Of causes_of(), see Diagnosis::doubts. What shows in digits is counted, not fitted.
std::vector<Eigen::MatrixXd> doubts_of(std::span<const Stage> stages, std::span<const Trace> traces) {
  std::vector<Eigen::MatrixXd> doubts;
  for (const Stage& stage : stages) {
    if (stage.changes_model()) doubts.push_back(covariance_for_draws(stage.selection.chosen));
  }
  for (const Trace& trace : traces) {
    const auto count = std::ssize(trace.effect.values);
    doubts.emplace_back(Eigen::MatrixXd::Zero(count, count));
  }
  return doubts;
}

/// Fit of all causes in the whole problem, for where the gap lies.
FitOutcome fit_of_all(const IdentificationProblem& problem, std::span<const Stage> stages) {
  const std::vector<EffectSetting> causes = causes_of(stages, {});
  return causes.empty() ? fit_nothing(problem, false) : refit_effects(problem, causes, false);
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
  std::vector<std::string> not_tried;
  for (const EffectType* formula : model.suspected) {
    if (formula->traits.needs_time) not_tried.emplace_back(formula->name);
  }
  if (!not_tried.empty()) {
    notes.push_back("Formulas that were not tried there, because they need time: " + report::joined(not_tried) + ".");
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

/// Where an effect of a recorded input cannot be judged.
void add_input_notes(const IdentificationProblem& problem, std::span<const Recording> recordings,
                     std::vector<std::string>& notes) {
  for (const InputRange& input : problem.inputs) {
    const std::string column = std::string{kInputPrefix} + input.name;
    if (!input.varies) {
      notes.push_back(column +
                      " hardly changes while the specimen is loaded: no effect of it was searched. Record tests "
                      "at different values of it.");
      continue;
    }
    std::vector<std::string> without;
    for (const Recording& recording : recordings) {
      if (!recording.has_input(input.name)) without.push_back(recording.file);
    }
    if (without.empty()) continue;
    notes.push_back("Without the column " + column + ": " + report::joined(without) +
                    ". Whether the force depends on it cannot be judged there.");
  }
}

void add_repetition_notes(report::DiagnosisReport& report) {
  for (const report::InterfaceGap& gap : report.where) {
    if (!was_recorded_again(gap) || gap.repeatability->nrmse <= tuning::kModelAllowance) continue;
    report.notes.push_back("Recordings of the same test scatter by " + report::percent(gap.repeatability->nrmse) +
                           " of the output at the " + report::plain(gap.interface) +
                           ": a gap that is smaller is not judged there.");
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
      if (cause.is_cause && parameter.is_at_bound && !parameter.is_at_least) {
        diagnosis.report.notes.push_back(cause.effect + ": " + parameter.name +
                                         " is at the limit of its search range.");
      }
    }
  }
}

}  // namespace

Diagnosis diagnose(const SiteModel& model, std::span<const Recording> given, const DiagnoseSettings& settings) {
  const std::vector<ChannelFinding> findings = check_channels(model, given, settings.dof);
  std::vector<Recording> altered;
  std::span<const Recording> recordings = usable_part(given, settings.dof, findings, altered);
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
  recordings = without_mains_hum(recordings, settings.dof, altered, report.notes);
  const Workers workers{settings.threads};
  std::vector<Segment> segments =
      segments_in_role(model, recordings, RecordingRole::fit, settings.dof, workers,
                       [&](const Recording& recording, std::size_t position) {
                         return segments_to_search(model, recording, settings.dof, position, progress);
                       });
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
  IdentificationProblem problem = make_problem(model, segments, {}, workers);
  problem.progress = progress;
  progress.alive();
  std::vector<Stage> stages =
      judge_stages(model, segments, problem, settings.policy, progress.part(tuning::kPrepared, tuning::kSelected));
  std::vector<Judgement*> all_judgements;
  std::ranges::transform(stages, std::back_inserter(all_judgements), [](Stage& stage) { return &stage.judgement; });
  settle_corrections(all_judgements);
  // Smoothed as the fitted ones are.
  const bool is_smoothed = std::ranges::any_of(segments, &Segment::is_smoothed);
  const SiteModel completed = with_effects(model, causes_of(stages, {}));
  const SiteModel& smoothed_by = is_smoothed ? completed : model;
  std::vector<Segment> held_out =
      segments_in_role(model, recordings, RecordingRole::held_out, settings.dof, workers,
                       [&](const Recording& recording, std::size_t position) {
                         return modelled_segments(model, recording, settings.dof, position, smoothed_by, progress);
                       });
  tell_held_out_noise(completed, stages, held_out);
  const std::span<const Segment> judged = held_out.empty() ? segments : held_out;
  if (!held_out.empty() && traces.empty()) {
    drop_what_does_not_carry_over(model, held_out, settings.seed, settings.policy, stages, report.notes);
  }
  diagnosis.causes = causes_of(stages, traces);
  diagnosis.doubts = doubts_of(stages, traces);
  const FitOutcome all_causes = fit_of_all(problem, stages);
  settle_final_noise(problem, all_causes);
  if (!diagnosis.causes.empty()) {
    report.interface_shrink =
        shrink_on(model, diagnosis.causes, at_suspects(problem, judged), settings.seed, problem.segments);
    if (held_out.empty()) {
      report.notes.emplace_back(
          "No recording was held out: the gap that remains is measured on the fitted recordings.");
    }
  }
  GapParts parts;
  for (const Trace& trace : traces) parts.traced += trace.gap_share;
  std::vector<Judgement> judgements;
  std::vector<double> explained;
  for (const Stage& stage : stages) {
    const double before = parts.explained;
    add_gap(stage.problem, stage.selection, stage.judgement, parts);
    explained.push_back(parts.explained - before);
    judgements.push_back(stage.judgement);
  }
  report.verdict = verdict_with(traces, verdict_of(judgements), parts);
  for (std::size_t i = 0; i < stages.size(); ++i) {
    const double part = parts.explained > 0.0 ? explained[i] / parts.explained : 1.0;
    std::ranges::move(rank(stages[i], part), std::back_inserter(report.ranking));
  }
  put_causes_first(report.ranking);
  const bool leaves_a_part = std::ranges::any_of(judgements, &Judgement::leaves_a_part);
  settle_set(report, leaves_a_part);
  report.set_leaves_a_part = report.verdict == Verdict::set && leaves_a_part;
  report.is_pieced_together =
      report.verdict == Verdict::partial && std::ranges::any_of(judgements, &Judgement::is_pieced_together);
  report.corrections = corrections_of(stages);
  report.where = locate(problem, fit_nothing(problem, false), all_causes, settings.seed);
  add_traces(traces, parts, report.ranking);
  add_traces(traces, parts, report.where);
  for (report::InterfaceGap& gap : report.where) {
    if (!gap.is_at_fault) continue;
    for (const Stage& stage : stages) {
      if (!stage.concerns(gap.interface)) continue;
      if (stage.judgement.verdict != Verdict::none) {
        gap.verdict = stage.judgement.verdict;
      } else if (!stage.judgement.corrections.empty()) {
        gap.is_at_fault = gap.verdict.has_value();
        gap.is_corrected = !gap.is_at_fault;
      }
    }
  }
  const std::vector<Excitation> excitations = excitations_of(problem);
  leave_out_unexcited(excitations, report.where);
  add_repeatability(model, segments, report.where);
  add_recurrence(problem, all_causes, report.where);
  report.next_experiment = next_experiment(stages, report.where);
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
  add_input_notes(problem, recordings, report.notes);
  add_repetition_notes(report);
  add_notes(diagnosis, segments);
  add_findings(findings, report);
  add_findings(check_sampling(model, diagnosis.causes, recordings, settings.dof), report);
  return diagnosis;
}

}  // namespace hybridtest
