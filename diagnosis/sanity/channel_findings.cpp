#include "diagnosis/sanity/channel_findings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "core/parameters/unit_of.hpp"
#include "diagnosis/identification/segment.hpp"
#include "diagnosis/localisation/gap_shares.hpp"
#include "diagnosis/page/wording.hpp"
#include "diagnosis/sanity/relation.hpp"
#include "diagnosis/signals/signals.hpp"
#include "diagnosis/tuning.hpp"

namespace hybridtest {

namespace {

/// A channel, and the motion that it should follow.
struct Followed {
  Channel in{};
  Channel out{};
  std::span<const double> motion_m;
  std::span<const double> values;
  std::span<const double> predicted;  // of `values`; empty where the model predicts nothing
  std::span<const Motion> motion;     // of `motion_m`, with derivatives; may be empty
  double period_s = 0.0;
  bool is_quasi_static = false;

  [[nodiscard]] bool is_force() const noexcept { return out == Channel::measured_force; }
  [[nodiscard]] std::string unit() const { return unit_of(column_name(out)); }
};

/// What was found, in words.
struct Words {
  std::string what;
  std::string what_to_do;
};

double spread_of(std::span<const double> values) { return std::sqrt(variance(values)); }

/// Means over neighbours, so that the rate is at most that of the fits.
std::vector<double> averaged(std::span<const double> values, std::size_t count) {
  std::vector<double> means;
  for (std::size_t i = 0; i + count <= values.size(); i += count) {
    double sum = 0.0;
    for (std::size_t k = 0; k < count; ++k) sum += values[i + k];
    means.push_back(sum / static_cast<double>(count));
  }
  return means;
}

std::size_t averaged_samples(double period_s) {
  return std::max<std::size_t>(1, static_cast<std::size_t>(1.0 / (tuning::kFitRate_hz * period_s)));
}

/// The motion is more than noise.
bool moves(const Followed& pair) {
  const double size = spread_of(pair.motion_m);
  const bool is_measured = pair.in == Channel::measured_displacement && !pair.is_quasi_static;
  return size > 0.0 && (!is_measured || size >= tuning::kExcitedOverNoise * white_noise_level(pair.motion_m));
}

struct Run {
  std::size_t begin = 0;
  std::size_t count = 0;
};

Run longest_run(std::span<const double> values) {
  Run best;
  Run run{0, 1};
  for (std::size_t i = 1; i <= values.size(); ++i) {
    if (i < values.size() && values[i] == values[run.begin]) {
      ++run.count;
      continue;
    }
    if (run.count > best.count) best = run;
    run = {i, 1};
  }
  return best;
}

/// A reading that stays to the last digit while the motion goes to and fro over half its range, and changes from sample
/// to sample elsewhere.
std::optional<Words> frozen(const Followed& pair) {
  const Run run = longest_run(pair.values);
  if (run.count == pair.values.size()) {
    return Words{"never changes", "Check that it is connected and switched on, and record again."};
  }
  const auto motion_m = pair.motion_m.subspan(run.begin, run.count);
  if (reversals_of(motion_m, tuning::kMainShare * span_of(pair.motion_m)).size() < 2) return {};
  std::size_t repeated = 0;
  for (std::size_t i = 1; i < pair.values.size(); ++i) {
    const bool is_inside = i > run.begin && i < run.begin + run.count;
    if (!is_inside && pair.values[i] == pair.values[i - 1]) ++repeated;
  }
  if (2 * repeated > pair.values.size() - run.count) return {};
  return Words{fmt::format("stands still at {} for {} samples from sample {} on, while the motion goes on",
                           report::quantity(pair.values[run.begin], pair.unit()), run.count, run.begin + 1),
               "Export the part of the recording without this stretch, and check cable and amplifier."};
}

/// A reading that is nothing but noise to the end from some sample on, hum or not, while the motion goes to and fro
/// over half its range as before.
std::optional<Words> died(const Followed& pair) {
  const std::size_t stretch = pair.values.size() / tuning::kTimeWindows;
  if (stretch < tuning::kSamplesMin) return {};
  const auto last = pair.values.last(stretch);
  const double noise = spread_of(last);
  if (noise > tuning::kExcitedOverNoise * white_noise_level(last)) return {};
  std::size_t begin = pair.values.size() - stretch;
  while (begin >= stretch && spread_of(pair.values.subspan(begin - stretch, stretch)) <= tuning::kNearFloor * noise) {
    begin -= stretch;
  }
  if (begin < stretch || spread_of(pair.values.first(begin)) < tuning::kWellExcitedOverNoise * noise) return {};
  const auto motion_m = pair.motion_m.subspan(begin);
  if (reversals_of(motion_m, tuning::kMainShare * span_of(pair.motion_m)).size() < 2) return {};
  const std::string at = pair.is_quasi_static
                             ? std::string{}
                             : fmt::format(" ({})", report::quantity(static_cast<double>(begin) * pair.period_s, "s"));
  return Words{fmt::format("is nothing but noise of {} from about sample {}{} on, while the motion goes on",
                           report::quantity(noise, pair.unit()), begin + 1, at),
               "Check cable and specimen: the sensor came off, or the specimen broke. Export the part before."};
}

/// Single readings that hold most of a channel's energy about its median, as a bad contact makes them, or a number that
/// stands for a missing value: at most the square root of all, and no more in a row than a blow has at least.
struct WildReadings {
  std::size_t count = 0;
  double largest = 0.0;
  double over_others = 0.0;  // distance from the median over that of the farthest of the others
};

std::optional<WildReadings> wild_readings(std::span<const double> values) {
  if (values.empty()) return {};
  const double median = upper_median({values.begin(), values.end()});
  std::vector<double> distances(values.size());
  std::ranges::transform(values, distances.begin(), [&](double value) { return std::abs(value - median); });
  const double most_energy =
      tuning::kMainShare * std::inner_product(distances.begin(), distances.end(), distances.begin(), 0.0);
  const auto few = static_cast<std::size_t>(std::sqrt(static_cast<double>(values.size())));
  std::vector<double> sorted = distances;
  std::ranges::sort(sorted, std::greater{});
  std::size_t count = 0;
  double held = 0.0;
  for (; count < few && held <= most_energy; ++count) held += sorted[count] * sorted[count];
  if (held <= most_energy) return {};
  const double beyond = tuning::kMainShare * sorted[count - 1];
  while (count < sorted.size() && sorted[count] > beyond) ++count;
  if (count > few || count == sorted.size() || sorted[count] == 0.0) return {};
  WildReadings wild{.count = count, .over_others = sorted.front() / sorted[count]};
  std::size_t in_a_row = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    in_a_row = distances[i] > beyond ? in_a_row + 1 : 0;
    if (in_a_row > tuning::kClippedRun) return {};
    if (distances[i] == sorted.front()) wild.largest = values[i];
  }
  return wild;
}

std::optional<Words> words_of(const std::optional<WildReadings>& wild, std::string_view unit) {
  if (!wild) return {};
  // As it stands in the file, so that a number like -9999 is recognised.
  const std::string readings = wild->count == 1 ? "a reading of" : fmt::format("{} readings of up to", wild->count);
  return Words{fmt::format("has {} {:.4g} {}, {:.0f} times as far out as all others", readings, wild->largest, unit,
                           wild->over_others),
               "Put the mean of their neighbours in their place, and check connector and cable."};
}

/// Where a signal was lost for some samples, its reading is exactly zero between two on the same side that are far from
/// it: either step is larger than a real signal's largest, by what noise may add. Nothing with fewer than two places.
std::optional<Words> dropouts(std::span<const double> values, std::string_view unit) {
  double largest_step = 0.0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    if (values[i] == 0.0 || values[i - 1] == 0.0) continue;
    largest_step = std::max(largest_step, std::abs(values[i] - values[i - 1]));
  }
  const double far = tuning::kNearFloor * largest_step;
  std::size_t places = 0;
  std::size_t lost = 0;
  for (std::size_t begin = 1; begin < values.size(); ++begin) {
    if (values[begin] != 0.0 || values[begin - 1] == 0.0) continue;
    std::size_t end = begin;
    while (end < values.size() && values[end] == 0.0) ++end;
    if (end == values.size()) break;
    const double before = values[begin - 1];
    const double after = values[end];
    if (before * after > 0.0 && std::min(std::abs(before), std::abs(after)) > far) {
      ++places;
      lost += end - begin;
    }
    begin = end;
  }
  if (places < 2) return {};
  return Words{
      fmt::format("drops to 0 {} in {} places, {} samples in all: the signal was lost there", unit, places, lost),
      "Put values between those before and after in their place, and check connector and cable."};
}

