#include "scenario/sites_in_place.hpp"

#include <optional>

#include "core/config/section.hpp"
#include "scenario/site_model_file.hpp"

namespace hybridtest {
namespace {

using config::Section;

/// The file that a rig is to be read from; nothing for a rig that is written out.
std::optional<std::string> file_of_rig(Section& substructure) {
  if (!substructure.has_mapping("rig")) return {};
  Section rig = substructure.section("rig");
  if (!rig.has("model")) return {};
  for (const std::string& key : rig.keys()) {
    if (key != "type" && key != "model")
      rig.error(key, "a rig that is read from a `model` file has no keys of its own");
  }
  if (rig.has("type")) static_cast<void>(rig.choice("type", {"simulated"}));
  return rig.text("model");
}

/// Likewise of the model beside a rig; a numerical substructure's `model` is something else.
std::optional<std::string> file_of_model(Section& substructure) {
  if (!substructure.has("rig") || !substructure.has("model") || substructure.has_mapping("model")) return {};
  return substructure.text("model");
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
  const auto put = [&](const std::string& path, const std::string& file) {
    in_place.push_back(path + "=" + read_site_model(document.directory() / file).rig);
  };
  for (Section& substructure : root.sections("substructures")) {
    const std::string path = substructure.path();
    const std::optional<std::string> rig = file_of_rig(substructure);
    const std::optional<std::string> model = file_of_model(substructure);
    document.throw_if_errors();
    if (rig) put(path + ".rig", *rig);
    if (model) put(path + ".model", *model);
  }
  overrides.insert(overrides.end(), in_place.begin(), in_place.end());
  return overrides;
}

}  // namespace hybridtest
