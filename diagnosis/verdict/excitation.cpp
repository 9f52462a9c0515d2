#include "diagnosis/verdict/excitation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "diagnosis/localisation/gap_signals.hpp"
#include "diagnosis/page/wording.hpp"
#include "diagnosis/tuning.hpp"

namespace hybridtest {
namespace {

double deviation(std::span<const double> values) { return std::sqrt(variance(values)); }

std::vector<double> displacements(const std::vector<Motion>& motion) {
  std::vector<double> values(motion.size());
  std::ranges::transform(motion, values.begin(), &Motion::displacement_m);
  return values;
}

std::string_view unit_of(Channel channel) { return channel == Channel::measured_force ? "N" : "m"; }

/// How many times above its limit a signal stands; of two, the worse.
double margin(const Excitation& excitation) {
  const auto over = [](double size, double noise) { return size <= 0.0 ? 0.0 : noise > 0.0 ? size / noise : 1e300; };
  return std::min(over(excitation.motion_m, excitation.motion_noise_m),
                  over(excitation.output_size, excitation.output_floor));
}

}  // namespace

bool Excitation::moves() const noexcept {
  return motion_m > 0.0 && motion_m >= tuning::kExcitedOverNoise * motion_noise_m;
}

bool Excitation::shows() const noexcept {
  return output_size > 0.0 && output_size >= tuning::kExcitedOverNoise * output_floor;
}

bool Excitation::can_tell() const noexcept { return moves() && shows(); }

bool Excitation::is_measured() const noexcept {
  return output == Channel::measured_displacement || output == Channel::measured_force;
}

std::string Excitation::why_not() const {
  if (motion_m <= 0.0) return fmt::format("{} never changes", column_name(input));
  if (!moves()) {
    return fmt::format("{} moves by {}, within its noise ({})", column_name(input), report::quantity(motion_m, "m"),
                       report::quantity(motion_noise_m, "m"));
  }
  if (output_size <= 0.0) return fmt::format("{} never changes", column_name(output));
  if (!shows()) {
    return fmt::format("{} changes by {}, within what noise makes of it ({})", column_name(output),
                       report::quantity(output_size, unit_of(output)), report::quantity(output_floor, unit_of(output)));
  }
  return {};
}

std::vector<Excitation> excitations_of(const IdentificationProblem& problem) {
  std::vector<Excitation> excitations;
  for (const FitSegment& fit : problem.segments) {
    Excitation excitation;
    excitation.interface = name_of(fit.segment.interface);
    excitation.input = fit.segment.from;
    excitation.output = fit.segment.to;
    excitation.motion_m = deviation(displacements(fit.segment.input));
    excitation.motion_noise_m = deviation(displacements(fit.segment.noise));
    excitation.output_size = deviation({fit.measured.data(), static_cast<std::size_t>(fit.measured.size())});
    excitation.output_floor = fit.floor;
    excitations.push_back(std::move(excitation));
  }
  return excitations;
}

bool cannot_tell(const std::vector<Excitation>& excitations) {
  const bool measures = std::ranges::any_of(excitations, &Excitation::is_measured);
  return std::ranges::none_of(excitations, [&](const Excitation& excitation) {
    return excitation.can_tell() && (excitation.is_measured() || !measures);
  });
}

std::string experiment_that_excites(const std::vector<Excitation>& excitations) {
  if (excitations.empty() || !cannot_tell(excitations)) return {};
  const bool measures = std::ranges::any_of(excitations, &Excitation::is_measured);
  const Excitation* closest = nullptr;
  for (const Excitation& excitation : excitations) {
    if (measures && !excitation.is_measured()) continue;
    if (closest == nullptr || margin(excitation) > margin(*closest)) closest = &excitation;
  }
  const auto still =
      std::ranges::find_if(excitations, [](const Excitation& excitation) { return excitation.motion_m <= 0.0; });
  if (still != excitations.end()) return "Record a test that moves: " + still->why_not() + ".";
  if (closest->output_size <= 0.0) return "Look at the sensor: " + closest->why_not() + ".";
  return fmt::format(
      "Repeat with at least {:.0f} times the motion, or with sensors as much quieter: {}. At thirty times the noise "
      "what changes a tenth of the signal shows.",
      std::ceil(tuning::kWellExcitedOverNoise / margin(*closest)), closest->why_not());
}

void leave_out_unexcited(const std::vector<Excitation>& excitations, std::vector<report::InterfaceGap>& where) {
  for (report::InterfaceGap& gap : where) {
    if (gap.is_at_fault) continue;
    const auto is_here = [&](const Excitation& excitation) { return excitation.interface == gap.interface; };
    const auto first = std::ranges::find_if(excitations, is_here);
    const bool tells = std::ranges::any_of(
        excitations, [&](const Excitation& excitation) { return is_here(excitation) && excitation.can_tell(); });
    if (first == excitations.end() || tells) continue;
    gap.is_judged = false;
    gap.why_not = first->why_not();
  }
}

}  // namespace hybridtest
