#include "diagnosis/verdict/where.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "core/random.hpp"
#include "diagnosis/identification/repetition.hpp"
#include "diagnosis/localisation/floor.hpp"
#include "diagnosis/page/wording.hpp"
#include "diagnosis/tuning.hpp"
#include "plant/effects/effect_type.hpp"

namespace hybridtest {

namespace {

constexpr std::size_t kInterfaces = static_cast<std::size_t>(EffectInterface::numerical_substructure) + 1;
using Shares = std::array<double, kInterfaces>;

/// The interface to which the gap of a segment is attributed. Effects of the displacement sensor also show in the
/// force: they come last, and only where they explain most of its gap.
EffectInterface blamed(const IdentificationProblem& problem, const FitOutcome& baseline, const FitOutcome& chosen,
                       std::size_t position) {
  const FitSegment& fit = problem.segments[position];
  const Segment& segment = fit.segment;
  const bool is_explained = chosen.segments[position].held_out_mean_square(fit) <
                            (1.0 - tuning::kMainShare) * baseline.segments[position].held_out_mean_square(fit);
  EffectInterface blamed = segment.interface;
  bool is_found = false;
  for (const EffectSetting& effect : chosen.effects) {
    if (!segment.touched_by(*effect.type)) continue;
    const bool acts_elsewhere =
        effect.type->interface == EffectInterface::displacement_sensor && segment.to == Channel::measured_force;
    if (!acts_elsewhere) return effect.type->interface;
    if (!is_found && is_explained) blamed = effect.type->interface;
    is_found = true;
  }
  return blamed;
}

/// Energy above the floor of the blocks that `pick` draws, relative to the output's; suspect segments alone.
template <class Pick>
Shares shares_of(const IdentificationProblem& problem, const FitOutcome& baseline, const FitOutcome& chosen,
                 Pick&& pick) {
  Shares shares{};
  double sum = 0.0;
  for (std::size_t i = 0; i < problem.segments.size(); ++i) {
    const FitSegment& fit = problem.segments[i];
    const double output = fit.measured.squaredNorm() / static_cast<double>(fit.measured.size());
    if (output <= 0.0 || !fit.is_suspect) continue;
    const std::vector<double>& squares = baseline.segments[i].held_out_squares;
    double energy = 0.0;
    double samples = 0.0;
    for (std::size_t b = 0; b < squares.size(); ++b) {
      const std::size_t drawn = pick(b, squares.size());
      energy += squares[drawn];
      samples += static_cast<double>(fit.block_begins[drawn + 1] - fit.block_begins[drawn]);
    }
    const double excess = std::max(0.0, energy / samples - fit.floor * fit.floor) / output;
    shares[static_cast<std::size_t>(blamed(problem, baseline, chosen, i))] += excess;
    sum += excess;
  }
  if (sum > 0.0) {
    for (double& share : shares) share /= sum;
  }
  return shares;
}

/// 95 % interval of the resampled blocks.
std::array<report::Interval, kInterfaces> intervals(const IdentificationProblem& problem, const FitOutcome& baseline,
                                                    const FitOutcome& chosen, std::uint64_t seed) {
  Random random{seed};
  std::array<std::vector<double>, kInterfaces> drawn;
  for (std::size_t i = 0; i < tuning::kResamples; ++i) {
    const Shares shares =
        shares_of(problem, baseline, chosen, [&](std::size_t, std::size_t blocks) { return random.below(blocks); });
    for (std::size_t k = 0; k < kInterfaces; ++k) drawn[k].push_back(shares[k]);
  }
  std::array<report::Interval, kInterfaces> result;
  for (std::size_t k = 0; k < kInterfaces; ++k) {
    std::ranges::sort(drawn[k]);
    result[k] = {drawn[k][tuning::kResamples / 40], drawn[k][tuning::kResamples - 1 - tuning::kResamples / 40]};
  }
  return result;
}

}  // namespace

std::vector<report::InterfaceGap> locate(const IdentificationProblem& problem, const FitOutcome& baseline,
                                         const FitOutcome& chosen, std::uint64_t seed) {
  const Shares shares = shares_of(problem, baseline, chosen, [](std::size_t block, std::size_t) { return block; });
  const std::array<report::Interval, kInterfaces> ci95 = intervals(problem, baseline, chosen, seed);
  std::array<report::InterfaceGap, kInterfaces> gaps;
  std::array<double, kInterfaces> squares{};
  std::array<double, kInterfaces> floors{};
  std::array<double, kInterfaces> judged{};
  const auto add = [&](EffectInterface interface, const FitSegment& fit, const std::vector<double>& predicted) {
    const auto k = static_cast<std::size_t>(interface);
    const auto size = static_cast<Eigen::Index>(fit.segment.measured.size());
    const Eigen::Map<const Eigen::VectorXd> measured{fit.segment.measured.data(), size};
    const Eigen::Map<const Eigen::VectorXd> model{predicted.data(), size};
    const double output = measured.squaredNorm();
    if (output <= 0.0) return;
    squares[k] += (measured - model).squaredNorm() / output;
    floors[k] += fit.sample_floor * fit.sample_floor * static_cast<double>(size) / output;
    judged[k] += 1.0;
  };
  for (std::size_t i = 0; i < problem.segments.size(); ++i) {
    const FitSegment& fit = problem.segments[i];
    const EffectInterface at = blamed(problem, baseline, chosen, i);
    add(at, fit, predict(problem.model, fit.segment));
    // The stage itself is judged with the effect of its neighbour added.
    if (at != fit.segment.interface)
      add(fit.segment.interface, fit, predict(problem.model, fit.segment, chosen.effects));
  }
  std::vector<report::InterfaceGap> where;
  for (std::size_t k = 0; k < kInterfaces; ++k) {
    if (judged[k] == 0.0) continue;
    report::InterfaceGap gap;
    gap.interface = name_of(static_cast<EffectInterface>(k));
    gap.is_judged = true;
    gap.share = shares[k];
    gap.share_ci95 = ci95[k];
    gap.nrmse = std::sqrt(squares[k] / judged[k]);
    gap.floor_nrmse = std::sqrt(floors[k] / judged[k]);
    gap.is_at_fault = gap.nrmse > tuning::kFaultOverFloor * gap.floor_nrmse + tuning::kModelAllowance;
    where.push_back(std::move(gap));
  }
  std::ranges::stable_sort(where, std::greater{}, &report::InterfaceGap::share);
  return where;
}

namespace {

using enum EffectInterface;

/// The input and output channels of an interface.
struct Ends {
  Channel in;
  Channel out;
};

Ends ends_of(EffectInterface interface) {
  switch (interface) {
    case network: return {Channel::sent_displacement, Channel::target_displacement};
    case compensator: return {Channel::target_displacement, Channel::command_displacement};
    case specimen: return {Channel::measured_displacement, Channel::measured_force};
    default: return {Channel::command_displacement, Channel::measured_displacement};
  }
}

std::string missing_columns(std::span<const Recording> recordings, std::size_t dof, const Ends& ends) {
  std::vector<std::string> missing;
  for (const Channel channel : {ends.in, ends.out}) {
    const bool is_there = std::ranges::any_of(recordings, [&](const Recording& recording) {
      return recording.role == RecordingRole::fit && recording.dofs.size() > dof && recording.dofs[dof].has(channel);
    });
    if (!is_there) missing.emplace_back(column_name(channel));
  }
  if (missing.empty()) return {};
  return report::joined(missing) + (missing.size() > 1 ? " were" : " was") + " not recorded";
}

std::string why_not(const SiteModel& model, std::span<const Recording> recordings, std::size_t dof,
                    EffectInterface interface) {
  switch (interface) {
    case numerical_substructure: return "a run directory is needed; these recordings contain only the site";
    case displacement_sensor: return "no second displacement sensor was recorded";
    case force_sensor: return "no second force sensor was recorded";
    default: break;
  }
  std::string missing = missing_columns(recordings, dof, ends_of(interface));
  if (!missing.empty()) return missing;
  if (interface != specimen && std::ranges::any_of(recordings, &Recording::is_quasi_static))
    return "a quasi-static recording has no time, and this interface is judged by its timing";
  return interface == specimen && !model.make_law ? "the model has no law for the force of the specimen"
                                                  : "no recording has all columns of this interface";
}

}  // namespace

void add_unjudged(const SiteModel& model, std::span<const Recording> recordings, std::size_t dof,
                  std::vector<report::InterfaceGap>& where) {
  constexpr std::array kChain{numerical_substructure, network,  compensator, transfer_system,
                              displacement_sensor,    specimen, force_sensor};
  for (const EffectInterface interface : kChain) {
    if (std::ranges::find(where, name_of(interface), &report::InterfaceGap::interface) != where.end()) continue;
    report::InterfaceGap gap;
    gap.interface = name_of(interface);
    gap.why_not = why_not(model, recordings, dof, interface);
    where.push_back(std::move(gap));
  }
}

namespace {

/// A segment's signals with the model's residual.
struct Residual {
  const Segment* segment = nullptr;
  std::vector<double> input_m;
  std::vector<double> residual;

