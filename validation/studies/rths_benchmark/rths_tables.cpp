#include "validation/studies/rths_benchmark/rths_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hybridtest::rths {
namespace {

std::string plant_name(int plant) { return plant == 0 ? "nominal" : std::to_string(plant); }

std::string run_columns(const std::vector<Candidate>& candidates, const StudyRun& run) {
  return fmt::format("{},{},{},{}", candidates[run.candidate].name, run.case_number, kMotionNames[run.motion],
                     plant_name(run.plant));
}

/// `nan` for either sign.
std::string number(double value, int digits) {
  return std::isnan(value) ? "nan" : fmt::format("{:.{}f}", value, digits);
}

std::string cell(double value, int digits) { return std::isnan(value) ? "–" : fmt::format("{:.{}f}", value, digits); }

std::string_view standing_name(Standing standing) {
  switch (standing) {
    case Standing::yardstick: return "yardstick";
    case Standing::published: return "published";
    case Standing::variant: return "variant";
    case Standing::ours: return "ours";
    case Standing::our_variant: return "ours, variant";
  }
  return "";
}

std::string targets_table(std::span<const CandidateMeans> means) {
  const std::vector<Target> targets = judge_ours(means);
  if (targets.empty()) return fmt::format("`{}` was not among the compensators of this study.\n", kOurs);
  std::string text = "| target | limit | found | |\n| --- | --- | --- | --- |\n";
  for (const Target& target : targets) {
    text += fmt::format("| {} | {} | {} | {} |\n", target.what, target.limit, target.found,
                        target.is_met ? "met" : "**MISSED**");
  }
  return text;
}

std::string means_table(std::span<const CandidateMeans> means) {
  std::string text =
      "| compensator | | lost | J1 [ms] mean / max | J2 | floor of J2 | J2 / floor | J2 / own floor | true J2 nominal "
      "| "
      "true J2 perturbed | J6 | J7 | J4 | peak force [N] |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
  for (const CandidateMeans& m : means) {
    const bool is_ours = m.standing == Standing::ours;
    const bool has_runs = m.lost < m.runs;
    text += fmt::format(
        "| {0}{1}{0} | {2} | {3} of {4} | {5} | {6} | {7} | {8} | {9} | {10} | {11} | {12} | {13} | {14} | {15} |\n",
        is_ours ? "**" : "", m.name, standing_name(m.standing), m.lost, m.runs,
        has_runs ? fmt::format("{:.2f} / {:.2f}", m.j1_ms, m.j1_ms_max) : "–", cell(m.j2, 3),
        cell(m.reference_floor, 3), cell(m.j2_over_floor, 4), cell(m.j2_over_own_floor, 4), cell(m.true_nominal, 3),
        cell(m.true_perturbed, 3), cell(m.j6, 3), cell(m.j7, 3), cell(m.j4, 2),
        m.peak_force_n > kHopelessShare * kForceLimitN ? "over" : cell(m.peak_force_n, 0));
  }
  return text;
}

std::string remarks(std::span<const CandidateMeans> means) {
  std::string text;
  for (const CandidateMeans& m : means) {
    if (!m.remark.empty()) text += fmt::format("- `{}`: {}\n", m.name, m.remark);
  }
  return text;
}

/// Ours beside every row that had more than its publication asks for, and beside our own variants.
std::string variants_list(std::span<const CandidateMeans> means) {
  const auto ours = std::ranges::find(means, kOurs, &CandidateMeans::name);
  if (ours == means.end()) return "";
  std::string text;
  for (const CandidateMeans& m : means) {
    const bool is_variant = m.standing == Standing::variant || m.standing == Standing::our_variant;
    if (!is_variant || m.lost > 0) continue;
    text += fmt::format(
        "- `{}`: J2 {:.3f} against our {:.3f}, over its own floor {:.4f} against {:.4f}; J6 {:.3f} against {:.3f}; J7 "
        "{:.3f} against {:.3f}\n",
        m.name, m.j2, ours->j2, m.j2_over_own_floor, ours->j2_over_own_floor, m.j6, ours->j6, m.j7, ours->j7);
  }
  return text;
}

/// J2 of the nominal plant, by case and motion, each with J2 of the displacement without noise.
std::string tracking_table(const BenchmarkInputs& inputs, std::span<const CandidateMeans> means,
                           std::span<const StudyRun> runs) {
  std::string head = "| compensator |";
  std::string rule = "| --- |";
  std::string floors = "| *floor of J2* |";
  std::string forces = "| *reference's peak force [N]* |";
  for (int case_number = 1; case_number <= kCases; ++case_number) {
    for (std::size_t motion = 0; motion < kMotions; ++motion) {
      const Reference& reference = inputs.reference(case_number, motion);
      head += fmt::format(" {} {} |", case_number, kMotionNames[motion]);
      rule += " --- |";
      floors += fmt::format(" *{:.2f}* |", reference.noise_floor_percent);
      forces += fmt::format(" *{:.0f}*{} |", reference.peak_force_n, reference.is_near_force_limit() ? " (!)" : "");
    }
  }
  std::string text = head + "\n" + rule + "\n" + floors + "\n";
  std::size_t listed = means.size();
  for (const StudyRun& run : runs) {
    if (run.plant != 0) continue;
    if (run.candidate != listed)
      text += fmt::format("{}| {} |", listed == means.size() ? "" : "\n", means[run.candidate].name);
    listed = run.candidate;
    text += run.is_lost()
                ? " lost |"
                : fmt::format(" {:.2f} ({:.2f}) |", run.result.criteria.j(2), run.result.true_tracking_percent);
  }
  return text + "\n" + forces + "\n";
}

}  // namespace