/// Neighbouring readings have nothing in common.
bool is_white(std::span<const double> values) {
  double mean = 0.0;
  for (const double value : values) mean += value / static_cast<double>(values.size());
  double neighbours = 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    squares += (values[i] - mean) * (values[i] - mean);
    if (i > 0) neighbours += (values[i] - mean) * (values[i - 1] - mean);
  }
  return std::abs(neighbours) <= tuning::kTwoSided99 * squares / std::sqrt(static_cast<double>(values.size()));
}

/// For the most part the reading stands at one of two limits: as near to it as noise allows, of which the end of the
/// range is the largest draw. A single blow makes a range of which all else is near one end, and does not stand there.
std::optional<Words> cut_off(const Followed& pair) {
  const auto [least, most] = std::ranges::minmax(pair.values);
  const double near = tuning::kBeyondLimit * 0.5 * (most - least);
  std::vector<double> distances;
  for (const double value : pair.values) {
    const double distance = std::min(value - least, most - value);
    if (distance <= near) distances.push_back(distance);
  }
  if (static_cast<double>(distances.size()) <= tuning::kMainShare * static_cast<double>(pair.values.size())) return {};
  const double largest_draw = peak_of_noise(white_noise_level(pair.values), pair.values.size());
  if (upper_median(std::move(distances)) > tuning::kNearFloor * largest_draw) return {};
  return Words{fmt::format("stands at {} or {} for the most part: it is cut off there",
                           report::quantity(least, pair.unit()), report::quantity(most, pair.unit())),
               "Widen the range of the sensor and of its amplifier, and record again."};
}

