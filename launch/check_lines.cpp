#include "launch/check_lines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "coordinator/preflight/integrator_response.hpp"
#include "core/config_error.hpp"
#include "core/exit_code.hpp"
#include "core/opensees_program.hpp"
#include "launch/check_policy.hpp"
#include "launch/excitation_text.hpp"
#include "launch/predicted_peaks.hpp"
#include "mechanics/structure/damping.hpp"
#include "scenario/site_answer.hpp"

namespace hybridtest {
namespace {

constexpr CheckPolicy kPolicy{};

/// What the lines of one scenario are from.
struct Judged {
  const Scenario& scenario;
  const VibrationModes& modes;
  const TestStability& stability;
  Eigen::VectorXd damping_ratio;
  CheckReport& report;
};

double hertz(double rad_per_s) { return rad_per_s / (2.0 * std::numbers::pi); }

CheckVerdict caution_if(bool is_caution) { return is_caution ? CheckVerdict::caution : CheckVerdict::pass; }

std::string written(const Eigen::MatrixXd& matrix) {
  std::string text;
  for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
    std::string entries;
    for (const double entry : matrix.row(row)) entries += fmt::format("{}{:.6g}", entries.empty() ? "" : ", ", entry);
    text += fmt::format("{}[{}]", row == 0 ? "" : ", ", entries);
  }
  return "[" + text + "]";
}

void judge_ground_motions(const Scenario& scenario, CheckReport& report) {
  report.begin("excitation");
  for (const GroundRecord& record : scenario.excitation.records) {
    const std::string warning = ground_motion_warning(record.facts);
    report.add(caution_if(!warning.empty()), "record", record.text + ": " + ground_motion_text(record.facts), warning);
  }
}

/// A delay takes share * w * tau / 2 of the damping ratio of a mode (Horiuchi et al., 1999: -k tau / (2 m w)).
double added_by_delays(const Judged& judged, Eigen::Index mode) {
  double added = 0.0;
  for (const SiteStability& site : judged.stability.sites) {
    const double share = site.stiffness_share[mode];
    if (!std::isfinite(share)) continue;
    added -=
        0.5 * share * judged.modes.frequency_rad_per_s[mode] * site.delay.remaining_s / judged.scenario.time.time_scale;
  }
  return added;
}

bool counts(const Judged& judged, Eigen::Index mode) {
  const double whole_kg =
      judged.scenario.structure.influence.dot(judged.scenario.structure.mass_kg * judged.scenario.structure.influence);
  return judged.modes.effective_mass_kg[mode] > kPolicy.mass_share * whole_kg;
}

/// One line per mode: the mode, the integrator at this step, and the delays that remain.
void judge_mode(Judged& judged, Eigen::Index mode) {
  const IntegratorReading& integrator = judged.scenario.integrator;
  const double omega = judged.modes.frequency_rad_per_s[mode];
  const double ratio = judged.damping_ratio[mode];
  std::string found = fmt::format("{:.4g} Hz, {:.4g} s, {:.2f} % damping, {:.4g} kg", hertz(omega),
                                  judged.modes.period_s(mode), 100.0 * ratio, judged.modes.effective_mass_kg[mode]);
  const std::string subject = fmt::format("mode {}", mode + 1);
  if (omega * judged.scenario.integrator_step_s < 1e-6) {
    judged.report.add(CheckVerdict::caution, subject, found + "; nothing holds this motion",
                      "add the stiffness that holds it, or take it for what it is: the structure drifts");
    return;
  }
  const NumericalMode numerical =
      numerical_mode(integrator.make, integrator.needs.commands_per_step, omega * judged.scenario.integrator_step_s);
  const double added = added_by_delays(judged, mode);
  found += fmt::format("; integrator: period {:+.3f} %, damping {:+.3f} %; delays: damping {:+.3f} %",
                       100.0 * numerical.period_error, 100.0 * numerical.damping_ratio, 100.0 * added);
  std::string change;
  if (counts(judged, mode)) {
    if (std::abs(numerical.period_error) > kPolicy.period_error) change = "shorten step_s: the period is not its own";
    if (std::abs(numerical.damping_ratio) > kPolicy.numerical_damping * ratio &&
        std::abs(numerical.damping_ratio) > 1e-4)
      change = "shorten step_s, or take less numerical damping (rho_inf nearer 1, alpha nearer 0)";
    if (std::abs(added) > kPolicy.delay_use * ratio && added != 0.0)
      change = "compensate more of the delay that remains at the sites";
  }
  judged.report.add(caution_if(!change.empty()), subject, found, change);
}

void judge_modes(Judged& judged) {
  judged.report.begin("modes");
  for (Eigen::Index mode = 0; mode < judged.modes.count(); ++mode) judge_mode(judged, mode);
  const Eigen::Index others = judged.scenario.structure.size() - judged.modes.count();
  if (others == 0) return;
  judged.report.add(
      CheckVerdict::pass, "and the others",
      fmt::format("{} more, up to at most {:.4g} Hz; {} coordinates of the interfaces stand for them", others,
                  hertz(judged.modes.highest_frequency_rad_per_s()), judged.stability.residual_coordinates));
}

void judge_step(Judged& judged) {
  const Scenario& scenario = judged.scenario;
  const double step_s = scenario.integrator_step_s;
  judged.report.begin("integrator " + scenario.integrator.text);
  if (!scenario.integrator.needs.initial_stiffness) {
    const double use = step_s / judged.stability.step.step_s_max;
    const CheckVerdict verdict = use > 1.0 ? CheckVerdict::fail : caution_if(use > kPolicy.step_use);
    judged.report.add(
        verdict, "step",
        fmt::format("{:.6g} s, stable up to {:.6g} s ({:.1f} % used)", step_s, judged.stability.step.step_s_max,
                    100.0 * use),
        verdict == CheckVerdict::pass ? "" : "shorten step_s, or take an integrator without a limit (cr)");
    return;
  }
  std::string found = fmt::format("{:.6g} s, stable with any while no stiffness exceeds the initial one", step_s);
  if (judged.stability.has_modes_beyond_step) {
    found += fmt::format("; modes above {:.4g} Hz are faster than the step can show, it slows them down",
                         1.0 / (std::numbers::pi * step_s));
  }
  judged.report.add(CheckVerdict::pass, "step", found);
}

void judge_coupled_test(Judged& judged) {
  const TestStability& stability = judged.stability;
  if (stability.sites.empty()) return;
  judged.report.begin("coupled test");
  if (stability.grows) {
    judged.report.add(CheckVerdict::fail, "stability",
                      "UNSTABLE: with all sites as they are, a motion grows until an interlock ends the test",
                      "compensate the delay of each site to within its margin, correct initial stiffnesses, or shorten "
                      "step_s");
    return;
  }
  std::string found = "stable with all sites as they are";
  if (stability.sites.size() > 1) {
    found += std::isfinite(stability.further.delay_s)
                 ? fmt::format("; all of them at once may be {:.3f} ms later", 1e3 * stability.further.delay_s)
                 : "; all of them at once may be later by any time";
  }
  judged.report.add(CheckVerdict::pass, "stability", found);
}

void judge_stiffness(Judged& judged, const SiteStability& site) {
  std::string found;
  for (const double share : site.stiffness_share) found += fmt::format("{:.1f} % ", 100.0 * share);
  found += fmt::format("of modes 1 to {}", site.stiffness_share.size());
  judged.report.add(CheckVerdict::pass, "stiffness share", found);
  if (site.stiffness_error <= kStiffnessTolerance) return;
  judged.report.add(
      site.stiffness_error > kStiffnessErrorMax ? CheckVerdict::fail : CheckVerdict::caution, "initial stiffness",
      fmt::format("initial_stiffness_n_per_m is {}, but the simulated specimen has {} N/m from rest",
                  written(site.site->initial_stiffness_n_per_m), written(site.specimen_stiffness_n_per_m)),
      "correct the scenario: damping, energy error and the stability limit of the step come from its number");
}

/// @param use   of the critical delay by what remains.
void add_delay(CheckReport& report, const SubstructureScenario& site, const ForceDelay& delay, double use) {
  const double command_s = delay.transfer_s - delay.after_command_s;
  const double force_s = delay.after_command_s - delay.remaining_s;
  if (site.site.rig_is_elsewhere && delay.transfer_s == 0.0) {
    report.add(CheckVerdict::caution, "delay of the rig", "not known: counts as none",
               "measure it and give rig.transfer_delay_s; the figures below are those of a rig in time");
  }
  report.add(
      caution_if(use > kPolicy.delay_use), "delay",
      fmt::format(
          "{:.3f} ms of the transfer system at low frequency, {:.3f} ms compensated by the command, {:.3f} ms by "
          "the force, {:.3f} ms remain",
          1e3 * delay.transfer_s, 1e3 * command_s, 1e3 * force_s, 1e3 * delay.remaining_s),
      use > kPolicy.delay_use ? fmt::format("set delay_s of its compensator nearer to {:.4g} s", delay.transfer_s)
                              : "");
}

void judge_delay(Judged& judged, const SiteStability& site) {
  const ForceDelay& delay = site.delay;
  const bool is_finite = std::isfinite(site.critical.delay_s);
  judged.report.add(CheckVerdict::pass, "critical delay",
                    is_finite ? fmt::format("{:.3f} ms, at {:.2f} Hz, without compensators",
                                            1e3 * site.critical.delay_s, hertz(site.critical.frequency_rad_per_s))
                              : "none: stable at any delay");
  add_delay(judged.report, *site.site, delay,
            is_finite && site.critical.delay_s > 0.0 ? std::abs(delay.remaining_s) / site.critical.delay_s : 0.0);
}

void judge_margin(Judged& judged, const SiteStability& site) {
  const double margin_s = site.margin_s();
  if (site.grows) {
    const bool is_late = margin_s < 0.0;
    judged.report.add(
        site.is_unstable() ? CheckVerdict::fail : CheckVerdict::caution, "delay margin",
        is_late ? fmt::format("{:.3f} ms   UNSTABLE{}", 1e3 * margin_s,
                              site.delay.is_learnt ? " at the start; the delay is learnt during the test"
                                                   : ": the motion will grow until an interlock ends the test")
                : fmt::format("none   UNSTABLE without a delay that remains: the compensators amplify fast motion"),
        is_late ? fmt::format("compensate the delay: compensator {{type: polynomial_displacement, delay_s: {:.4g}}}",
                              site.delay.transfer_s)
                : "take a lower order or a wider point_spacing_s of the compensator");
    return;
  }
  const bool is_finite = std::isfinite(margin_s);
  const bool is_small = is_finite && margin_s < (1.0 - kPolicy.delay_use) * site.critical.delay_s;
  judged.report.add(caution_if(is_small), "delay margin",
                    is_finite ? fmt::format("{:.3f} ms, then a motion of {:.2f} Hz grows", 1e3 * margin_s,
                                            hertz(site.further.frequency_rad_per_s))
                              : "any: stable however late the site is",
                    is_small ? "compensate more of the delay, take a lower order of the compensator, or make the "
                               "structure's damping what it is"
                             : "");
}

void judge_estimate(Judged& judged, const SiteStability& site) {
  if (!site.grows_at_smallest_estimate) return;
  const bool grows = *site.grows_at_smallest_estimate || *site.grows_at_largest_estimate;
  const auto text = [](bool at_bound) { return at_bound ? "UNSTABLE" : "stable"; };
  judged.report.add(caution_if(grows), "estimated delay",
                    fmt::format("with the estimate at delay_s_min {}, at delay_s_max {}",
                                text(*site.grows_at_smallest_estimate), text(*site.grows_at_largest_estimate)),
                    grows ? "bring the bounds of the estimator nearer to the delay of the transfer system" : "");
}

void judge_noise(Judged& judged, const SiteStability& site) {
  const SiteScenario& sensors = site.site->site;
  const NoiseGains gains = noise_gains(judged.scenario, *site.site);
  const double largest = std::max({gains.command_by_target, gains.command_by_measured, gains.force_by_force});
  judged.report.add(
      caution_if(largest > kPolicy.noise_gain), "compensator noise",
      fmt::format("white noise grows by {:.2f} from target to command, {:.2f} from measured displacement to "
                  "command, {:.2f} from measured to compensated force",
                  gains.command_by_target, gains.command_by_measured, gains.force_by_force),
      largest > kPolicy.noise_gain ? "take a lower order or a wider point_spacing_s" : "");
  if (judged.stability.grows) return;
  const double per_n = site.command_noise_m_per_n * gains.force_by_force;
  const double stiffness = site.site->initial_stiffness_n_per_m.cwiseAbs().maxCoeff();
  const double command_m = per_n * sensors.force_noise_n;
  const bool is_loud = command_m > kPolicy.noise_use * sensors.loop.limits.displacement_m;
  judged.report.add(
      caution_if(is_loud), "noise in the loop",
      fmt::format("1 N of force noise moves the command by {:.3g} mm, {:.3g} of its static deflection{}; 1 mm of "
                  "displacement noise by {:.3g} mm",
                  1e3 * per_n, per_n * stiffness,
                  sensors.force_noise_n > 0.0
                      ? fmt::format("; {:.4g} N of the sensor by {:.3g} mm", sensors.force_noise_n, 1e3 * command_m)
                      : "",
                  gains.command_by_measured),
      is_loud ? "take a load cell with less noise or a smaller range" : "");
}

std::string use_of_rating(double limit, double rating) {
  return std::isfinite(rating) ? fmt::format("{:.0f} % of the rig's {:.4g}", 100.0 * limit / rating, rating)
                               : "the rig's rating is not known";
}

/// Limits inside what the rig can do; and what is not checked.
void judge_limits(CheckReport& report, const SiteScenario& known) {
  const SiteLimits& limits = known.loop.limits;
  const bool exceeds = limits.displacement_m > known.rating.displacement_m ||
                       limits.velocity_m_per_s > known.rating.velocity_m_per_s || limits.force_n > known.rating.force_n;
  report.add(caution_if(exceeds), "limits",
             fmt::format("{:.4g} m ({}), {:.4g} m/s ({}), {:.4g} N ({})", limits.displacement_m,
                         use_of_rating(limits.displacement_m, known.rating.displacement_m), limits.velocity_m_per_s,
                         use_of_rating(limits.velocity_m_per_s, known.rating.velocity_m_per_s), limits.force_n,
                         use_of_rating(limits.force_n, known.rating.force_n)),
             exceeds ? "bring the limits inside the rating: beyond it the rig does not follow" : "");
  report.add(caution_if(!limits.tracking_error_m), "tracking error",
             limits.tracking_error_m ? fmt::format("at most {:.4g} mm", 1e3 * *limits.tracking_error_m) : "not checked",
             limits.tracking_error_m ? "" : "give limits.tracking_error_m");
  report.add(caution_if(!limits.stuck_samples), "stuck sensors",
             limits.stuck_samples
                 ? fmt::format("{} equal readings of {} after {:.4g} mm of motion", *limits.stuck_samples,
                               limits.stuck_judges_force ? "displacement or force" : "displacement",
                               1e3 * limits.stuck_while_moving_m)
                 : "not checked",
             limits.stuck_samples ? "" : "give interlocks.stuck_sensor");
}

void begin_site(CheckReport& report, const Scenario& scenario, const SubstructureScenario& site) {
  const SiteScenario& known = site.site;
  report.begin("site " + site.id);
  report.add(
      CheckVerdict::pass, "control rate",
      fmt::format("{} rig, {:.6g} Hz requested, {:.6g} Hz used ({} per step)", known.rig_type, known.control_rate_hz,
                  known.periods_per_step / (scenario.time.step_s * scenario.time.time_scale), known.periods_per_step));
}

void judge_site(Judged& judged, const SiteStability& site) {
  begin_site(judged.report, judged.scenario, *site.site);
  judge_stiffness(judged, site);
  judge_delay(judged, site);
  judge_margin(judged, site);
  judge_estimate(judged, site);
  judge_noise(judged, site);
  judge_limits(judged.report, site.site->site);
}

void print(const CheckReport& report, std::FILE* out) {
  if (out == nullptr || report.lines().empty()) return;
  fmt::print(out, "\n{}\n", report.lines().back().section);
  report.print_section(out);
}

/// One line of a peak: over its limit it fails, as the interlock would end the test.
void judge_peak(CheckReport& report, const std::string& subject, double peak, double limit, double rating,
                const std::string& unit) {
  const double use = peak / std::min(limit, rating);
  const CheckVerdict verdict = use > 1.0 ? CheckVerdict::fail : caution_if(use > kPolicy.peak_use);
  std::string found =
      fmt::format("{:.4g} {}, {:.0f} % of the limit of {:.4g} {}", peak, unit, 100.0 * peak / limit, limit, unit);
  if (std::isfinite(rating))
    found += fmt::format(", {:.0f} % of the rig's {:.4g} {}", 100.0 * peak / rating, rating, unit);
  report.add(verdict, subject, found,
             verdict == CheckVerdict::pass
                 ? ""
                 : "scale the excitation down (excitation.scale), test slower (time_scale), or take a larger rig");
}

void judge_lead(const OpenSeesLeadScenario& lead, CheckReport& report) {
  report.begin("OpenSees leads");
  if (lead.script.empty()) {
    report.add(CheckVerdict::pass, "start", "by hand; its elements connect from " + lead.client_address);
  } else {
    try {
      report.add(CheckVerdict::pass, "start", find_opensees(lead.program).string() + " " + lead.script.string());
    } catch (const ConfigError& error) {
      report.add(CheckVerdict::fail, "start", error.what(), "install OpenSees, or give coordinator.program");
    }
  }
  for (const LedElementScenario& element : lead.elements) {
    std::string dofs;
    for (const std::string& dof : element.dofs) dofs += (dofs.empty() ? "" : ", ") + dof;
    report.add(CheckVerdict::pass, "element",
               fmt::format("port {} of {}: {} ({})", element.port, lead.listen_address, element.substructure, dofs));
  }
  report.add(CheckVerdict::caution, "critical delay", "not known: mass and damping are in the model of OpenSees",
             "keep what remains of each site's delay well below 2 x damping ratio / (angular frequency x stiffness "
             "share of the site), in each mode");
}

/// In words; empty for a stable test.
std::string instability(const Scenario& scenario) try {
  const TestStability stability =
      test_stability(scenario, vibration_modes(scenario.structure), StabilityFigures::verdict);
  if (!stability.is_unstable(scenario.integrator_step_s)) return {};
  std::string who;
  for (const SiteStability& site : stability.sites) {
    if (site.is_unstable()) who += (who.empty() ? "" : ", ") + site.site->id;
  }
  if (who.empty()) who = "all sites together";
  return "the coupled test is UNSTABLE (" + who + "): a motion will grow until an interlock ends it";
} catch (const ConfigError& error) {  // of the specimens in place of the stiffness that is given for them
  return error.what();
}

/// Without a delay given, that of a rig elsewhere is not known, and the figures are not its own.
bool has_known_rig_elsewhere(const Scenario& scenario) {
  return std::ranges::any_of(scenario.substructures, [](const SubstructureScenario& each) {
    return each.site.rig_is_elsewhere &&
           std::ranges::any_of(each.site.delays, [](const ForceDelay& delay) { return delay.transfer_s > 0.0; });
  });
}

}  // namespace

