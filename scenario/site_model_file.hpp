#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/config/section.hpp"
#include "plant/site_model.hpp"
#include "scenario/catalogue/effects.hpp"

namespace hybridtest {

/// What a site file says of a site, as text.
struct SiteModelText {
  std::string text;          // as a site file, with defaults filled in; read_site_model() accepts it
  std::string rig;           // as a scenario's `rig` section, whole: what was left out is written out
  std::string compensators;  // as the value of `compensator`, a list; empty: none
};

/// A file that describes a site: a scenario's `rig` section at the top level (`type` may be omitted), the same under
/// `rig`, or a whole scenario. Beside it, optional: `name`, `compensator`, `control_rate_hz`, `quasi_static`. If a
/// scenario's site has both `model` and `rig`, `model` is read. Omitted parts are an ideal transfer system, a specimen
/// without force, no compensator.
struct SiteModelFile : SiteModelText {
  std::filesystem::path file;
  std::string name;                      // of the site; empty when the file gives none
  std::string part;                      // of a scenario, which part was read: `the rig of storey_1`
  std::vector<SiteModel> dofs;           // one per degree of freedom, at least one
  double control_rate_hz = 0.0;          // 0 when the file gives none
  bool is_quasi_static = false;          // time stamps of its recordings have no meaning
  bool compensators_were_given = false;  // to read_site_model(), because the file names none
  bool has_effects = false;              // in `text` and `rig`, as their last key

  /// With effects added behind those it has, and a law in place of the specimen's own where one of them is a law. A
  /// wrong setting of a compensator that has one is corrected there, so that the setting is counted once. Where one of
  /// them takes the place of one that the site has (add_effect()), the list is written anew, for each degree of
  /// freedom.
  [[nodiscard]] SiteModelText with_effects(std::span<const ListedEffect> effects) const;
};

/// Whether a file has the keys of a site and not those of a scenario.
/// @throws ConfigError when it cannot be read at all.
[[nodiscard]] bool is_site_file(const std::filesystem::path& file);

/// Where the dampers of a specimen's law stand in what is read; see dampers_beside_law().
enum class Dampers : std::uint8_t { in_law, beside_law };

/// @param substructure   of a whole scenario: the id; empty where it has one site only.
/// @param compensators   for a site file that names none, as SiteModelFile::compensators. A scenario's site without
///                       `compensator` has none.
/// @throws ConfigError with everything that is wrong.
[[nodiscard]] SiteModelFile read_site_model(const std::filesystem::path& file, std::string_view substructure = {},
                                            const std::string& compensators = {}, Dampers dampers = Dampers::in_law);

/// The compensators of a section with the key `compensator`, as SiteModelFile::compensators. Errors go to the document.
[[nodiscard]] std::string written_compensators(config::Section section);
/// Likewise those of a scenario's site. @throws ConfigError as read_site_model().
[[nodiscard]] std::string compensators_of_site(const std::filesystem::path& scenario, std::string_view substructure);

}  // namespace hybridtest
