#include "scenario/sites_in_place.hpp"

#include <algorithm>
#include <optional>

#include "core/config/section.hpp"
#include "scenario/named_file.hpp"
#include "scenario/site_model_file.hpp"

namespace hybridtest {
namespace {

using config::Section;

/// The file that a rig is to be read from; nothing for a rig that is written out.
std::optional<std::filesystem::path> file_of_rig(Section& substructure, const std::filesystem::path& directory) {
  if (!substructure.has_mapping("rig")) return {};
  Section rig = substructure.section("rig");
  if (!rig.has("model")) return {};
  for (const std::string& key : rig.keys()) {
    if (key != "type" && key != "model")
      rig.error(key, "a rig that is read from a `model` file has no keys of its own");
  }
  if (rig.has("type")) static_cast<void>(rig.choice("type", {"simulated"}));
  return named_file(rig, "model", directory);
}

/// Likewise of the model beside a rig; a numerical substructure's `model` is something else.
std::optional<std::filesystem::path> file_of_model(Section& substructure, const std::filesystem::path& directory) {
  if (!substructure.has("rig") || !substructure.has("model") || substructure.has_mapping("model")) return {};
  return named_file(substructure, "model", directory);
}

/// The setting of one compensator cannot be corrected by what was found beside another: it would be counted twice.
void require_its_compensator(const SiteModelFile& model, const std::string& file, Section substructure) {
  const EffectType* const mismatch = find_effect(EffectInterface::compensator, "setting_mismatch");
  const bool is_corrected = std::ranges::any_of(model.dofs, [&](const SiteModel& dof) {
    return std::ranges::find(dof.effects, mismatch, &EffectSetting::type) != dof.effects.end();
  });
  if (!is_corrected) return;
  const auto or_none = [](const std::string& list) { return list.empty() ? "- type: none\n" : list; };
  if (or_none(written_compensators(substructure)) == or_none(model.compensators)) return;
  substructure.error("rig", file +
                                ": the effect setting_mismatch in this file corrects the compensator that the file "
                                "names (without the key: none), and the site has another one. Expected the same "
                                "`compensator` in both, or a file without this effect");
}

}  // namespace

std::vector<std::string> with_sites_in_place(const std::filesystem::path& scenario,
                                             std::vector<std::string> overrides) {
  config::Document document = config::Document::load(scenario, overrides);
  // What is wrong already is listed, with everything else, by who reads the scenario itself.
  if (document.has_errors()) return overrides;
  Section root = document.root();
  if (!root.has("substructures")) return overrides;
  std::vector<std::string> in_place;
  const auto put = [&](const std::string& path, const SiteModelFile& model) {
    in_place.push_back(path + "=" + model.rig);
  };
  for (Section& substructure : root.sections("substructures")) {
    const std::string path = substructure.path();
    const std::optional<std::filesystem::path> rig = file_of_rig(substructure, document.directory());
    const std::optional<std::filesystem::path> model = file_of_model(substructure, document.directory());
    document.throw_if_errors();
    if (rig) {
      const SiteModelFile site = read_site_model(*rig);
      require_its_compensator(site, rig->string(), substructure);
      put(path + ".rig", site);
    }
    if (model) put(path + ".model", read_site_model(*model));
    document.throw_if_errors();
  }
  overrides.insert(overrides.end(), in_place.begin(), in_place.end());
  return overrides;
}

}  // namespace hybridtest
