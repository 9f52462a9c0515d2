#include "diagnosis/verdict/unjudged.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "diagnosis/page/wording.hpp"
#include "plant/effects/effect_type.hpp"

namespace hybridtest {
namespace {

using enum EffectInterface;

/// The channels in front of and behind an interface.
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
    case numerical_substructure: return "a run directory holds what it received; these recordings are of the site";
    case displacement_sensor: return "no second displacement: it shows where actuator and specimen agree against it";
    case force_sensor: return "no second force: it shows as a cause, where the specimen does not explain the gap";
    default: break;
  }
  std::string missing = missing_columns(recordings, dof, ends_of(interface));
  if (!missing.empty()) return missing;
  return interface == specimen && !model.make_law ? "the model says nothing of the specimen's force"
                                                  : "its columns are not in one recording together";
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

}  // namespace hybridtest