std::optional<Words> unrelated(const Followed& pair) {
  const std::size_t count = averaged_samples(pair.period_s);
  const std::vector<double> motion_m = averaged(pair.motion_m, count);
  const std::vector<double> values = averaged(pair.values, count);
  const double fit_period_s = pair.period_s * static_cast<double>(count);
  const auto shift = static_cast<std::size_t>(std::max(1.0, std::round(tuning::kForceLagMax_s / fit_period_s)));
  if (values.size() < tuning::kLocaliseSamplesMin || !relation_between(motion_m, values, shift).is_none()) return {};
  const bool is_noise = is_white(pair.values);
  // A force that the model expects within the noise is no wonder.
  const bool is_expected =
      pair.predicted.empty() || spread_of(pair.predicted) >= tuning::kExcitedOverNoise * spread_of(pair.values);
  if (is_noise && !is_expected) return {};
  if (std::optional<Words> limits = cut_off(pair)) return limits;
  if (is_noise) {
    return Words{fmt::format("is nothing but noise of {} while {} moves",
                             report::quantity(spread_of(pair.values), pair.unit()), column_name(pair.in)),
                 "Check that the sensor is connected and that the specimen is attached, and record again."};
  }
  if (!pair.is_quasi_static) {
    const std::size_t every = 1 + values.size() / tuning::kFarLagSamples;
    if (const auto lag = far_lag(averaged(motion_m, every), averaged(values, every))) {
      const double late_s = static_cast<double>(*lag) * fit_period_s * static_cast<double>(every);
      return Words{fmt::format("follows {} {:.3g} s too {}: they belong to different times", column_name(pair.in),
                               std::abs(late_s), late_s > 0.0 ? "late" : "early"),
                   "Shift one of them in time, or record both with one clock."};
    }
  }
  return Words{fmt::format("has nothing to do with {}: not with its displacement, velocity or acceleration, a contact, "
                           "a play or a friction, nor at any lag",
                           column_name(pair.in)),
               "Check that this is the channel of this site and of this test."};
}