  [[nodiscard]] GapSignals signals() const { return {segment->period_s, input_m, segment->measured, residual}; }
};

Residual residual_of(const SiteModel& model, const Segment& segment) {
  Residual result{&segment, std::vector<double>(segment.input.size()), predict(model, segment)};
  std::ranges::transform(segment.input, result.input_m.begin(), &Motion::displacement_m);
  std::ranges::transform(segment.measured, result.residual, result.residual.begin(), std::minus{});
  return result;
}

std::optional<RepeatabilityFloor> floor_of(const Residual& residual, const std::vector<Residual>& all) {
  for (const Residual& other : all) {
    if (&other == &residual || !may_repeat(*other.segment, *residual.segment)) continue;
    if (const auto floor = floor_of_repetition(residual.signals(), other.signals())) return floor;
  }
  return floor_of_cycles(residual.signals());
}

}  // namespace

void add_repeatability(const SiteModel& model, std::span<const Segment> segments,
                       std::vector<report::InterfaceGap>& where) {
  std::vector<Residual> residuals;
  for (const Segment& segment : segments) residuals.push_back(residual_of(model, segment));
  for (const Residual& residual : residuals) {
    const auto gap = std::ranges::find(where, name_of(residual.segment->interface), &report::InterfaceGap::interface);
    const double output = mean_square(residual.segment->measured);
    if (gap == where.end() || !gap->is_judged || output <= 0.0) continue;
    const std::optional<RepeatabilityFloor> floor = floor_of(residual, residuals);
    if (!floor) continue;
    const double nrmse = floor->rms / std::sqrt(output);
    if (gap->repeatability && gap->repeatability->nrmse >= nrmse) continue;
    gap->repeatability = report::Repeatability{nrmse, std::string{name_of(floor->source)}};
  }
}

bool was_recorded_again(const report::InterfaceGap& gap) {
  return gap.repeatability && gap.repeatability->source == name_of(FloorSource::repeated_recordings);
}

}  // namespace hybridtest