std::string criteria_csv(const std::vector<Candidate>& candidates, std::span<const StudyRun> runs) {
  std::string text = "compensator,case,motion,plant,J1,J2,J3,J4,J5,J6,J7,J8,J9,peak_force_n\n";
  for (const StudyRun& run : runs) {
    text += run_columns(candidates, run);
    for (const double value : run.result.criteria.values) text += ',' + number(value, 4);
    text += fmt::format(",{:.1f}\n", run.result.peak_force_n);
  }
  return text;
}

std::string tracking_csv(const BenchmarkInputs& inputs, const std::vector<Candidate>& candidates,
                         std::span<const StudyRun> runs) {
  std::string text =
      "compensator,case,motion,plant,J2,J2_floor_reference,J2_floor_run,J2_without_noise,delay_without_noise_ms,"
      "peak_force_n,reference_peak_force_n,ending\n";
  for (const StudyRun& run : runs) {
    const Reference& reference = inputs.reference(run.case_number, run.motion);
    const char* ending = !run.result.is_complete             ? "out_of_control"
                         : !run.result.reaches_force_limit() ? "complete"
                         : run.is_excused                    ? "reference_at_limit"
                                                             : "force_limit";
    text +=
        fmt::format("{},{},{:.4f},{},{},{},{:.1f},{:.1f},{}\n", run_columns(candidates, run),
                    number(run.result.criteria.j(2), 4), reference.noise_floor_percent,
                    number(run.result.noise_floor_percent, 4), number(run.result.true_tracking_percent, 4),
                    number(1e3 * run.result.true_delay_s, 4), run.result.peak_force_n, reference.peak_force_n, ending);
  }
  return text;
}

std::string summary_markdown(const BenchmarkInputs& inputs, const HarnessCheck& check,
                             const std::vector<Candidate>& candidates, std::span<const StudyRun> runs,
                             const StudySettings& settings) {
  const std::vector<CandidateMeans> means = means_of(inputs, candidates, runs);
  return fmt::format(
      "# Delay compensation on the virtual RTHS benchmark\n\n"
      "{0} runs of each compensator: cases 1 to 4, {1} motions, the nominal and {2} perturbed plants, sensor noise, "
      "seed "
      "{3}. Percent unless it says otherwise.\n\n"
      "## The harness\n\nThe released controller on the nominal plant without sensor noise, against published "
      "values:\n\n"
      "{4}\n"
      "## Ours against its targets\n\n{5}\n"
      "## Means\n\n{6}\n"
      "- Lost: the actuator's force over {7:.0f} N where the reference structure's own stays below {8:.0f} N, or over "
      "{9:.0f} N anywhere, where the run ends. Lost runs are left out of the means.\n"
      "- Floor of J2: sensor noise over the deviation of x_1 in the reference. Own floor: the same with the run's "
      "x_n1. "
      "True J2: of the displacement without sensor noise.\n"
      "- `+pi`: the benchmark's proportional-integral loop, without its lead, stands between compensator and plant. "
      "That "
      "makes the plant's {10:.1f} ms (3.5 Hz) {11:.1f} ms. Methods that extrapolate over a pure delay are lost without "
      "it: "
      "over {10:.1f} ms the third mode turns by more than three quarters of a circle.\n"
      "- Published: with the ranges, rates and starting values of the publication. The authors of the adaptive time "
      "series start it at 1, delay, delay^2/2 or at what a test before the test has found; the former, which needs a "
      "delay alone, counts as published here, the latter (`_model_start`, the inverse of the identified plant) as a "
      "variant.\n"
      "- J2 alone does not rank methods below a tracking error of about 1 %. A loop that is left with its sample of "
      "force "
      "delay has negative damping: x_n1, by which J2 is divided, grows by a percent or so, and J2 falls with its floor "
      "while "
      "J6 and J7 rise. So a smaller J2 than that of a perfect test, {12:.3f} in the mean, is a defect; J2 over its own "
      "floor "
      "and true J2 tell tracking, J6 and J7 tell the test.\n"
      "{13}\n"
      "## Beside variants\n\nWhat had more than its publication asks for, and ours with other settings. Where J2 is "
      "below ours, the last point above says why: J6 and J7 of the same row are larger.\n\n{15}\n"
      "## J2 by case and motion, nominal plant\n\nIn brackets J2 of the displacement without sensor noise. (!): the "
      "reference itself comes to within 5 % of the force limit.\n\n{14}",
      runs.size() / std::max<std::size_t>(1, candidates.size()), kMotions, settings.plants, settings.seed,
      to_markdown(check), targets_table(means), means_table(means), kForceLimitN, kExcusedShare * kForceLimitN,
      kHopelessShare * kForceLimitN, 1e3 * nominal_delay_s(Arrangement::straight),
      1e3 * nominal_delay_s(Arrangement::with_pi),
      [&] {
        double sum = 0.0;
        for (int c = 1; c <= kCases; ++c) {
          for (std::size_t m = 0; m < kMotions; ++m) sum += inputs.reference(c, m).noise_floor_percent;
        }
        return sum / (kCases * kMotions);
      }(),
      remarks(means), tracking_table(inputs, means, runs), variants_list(means));
}

}  // namespace hybridtest::rths