/// Whether an output runs against the model, and inertia does not explain it better.
bool runs_against(const Followed& pair, double work) {
  if (pair.predicted.empty() || !(spread_of(pair.predicted) > 0.0)) return false;
  std::vector<double> acceleration(pair.is_force() && !pair.is_quasi_static ? pair.motion.size() : 0);
  for (std::size_t i = 0; i < acceleration.size(); ++i) acceleration[i] = pair.motion[i].acceleration_m_per_s2;
  const Sense sense = sense_of(pair.predicted, pair.values, acceleration);
  if (sense.slope >= 0.0 || sense.correlation > -tuning::kMainShare) return false;
  // Inertia does no work.
  if (pair.is_force() && work < -tuning::kMainShare * tuning::kMainShare) return true;
  // At one frequency inertia and a reversed spring are the same; nothing but the size of the force tells them apart.
  const bool has_size_of_model = -sense.slope > tuning::kMainShare && -sense.slope < 1.0 / tuning::kMainShare;
  return sense.leaves < tuning::kMainShare * sense.mass_leaves ||
         (has_size_of_model && sense.leaves < sense.mass_leaves + tuning::kMainShare * (1.0 - sense.mass_leaves));
}

std::optional<Words> reversed(const Followed& pair) {
  const double work = pair.is_force() ? work_share(pair.motion_m, pair.values) : 0.0;
  if (work > tuning::kMainShare) return {};
  const double expected = pair.is_force() && !pair.predicted.empty() ? work_share(pair.motion_m, pair.predicted) : 0.0;
  // A damper or friction that drives the motion; a spring that leads it a little does not.
  const bool drives = work < -tuning::kMainShare && expected > -tuning::kMainShare &&
                      sense_of(pair.motion_m, pair.values, {}).correlation < tuning::kMainShare;
  if (!drives && !runs_against(pair, work)) return {};
  if (pair.is_force()) {
    return Words{drives ? "has the wrong sign: the force drives the motion where the specimen should resist it"
                        : "has the wrong sign: the force falls where the displacement rises, against the model",
                 "Multiply the force by -1, or the displacement if that is reversed: a force is positive when it "
                 "resists a positive displacement."};
  }
  return Words{fmt::format("has the wrong sign: it runs against {}", column_name(pair.in)),
               "Multiply one of the two displacements by -1."};
}

/// Samples per cycle that a tenth of a signal's energy does not have; infinite for a slow signal.
double samples_per_cycle_of_fast_part(std::span<const double> values, double period_s) {
  const Spectra spectra = welch(values, values, period_s, welch_segment(values.size()));
  std::vector<double> density = spectra.input;
  const double noise = upper_median(density);  // of the median line: white noise
  double all = 0.0;
  for (double& line : density) {
    line = std::max(0.0, line - noise);
    all += line;
  }
  double above = 0.0;
  for (std::size_t i = density.size(); i-- > 1;) {
    above += density[i];
    if (above >= tuning::kFastShare * all) return 1.0 / (spectra.frequency_hz(i) * period_s);
  }
  return std::numeric_limits<double>::infinity();
}

/// @param needs_derivatives   who needs derivatives of the motion; empty: nobody does.
std::optional<Words> sampled_too_slowly(std::span<const double> values, double period_s,
                                        std::string_view needs_derivatives) {
  if (values.size() < tuning::kLocaliseSamplesMin) return {};
  const double samples = samples_per_cycle_of_fast_part(values, period_s);
  const double enough = needs_derivatives.empty() ? tuning::kSamplesPerCycleMin : tuning::kSamplesPerCycle;
  if (samples >= enough) return {};
  const std::string why =
      needs_derivatives.empty() ? "" : fmt::format(", and {} derivatives of the motion", needs_derivatives);
  return Words{fmt::format("is sampled too slowly: a tenth of its energy has fewer than {:.1f} samples per cycle{}",
                           samples, why),
               fmt::format("Record at {:.0f} Hz or more; with this recording, damping and mass come out wrong.",
                           std::ceil(tuning::kSamplesPerCycle / (samples * period_s)))};
}

