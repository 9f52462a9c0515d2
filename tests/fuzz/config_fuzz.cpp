#include "tests/fuzz/config_fuzz.hpp"

#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "core/assert.hpp"
#include "core/config/section.hpp"

namespace hybridtest {
namespace {

using config::Document;
using config::Section;

void read_law(Section law) {
  if (law.choice("type", {"elastic", "bilinear"}) == 1) {
    (void)law.number("yield_force_n", kPositive);
    (void)law.number("hardening_ratio", {.low = 0.0, .high = 1.0, .high_open = true}, 0.0);
  }
  (void)law.number("stiffness_n_per_m", kPositive);
  law.finish();
}

void read_rig(Section rig) {
  (void)rig.choice("type", {"simulated", "udp"});
  (void)rig.boolean("armed", false);
  if (auto sensors = rig.optional_section("sensors")) {
    (void)sensors->number("force_noise_n", kNotNegative, 0.0);
    (void)sensors->integer("seed", 0, std::numeric_limits<std::int64_t>::max(), 0);
    sensors->finish();
  }
  if (auto specimen = rig.optional_section("specimen")) read_law(*specimen);
  rig.finish();
}

void read_substructure(Section substructure) {
  (void)substructure.text("id");
  (void)substructure.choice("kind", {"experimental", "numerical"});
  const std::vector<Section> interface = substructure.sections("interface", true);
  for (Section dof : interface) {
    (void)dof.text("dof");
    (void)dof.text("relative_to", "ground");
    dof.finish();
  }
  if (substructure.has("initial_stiffness_n_per_m"))
    (void)substructure.matrix("initial_stiffness_n_per_m", interface.size(), interface.size());
  if (auto rig = substructure.optional_section("rig")) read_rig(*rig);
  if (auto model = substructure.optional_section("model")) read_law(*model);
  (void)substructure.number("force_n_max", kPositive, std::numeric_limits<double>::infinity());
  substructure.finish();
}

/// Reads with every reader there is.
void read_scenario(Section root) {
  (void)root.choice("schema", {"hybridtest/1"});
  (void)root.text("name");
  Section time = root.section("time");
  (void)time.choice("mode", {"lockstep", "paced"}, "lockstep");
  (void)time.number("step_s", kPositive);
  (void)time.number("duration_s", kPositive);
  time.finish();
  Section structure = root.section("structure");
  const std::vector<std::string> dofs = structure.names("degrees_of_freedom");
  (void)structure.numbers_by_name("mass_kg", dofs, kPositive);
  if (structure.has("stiffness_n_per_m")) (void)structure.matrix("stiffness_n_per_m", 0, 0);
  if (structure.has("ratios")) (void)structure.numbers("ratios", 0, {.low = 0.0, .high = 1.0});
  if (structure.has("modes")) (void)structure.integers("modes", 1, 100);
  structure.finish();
  for (const Section& substructure : root.sections("substructures")) read_substructure(substructure);
  if (auto labels = root.optional_section("labels"))
    for (const std::string& key : labels->keys()) (void)labels->text(key);
  root.finish();
}

std::vector<std::string> overrides_of(std::string_view text) {
  constexpr std::string_view kMark = "#set ";
  std::vector<std::string> overrides;
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    if (line.starts_with(kMark)) overrides.emplace_back(line.substr(kMark.size()));
    text.remove_prefix(line.size() < text.size() ? line.size() + 1 : line.size());
  }
  return overrides;
}

std::string effective_of(std::string_view text) {
  Document document = Document::parse(text, "effective");
  read_scenario(document.root());
  document.throw_if_errors();
  return document.effective();
}

}  // namespace

ConfigFuzzOutcome fuzz_config(const std::uint8_t* bytes, std::size_t size) {
  const std::string_view text{reinterpret_cast<const char*>(bytes), size};
  try {
    Document document = Document::parse(text, "fuzz", overrides_of(text));
    read_scenario(document.root());
    const std::string effective = document.effective();
    try {
      document.throw_if_errors();
    } catch (const ConfigError& error) {
      HYBRIDTEST_ASSERT(!error.issues().empty());
      return ConfigFuzzOutcome::with_errors;
    }
    HYBRIDTEST_ASSERT(effective_of(effective) == effective);
    return ConfigFuzzOutcome::accepted;
  } catch (const ConfigError& error) {
    HYBRIDTEST_ASSERT(!error.issues().empty());
    return ConfigFuzzOutcome::refused;
  }
}

}  // namespace hybridtest

#ifdef HYBRIDTEST_LIBFUZZER
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  (void)hybridtest::fuzz_config(bytes, size);
  return 0;
}
#endif
