#include <map>
#include <mutex>

#include "core/config_error.hpp"
#include "core/text/scalar.hpp"
#include "numerical_substructure/opensees/opensees_child.hpp"
#include "numerical_substructure/opensees/opensees_model.hpp"

namespace hybridtest {
namespace {

InterfaceMatrix asked_stiffness(const OpenSeesSettings& settings) {
  OpenSeesModel model{settings, [&](const ModelSurroundings&) {
                        return std::make_unique<OpenSeesChild>(settings, OpenSeesPurpose::stiffness,
                                                               std::filesystem::path{}, std::function<void()>{});
                      }};
  model.start({});
  const Eigen::Index dofs = model.interface_dofs();
  InterfaceMatrix stiffness{dofs, dofs};
  const InterfaceVector at_rest = InterfaceVector::Zero(dofs);
  InterfaceVector ahead = at_rest;
  InterfaceVector behind = at_rest;
  for (Eigen::Index k = 0; k < dofs; ++k) {
    const InterfaceVector probe_m = kStiffnessProbe_m * InterfaceVector::Unit(dofs, k);
    model.trial(probe_m, at_rest, ahead);
    model.trial(-probe_m, at_rest, behind);
    if (!ahead.allFinite() || !behind.allFinite()) throw ConfigError{model.failure_text()};
    stiffness.col(k) = (ahead - behind) / (2.0 * kStiffnessProbe_m);
  }
  return 0.5 * (stiffness + stiffness.transpose());
}

/// What the stiffness depends on, but for files that the script reads by itself.
std::string key_of(const OpenSeesSettings& settings) {
  std::error_code error;
  const auto written = std::filesystem::last_write_time(settings.script, error).time_since_epoch().count();
  std::string key = settings.program + "\n" + std::filesystem::absolute(settings.script, error).string() + "\n" +
                    std::to_string(written) + "\n" + written_number(settings.length_unit_m) + "\n" +
                    written_number(settings.force_unit_n) + "\n" + written_number(settings.tolerance_m);
  for (const OpenSeesDof& dof : settings.interface) {
    key += "\n" + std::to_string(dof.node) + " " + std::to_string(dof.dof) + (dof.is_rotation ? " rotation" : "");
  }
  return key;
}

}  // namespace

InterfaceMatrix opensees_stiffness_n_per_m(const OpenSeesSettings& settings) {
  static std::mutex mutex;
  static std::map<std::string, InterfaceMatrix> known;
  const std::lock_guard lock{mutex};
  const std::string key = key_of(settings);
  const auto found = known.find(key);
  return found != known.end() ? found->second : known.emplace(key, asked_stiffness(settings)).first->second;
}

}  // namespace hybridtest