/// A shift of the predicted force by less than a sample that explains most of the gap.
std::optional<Words> shifted_within_a_sample(const Followed& pair) {
  if (!pair.is_force() || pair.is_quasi_static || pair.predicted.empty()) return {};
  const Sense sense = sense_of(pair.predicted, pair.values, {});
  const double unshifted = 1.0 - sense.correlation * sense.correlation;
  const bool is_within = sense.correlation > 0.0 && std::abs(sense.shift) < 1.0;
  if (!is_within || sense.leaves > tuning::kPartialLeaves * unshifted) return {};
  return Words{fmt::format("is {} {} the displacement, less than a sample: a skew of the channels, a lag and damping "
                           "look alike here",
                           report::quantity(std::abs(sense.shift) * pair.period_s, "s"),
                           sense.shift > 0.0 ? "behind" : "ahead of"),
               "Sample both channels at once, or several times faster."};
}

/// Whether a force of them follows velocity or acceleration.
bool needs_derivatives(std::span<const EffectSetting> effects) {
  return std::ranges::any_of(effects,
                             [](const EffectSetting& effect) { return effect.type->traits.follows_derivatives; });
}

/// What stands in front of a measured channel, and what the model makes of it.
struct Chain {
  Channel in{};
  std::vector<Segment> segment;  // one, or none
  std::vector<double> predicted;
};

Chain chain_to(Channel out, const SiteModel& model, const Recording& recording, std::size_t dof) {
  Chain chain;
  for (Segment& segment : segments_of(recording, dof, 0)) {
    if (segment.to != out) continue;
    chain.in = segment.from;
    if (is_modelled(model, segment)) chain.predicted = predict(model, segment);
    chain.segment.push_back(std::move(segment));
  }
  return chain;
}

/// The first thing that makes a channel unusable, or everything else that is to be said of it.
void check_channel_of(const SiteModel& model, std::span<const Recording> recordings, std::size_t position,
                      std::size_t dof, Channel out, std::vector<ChannelFinding>& findings) {
  const Recording& recording = recordings[position];
  const DofRecording& channels = recording.dofs[dof];
  const Chain chain = chain_to(out, model, recording, dof);
  const auto add_to = [&](std::string_view interface, const std::optional<Words>& words, bool is_unusable) {
    if (!words) return false;
    findings.push_back({.said = {.recording = recording.file,
                                 .interface = std::string{interface},
                                 .what = std::string{column_name(out)} + " " + words->what,
                                 .what_to_do = words->what_to_do},
                        .recording = position,
                        .channel = out,
                        .is_unusable = is_unusable});
    return true;
  };
  const EffectInterface sensor =
      out == Channel::measured_force ? EffectInterface::force_sensor : EffectInterface::displacement_sensor;
  const std::string unit = unit_of(column_name(out));
  if (add_to(name_of(sensor), words_of(wild_readings(channels.of(out)), unit), true)) return;
  if (add_to(name_of(sensor), dropouts(channels.of(out), unit), true)) return;
  if (chain.segment.empty()) return;
  const Segment& segment = chain.segment.front();
  const Followed pair{.in = chain.in,
                      .out = out,
                      .motion_m = channels.of(chain.in),
                      .values = channels.of(out),
                      .predicted = chain.predicted,
                      .motion = segment.input,
                      .period_s = recording.sample_period_s,
                      .is_quasi_static = recording.is_quasi_static};
  if (!moves(pair)) return;
  const auto add = [&](const std::optional<Words>& words, bool is_unusable) {
    return add_to(name_of(segment.interface), words, is_unusable);
  };
  if (add(frozen(pair), true) || add(died(pair), true) || add(reversed(pair), true) || add(unrelated(pair), true))
    return;
  if (!pair.is_quasi_static) {
    const bool is_of_derivatives = pair.is_force() && needs_derivatives(model.effects);
    add(sampled_too_slowly(pair.values, pair.period_s, is_of_derivatives ? "the model needs" : ""), false);
  }
  add(shifted_within_a_sample(pair), false);
}