TestStability check_stability(const Scenario& scenario, CheckReport& report, std::FILE* out) {
  const VibrationModes modes = vibration_modes(scenario.structure);
  if (out != nullptr) fmt::print(out, "{}", excitation_text(scenario, modes));
  judge_ground_motions(scenario, report);
  if (!scenario.excitation.records.empty()) print(report, out);
  TestStability stability = test_stability(scenario, modes);
  Judged judged{scenario, modes, stability, damping_ratios(scenario.structure, modes), report};
  judge_modes(judged);
  print(report, out);
  judge_step(judged);
  print(report, out);
  judge_coupled_test(judged);
  if (!stability.sites.empty()) print(report, out);
  for (const SiteStability& site : stability.sites) {
    judge_site(judged, site);
    print(report, out);
  }
  return stability;
}

void check_led_test(const Scenario& scenario, CheckReport& report, std::FILE* out) {
  judge_lead(*scenario.opensees, report);
  print(report, out);
  for (const SubstructureScenario& site : scenario.substructures) {
    if (site.role != Role::experimental_site) continue;
    begin_site(report, scenario, site);
    for (const ForceDelay& delay : site.site.delays) add_delay(report, site, delay, 0.0);
    judge_limits(report, site.site);
    print(report, out);
  }
}

void check_peaks(const Scenario& scenario, CheckReport& report, std::FILE* out) {
  const PredictedTest test = predicted_test(scenario);
  report.begin("predicted test");
  if (test.reason == StopReason::completed) {
    report.add(CheckVerdict::pass, "end", "simulated to its end");
  } else {
    std::string found = fmt::format("{} after {:.4g} s of model time", test_end(test.reason).verdict, test.end_s);
    for (const std::string& fault : test.faults) found += "; " + fault;
    report.add(CheckVerdict::fail, "end", found, "see the lines above and the peaks below for the cause");
  }
  for (const SitePeaks& site : test.sites) {
    const SiteLimits& limits = site.site->site.loop.limits;
    const RigRating& rating = site.site->site.rating;
    report.add(CheckVerdict::pass, site.site->id, "by " + site.rig);
    judge_peak(report, "  displacement", site.displacement_m, limits.displacement_m, rating.displacement_m, "m");
    judge_peak(report, "  velocity", site.velocity_m_per_s, limits.velocity_m_per_s, rating.velocity_m_per_s, "m/s");
    judge_peak(report, "  force", site.force_n, limits.force_n, rating.force_n, "N");
  }
  print(report, out);
}

void require_stable_test(const Scenario& scenario, bool even_if_unstable) {
  if (scenario.opensees) return;  // the structure is not known here
  if (scenario.substructures.size() > kMaxSubstructures) {
    // The loop of each site is closed around all others: as many problems as sites, each of the size of all.
    fmt::print(stderr,
               "the stability is not judged: more than {} substructures; `hybridtest check` does, which takes long\n",
               kMaxSubstructures);
    return;
  }
  const std::string found = instability(scenario);
  if (found.empty()) return;
  if (!even_if_unstable && has_known_rig_elsewhere(scenario)) {
    throw ConfigError{scenario.file.string() + ": " + found + ". `hybridtest check " + scenario.file.string() +
                      "` says what to change; --even-if-unstable runs it all the same"};
  }
  fmt::print(stderr, "warning: {}; `hybridtest check` says what to change\n", found);
}

void say_nominal_inputs(const Scenario& scenario) {
  for (const SubstructureScenario& each : scenario.substructures) {
    for (const std::string& input : each.site.nominal_inputs) {
      fmt::print(stderr, "note: {}: a simulated rig records no inputs: {}, its nominal_input\n", each.id, input);
    }
  }
}

}  // namespace hybridtest
