#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "plant/site_model.hpp"
#include "scenario/catalogue/effects.hpp"

namespace hybridtest {

/// A file that says what is known of a site: a scenario's `rig` section at the top level (`type` left
/// out if one likes), the same under `rig`, or a whole scenario. Beside it, optional: `name`,
/// `compensator`, `control_rate_hz`. Of a scenario's site, `model` goes before `rig`. What is left out: an ideal
/// transfer system, a specimen without force, no compensator.
struct SiteModelFile {
  std::filesystem::path file;
  std::string name;              // of the site; empty when the file gives none
  std::vector<SiteModel> dofs;   // one per degree of freedom, at least one
  double control_rate_hz = 0.0;  // 0 when the file gives none
  std::string text;              // as a site file, with defaults filled in; read_site_model() accepts it
  std::string rig;               // as a scenario's `rig` section, whole: what was left out is written out

  /// `text` with effects added behind those it has.
  [[nodiscard]] std::string with_effects(std::span<const ListedEffect> effects) const;
  /// Likewise `rig`.
  [[nodiscard]] std::string rig_with_effects(std::span<const ListedEffect> effects) const;

  bool has_effects = false;  // in `text` and `rig`, as their last key
};

/// @param substructure   of a whole scenario: the id; empty where it has one site only.
/// @throws ConfigError with everything that is wrong.
[[nodiscard]] SiteModelFile read_site_model(const std::filesystem::path& file, std::string_view substructure = {});

}  // namespace hybridtest
