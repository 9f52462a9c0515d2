#include "scenario/site_model_file.hpp"

#include <algorithm>
#include <iterator>
#include <optional>
#include <sstream>
#include <utility>

#include "core/config/section.hpp"
#include "core/text/indented.hpp"
#include "core/text/scalar.hpp"
#include "scenario/catalogue/compensators.hpp"
#include "scenario/catalogue/simulated_rig.hpp"
#include "scenario/dampers_beside_law.hpp"

namespace hybridtest {
namespace {

using config::Section;

/// Where in the file the parts of a site stand.
struct SitePlace {
  Section rig;
  Section beside;  // has the compensator and the control rate
  std::optional<int> dofs;
};

std::string id_of(Section& substructure) { return substructure.has("id") ? substructure.text("id") : std::string{}; }

SitePlace site_of_scenario(Section& root, std::string_view id) {
  std::string known;
  std::vector<Section> sites;
  for (Section& substructure : root.sections("substructures")) {
    if (!substructure.has("rig")) continue;
    known += (known.empty() ? "" : ", ") + id_of(substructure);
    if (id.empty() || id_of(substructure) == id) sites.push_back(substructure);
  }
  if (sites.size() != 1) {
    root.error("substructures",
               id.empty()
                   ? "a model of one site is read, and this scenario has the sites: " + known + "; name one of them"
                   : "no site '" + std::string{id} + "'; this scenario has the sites: " + known);
    return {.rig = root.section_or_empty("rig"), .beside = root, .dofs = {}};
  }
  const auto dofs = static_cast<int>(sites.front().sections("interface").size());
  const char* const rig = sites.front().has("model") ? "model" : "rig";
  return {.rig = sites.front().section(rig), .beside = sites.front(), .dofs = std::max(1, dofs)};
}

SitePlace site_in(Section& root, std::string_view id) {
  if (root.has("substructures")) return site_of_scenario(root, id);
  if (root.has("rig")) return {.rig = root.section("rig"), .beside = root, .dofs = {}};
  return {.rig = root, .beside = root, .dofs = {}};
}

/// As many degrees of freedom as the longest list has.
int count_dofs(Section& rig) {
  std::size_t count = 1;
  for (const char* key : {"transfer_system", "specimen"}) {
    if (!rig.has_optional(key)) continue;
    count = std::max(count, rig.sections(key, true).size());
  }
  return static_cast<int>(count);
}

std::vector<CompensatorReading> read_compensators(Section& beside) {
  std::vector<CompensatorReading> readings;
  if (!beside.has_optional("compensator")) return readings;
  for (const Section& entry : beside.sections("compensator", true)) readings.push_back(read_compensator(entry));
  return readings;
}

void give_compensators(const std::vector<CompensatorReading>& readings, Section& beside, std::vector<SiteModel>& dofs) {
  if (readings.empty()) return;
  if (readings.size() != 1 && readings.size() != dofs.size()) {
    beside.error("compensator", "expected one, or one for each degree of freedom");
    return;
  }
  for (std::size_t i = 0; i < dofs.size(); ++i) {
    const CompensatorReading& reading = readings[readings.size() == 1 ? 0 : i];
    dofs[i].make_compensator = reading.make;
    dofs[i].compensator_delay = reading.setting;
  }
}

/// Makes every part once, so that what they object to is found here.
void try_out(const std::vector<SiteModel>& dofs, double period_s) {
  for (const SiteModel& dof : dofs) {
    static_cast<void>(transfer_system_of(dof, period_s));
    if (dof.make_law) static_cast<void>(dof.make_law());
    if (dof.make_compensator) static_cast<void>(dof.make_compensator(period_s, setting_change_s(dof)));
    for (const EffectInterface interface : site_interfaces()) static_cast<void>(effects_at(dof, interface, period_s));
  }
}

/// The section with a word for everything that a scenario wants to see.
std::string whole_rig(const Section& rig) {
  std::string text = "type: simulated\n";
  text += rig.has("transfer_system") ? rig.effective("transfer_system") : "transfer_system: {type: ideal}\n";
  text += rig.has("specimen") ? rig.effective("specimen") : "specimen: {type: none}\n";
  for (const char* key : {"sensors", "effects"}) {
    if (rig.has(key)) text += rig.effective(key);
  }
  return text;
}

/// The list under `effects`, which is the text's last key if it is there, made longer.
std::string longer_by(std::span<const ListedEffect> effects, std::string text, bool has_effects) {
  if (!has_effects && !effects.empty()) text += "effects:\n";
  for (const ListedEffect& effect : effects) text += written_effect(effect);
  return text;
}

std::string without_effects(const std::string& text) {
  return text.starts_with("effects:") ? std::string{} : text.substr(0, text.find("\neffects:") + 1);
}

/// Lists all effects of the site in place of the added ones, where one of these takes the place of one that the site
/// has.
/// @return whether it does.
bool list_all(std::vector<ListedEffect>& added, std::vector<SiteModel> dofs) {
  const auto concerns = [](const ListedEffect& effect, std::size_t dof) {
    return effect.dof.value_or(static_cast<int>(dof)) == static_cast<int>(dof);
  };
  bool any = false;
  for (const ListedEffect& effect : added) {
    for (std::size_t dof = 0; dof < dofs.size(); ++dof) {
      if (!concerns(effect, dof)) continue;
      any = any || place_of(dofs[dof], *effect.setting.type) != nullptr;
      add_effect(dofs[dof], effect.setting);
    }
  }
  if (!any) return false;
  added.clear();
  for (std::size_t dof = 0; dof < dofs.size(); ++dof) {
    for (const EffectSetting& effect : dofs[dof].effects) {
      added.push_back({effect, dofs.size() > 1 ? std::optional{static_cast<int>(dof)} : std::nullopt});
    }
  }
  return true;
}

constexpr double kUsualControlRate_hz = 1024.0;

/// What effects add to the settings of the compensators, one per degree of freedom; those effects leave the list.
std::vector<double> take_setting_changes(std::vector<ListedEffect>& effects, const std::vector<SiteModel>& dofs) {
  std::vector<double> change_s(dofs.size(), 0.0);
  std::erase_if(effects, [&](const ListedEffect& effect) {
    const auto concerns = [&](std::size_t dof) { return !effect.dof || *effect.dof == static_cast<int>(dof); };
    if (effect.setting.type != find_effect(EffectInterface::compensator, "setting_mismatch")) return false;
    for (std::size_t dof = 0; dof < dofs.size(); ++dof) {
      if (concerns(dof) && dofs[dof].compensator_delay.most_s <= 0.0) return false;
    }
    for (std::size_t dof = 0; dof < dofs.size(); ++dof) {
      if (concerns(dof)) change_s[dof] += effect.setting.values[0];
    }
    return true;
  });
  return change_s;
}

/// The list of compensators with other settings; `none` becomes what read_compensator() makes of it.
std::string corrected(const std::string& compensators, const std::vector<SiteModel>& dofs,
                      const std::vector<double>& change_s) {
  std::string list = compensators;
  if (list.find("\n- ") == std::string::npos) {  // one for all
    for (std::size_t dof = 1; dof < dofs.size(); ++dof) list += compensators;
  }
  std::vector<std::string> overrides;
  for (std::size_t dof = 0; dof < dofs.size(); ++dof) {
    if (change_s[dof] == 0.0) continue;
    const std::string entry = "compensator[" + std::to_string(dof) + "].";
    const DelaySetting& setting = dofs[dof].compensator_delay;
    if (setting.set_s == 0.0) overrides.push_back(entry + "type=polynomial_displacement");
    overrides.push_back(entry + "delay_s=" + written_number(setting.set_s + change_s[dof]));
  }
  config::Document document = config::Document::parse("compensator:\n" + list, "compensator", overrides);
  std::string result = written_compensators(document.root());
  document.throw_if_errors();
  return result;
}

/// A law as a scenario writes it, with a line for each number.
std::string written_law(const EffectSetting& replacement) {
  const LawReplacement& law = *replacement.type->replacement;
  std::string lines = "type: " + std::string{law.law} + "\n";
  for (const LawParameter& parameter : law.written(replacement.values)) {
    lines += parameter.name + ": " + written_number(parameter.value) + "\n";
  }
  return lines;
}

/// The laws under `specimen`, one per degree of freedom, as their lines without indentation.
std::vector<std::string> laws_in(const std::string& block, std::size_t dofs) {
  std::vector<std::string> laws;
  std::istringstream stream{block};
  for (std::string line; std::getline(stream, line);) {
    const bool begins = line.starts_with("  - ");
    if (begins || laws.empty()) laws.emplace_back();
    const std::size_t margin = line.starts_with("    ") || begins ? 4 : 2;
    laws.back() += line.substr(std::min(margin, line.size())) + "\n";
  }
  if (laws.empty()) laws.emplace_back("type: none\n");
  if (laws.size() == 1) laws.resize(dofs, laws.front());
  return laws;
}

/// The text with other laws under its key `specimen`, which stands at its top.
std::string with_laws(const std::string& text, std::span<const ListedEffect> replacements, std::size_t dofs) {
  const std::string key = "specimen:";
  std::size_t begin = text.starts_with(key) ? 0 : text.find("\n" + key);
  std::size_t end = 0;
  std::string block;
  if (begin == std::string::npos) {
    begin = 0;
  } else {
    if (begin > 0) ++begin;
    const std::size_t first = text.find('\n', begin) + 1;  // what stands on the key's own line is no law
    for (end = first; end < text.size() && text[end] == ' ';) end = text.find('\n', end) + 1;
    block = text.substr(first, end - first);
  }
  std::vector<std::string> laws = laws_in(block, dofs);
  for (const ListedEffect& replacement : replacements) {
    for (std::size_t dof = 0; dof < dofs; ++dof) {
      if (replacement.dof.value_or(static_cast<int>(dof)) == static_cast<int>(dof)) {
        laws[dof] = written_law(replacement.setting);
      }
    }
  }
  std::string written = key + "\n";
  for (const std::string& law : laws) written += dofs == 1 ? indented(law, "  ", "  ") : indented(law, "  - ", "    ");
  return text.substr(0, begin) + written + text.substr(end);
}

}  // namespace

SiteModelText SiteModelFile::with_effects(std::span<const ListedEffect> effects) const {
  SiteModelText result = *this;
  std::vector<ListedEffect> rest(effects.begin(), effects.end());
  std::vector<ListedEffect> replacements;
  std::ranges::copy_if(rest, std::back_inserter(replacements),
                       [](const ListedEffect& effect) { return effect.setting.type->replacement != nullptr; });
  std::erase_if(rest, [](const ListedEffect& effect) { return effect.setting.type->replacement != nullptr; });
  if (!replacements.empty()) {
    result.text = with_laws(text, replacements, dofs.size());
    result.rig = with_laws(rig, replacements, dofs.size());
  }
  const std::vector<double> change_s = take_setting_changes(rest, dofs);
  if (std::ranges::any_of(change_s, [](double change) { return change != 0.0; })) {
    result.compensators = corrected(compensators, dofs, change_s);
    const std::string key = "compensator:\n";
    const auto written = [&](const std::string& list) { return key + indented(list, "  ", "  "); };
    result.text.replace(result.text.find(written(compensators)), written(compensators).size(),
                        written(result.compensators));
  }
  const bool lists_all = list_all(rest, dofs);
  const auto longer = [&](const std::string& yaml) {
    return longer_by(rest, lists_all ? without_effects(yaml) : yaml, has_effects && !lists_all);
  };
  result.text = longer(result.text);
  result.rig = longer(result.rig);
  return result;
}

std::string written_compensators(Section section) {
  std::string list;
  if (!section.has("compensator")) return list;
  for (const Section& entry : section.sections("compensator", true)) {
    static_cast<void>(read_compensator(entry));
    list += indented(entry.effective(), "- ", "  ");
  }
  return list;
}

std::string compensators_of_site(const std::filesystem::path& scenario, std::string_view substructure) {
  config::Document document = config::Document::load(scenario);
  Section root = document.root();
  std::string list = written_compensators(site_in(root, substructure).beside);
  document.throw_if_errors();
  return list;
}

bool is_site_file(const std::filesystem::path& file) {
  config::Document document = config::Document::load(file);
  const Section root = document.root();
  const auto has_any = [&](const std::vector<const char*>& keys) {
    return std::ranges::any_of(keys, [&](const char* key) { return root.has(key); });
  };
  return has_any({"rig", "transfer_system", "specimen", "effects", "sensors"}) &&
         !has_any({"schema", "time", "structure", "substructures"});
}

namespace {

/// As read_site_model(), with overrides of the file.
SiteModelFile read_with(std::vector<std::string> overrides, const std::filesystem::path& file,
                        std::string_view substructure, const std::string& compensators, Dampers dampers) {
  config::Document document = config::Document::load(file, overrides);
  Section root = document.root();
  const bool is_scenario = root.has("substructures");
  const bool takes_given = !compensators.empty() && !is_scenario && !root.has("compensator");
  if (takes_given) {
    overrides.push_back("compensator=\n" + compensators);
    document = config::Document::load(file, overrides);
    root = document.root();
  }
  SitePlace place = site_in(root, substructure);
  SiteModelFile model;
  model.file = file;
  model.compensators_were_given = takes_given;
  if (is_scenario) {
    model.name = id_of(place.beside);
    model.part = (place.beside.has("model") ? "the model beside the rig of " : "the rig of ") + model.name;
  } else if (place.beside.has_optional("name")) {
    model.name = place.beside.text("name");
  }
  if (!is_scenario && place.beside.has_optional("quasi_static")) {
    model.is_quasi_static = place.beside.boolean("quasi_static");
  }
  if (place.beside.has_optional("control_rate_hz")) {
    model.control_rate_hz = place.beside.number("control_rate_hz", {.low = 1.0, .high = 20e3});
  }
  const std::vector<CompensatorReading> readings = read_compensators(place.beside);
  if (place.rig.has("type")) static_cast<void>(place.rig.choice("type", {"simulated"}));
  const int dofs = place.dofs ? *place.dofs : count_dofs(place.rig);
  const SimulatedSiteReading site = read_simulated_site(place.rig, dofs, AbsentPart::ideal);
  if (site.make_full_stiffness) {
    place.rig.error("specimen", "a stiffness matrix couples degrees of freedom; a model of a site has a law for each");
  }
  model.dofs = site.dofs;
  give_compensators(readings, place.beside, model.dofs);
  model.compensators = written_compensators(place.beside);
  for (const SiteModel& dof : model.dofs) model.has_effects = model.has_effects || !dof.effects.empty();
  if (!is_scenario) {
    place.rig.finish();
    root.finish();
  }
  document.throw_if_errors();
  try {
    try_out(model.dofs, 1.0 / (model.control_rate_hz > 0.0 ? model.control_rate_hz : kUsualControlRate_hz));
  } catch (const ConfigError& error) {
    place.rig.error("", error.what());
  }
  document.throw_if_errors();
  if (dampers == Dampers::beside_law) {
    std::vector<std::string> moved = dampers_beside_law(place.rig);
    if (!moved.empty()) return read_with(std::move(moved), file, substructure, compensators, Dampers::in_law);
  }
  const bool is_flat = !is_scenario && !root.has("rig");
  if (!is_flat) {
    // What stands beside the rig goes in front of it.
    if (!model.name.empty()) model.text += "name: " + written_text(model.name) + "\n";
    if (model.control_rate_hz > 0.0) {
      model.text += "control_rate_hz: " + written_number(model.control_rate_hz) + "\n";
    }
    if (model.is_quasi_static) model.text += "quasi_static: true\n";
    if (place.beside.has("compensator")) model.text += place.beside.effective("compensator");
  }
  model.text += place.rig.effective();
  model.rig = whole_rig(place.rig);
  return model;
}

}  // namespace

SiteModelFile read_site_model(const std::filesystem::path& file, std::string_view substructure,
                              const std::string& compensators, Dampers dampers) {
  return read_with({}, file, substructure, compensators, dampers);
}

}  // namespace hybridtest