bool is_unusable(std::span<const ChannelFinding> findings, std::size_t recording, Channel channel) {
  return std::ranges::any_of(findings, [&](const ChannelFinding& finding) {
    return finding.is_unusable && finding.recording == recording && finding.channel == channel;
  });
}

}  // namespace

std::vector<ChannelFinding> check_channels(const SiteModel& model, std::span<const Recording> recordings,
                                           std::size_t dof) {
  std::vector<ChannelFinding> findings;
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    if (recordings[i].dofs.size() <= dof) continue;
    check_channel_of(model, recordings, i, dof, Channel::measured_displacement, findings);
    // A force is judged by the measured displacement.
    if (is_unusable(findings, i, Channel::measured_displacement)) continue;
    check_channel_of(model, recordings, i, dof, Channel::measured_force, findings);
  }
  return findings;
}

std::vector<ChannelFinding> check_sampling(const SiteModel& model, std::span<const EffectSetting> causes,
                                           std::span<const Recording> recordings, std::size_t dof) {
  std::vector<ChannelFinding> findings;
  if (needs_derivatives(model.effects) || !needs_derivatives(causes)) return findings;
  constexpr Channel kForce = Channel::measured_force;
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    const Recording& recording = recordings[i];
    if (recording.is_quasi_static || recording.dofs.size() <= dof) continue;
    const std::vector<double>& force_n = recording.dofs[dof].of(kForce);
    const auto words = sampled_too_slowly(force_n, recording.sample_period_s, "the causes need");
    if (!words) continue;
    findings.push_back({.said = {.recording = recording.file,
                                 .interface = std::string{name_of(EffectInterface::specimen)},
                                 .what = std::string{column_name(kForce)} + " " + words->what,
                                 .what_to_do = words->what_to_do},
                        .recording = i,
                        .channel = kForce});
  }
  return findings;
}

std::span<const Recording> usable_part(std::span<const Recording> recordings, std::size_t dof,
                                       std::span<const ChannelFinding> findings, std::vector<Recording>& copy) {
  if (std::ranges::none_of(findings, &ChannelFinding::is_unusable)) return recordings;
  copy.assign(recordings.begin(), recordings.end());
  for (const ChannelFinding& finding : findings) {
    if (finding.is_unusable) copy[finding.recording].dofs[dof].of(finding.channel).clear();
  }
  return copy;
}

void add_findings(std::span<const ChannelFinding> findings, report::DiagnosisReport& report) {
  for (const ChannelFinding& finding : findings) {
    report.findings.push_back(finding.said);
    report.notes.push_back(finding.said.recording + ": " + finding.said.what + ". " + finding.said.what_to_do);
    if (!finding.is_unusable) continue;
    for (report::InterfaceGap& gap : report.where) {
      const bool is_of_force = gap.interface == name_of(EffectInterface::specimen) ||
                               gap.interface == name_of(EffectInterface::force_sensor);
      const bool is_of_displacement = gap.interface == name_of(EffectInterface::transfer_system) ||
                                      gap.interface == name_of(EffectInterface::displacement_sensor);
      const bool is_concerned =
          finding.channel == Channel::measured_force ? is_of_force : is_of_force || is_of_displacement;
      if (!is_concerned || gap.is_judged) continue;
      gap.why_not = finding.said.what;
      // What is left agrees; of the interface behind this channel nothing is known.
      if (report.verdict == report::Verdict::none) report.verdict = report::Verdict::not_excited;
    }
    if (report.verdict == report::Verdict::not_excited) report.next_experiment = finding.said.what_to_do;
  }
}

}  // namespace hybridtest
