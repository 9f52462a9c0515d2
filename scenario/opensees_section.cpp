#include "scenario/opensees_section.hpp"

#include <algorithm>
#include <set>

namespace hybridtest {
namespace {
using config::Section;

LedElementScenario read_element(Section section) {
  LedElementScenario element;
  element.substructure = section.text("substructure");
  element.port = static_cast<std::uint16_t>(section.integer("port", 1024, 65535));
  element.dofs = section.names("dofs");
  const std::size_t size = element.dofs.size();
  const auto each = [&](const char* key) -> Eigen::VectorXd {
    if (!section.has_optional(key)) return Eigen::VectorXd::Zero(static_cast<Eigen::Index>(size));
    return section.numbers(key, size, {.low = 0.0});
  };
  element.mass_kg = each("mass_kg");
  element.damping_n_s_per_m = each("damping_n_s_per_m");
  section.finish();
  return element;
}

void read_start(Section& section, const std::filesystem::path& directory, std::vector<NamedFile>& files,
                OpenSeesLeadScenario& lead) {
  const bool has_script = section.has_optional("script");
  if (section.boolean("started_by_hand", !has_script)) {
    if (has_script) section.error("script", "with started_by_hand: true nothing starts it; leave one of the two out");
    return;
  }
  lead.script = named_file(section, "script", directory).value_or("");
  if (!lead.script.empty()) files.push_back({.file = lead.script, .written = section.text("script")});
  lead.program = section.text("program", "");
  if (section.has_optional("arguments")) lead.arguments = section.names("arguments");
}

}  // namespace

std::optional<OpenSeesLeadScenario> read_opensees_lead(Section& root, const std::filesystem::path& directory,
                                                       std::vector<NamedFile>& files) {
  std::optional<Section> section = root.optional_section("coordinator");
  if (!section) return {};
  if (section->choice("type", {"integrator", "opensees"}, "integrator") == 0) {
    section->finish();
    return {};
  }
  OpenSeesLeadScenario lead;
  read_start(*section, directory, files, lead);
  lead.listen_address = section->text("listen", "127.0.0.1");
  lead.client_address = section->text("from", "127.0.0.1");
  lead.allow_iterations = section->boolean("allow_iterations", false);
  lead.silence = from_seconds(section->number("silence_s", {.low = 0.1, .high = 86400.0}, 60.0));
  std::set<std::uint16_t> ports;
  for (Section& each : section->sections("elements")) {
    LedElementScenario element = read_element(each);
    if (!ports.insert(element.port).second) {
      each.error("port", "port " + std::to_string(element.port) + " is that of another element");
    }
    for (const std::string& dof : element.dofs) {
      if (std::ranges::find(lead.dofs, dof) == lead.dofs.end()) lead.dofs.push_back(dof);
    }
    lead.elements.push_back(std::move(element));
  }
  if (lead.elements.empty()) section->error("elements", "expected one for each genericClient element of the model");
  section->finish();
  return lead;
}

}  // namespace hybridtest
