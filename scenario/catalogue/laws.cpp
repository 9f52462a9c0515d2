#include "scenario/catalogue/laws.hpp"

#include "mechanics/laws/bilinear.hpp"
#include "mechanics/laws/bouc_wen.hpp"
#include "mechanics/laws/bouc_wen_baber_noori.hpp"
#include "mechanics/laws/elastic.hpp"
#include "mechanics/laws/elastomer.hpp"
#include "mechanics/laws/friction.hpp"
#include "mechanics/laws/friction_pendulum.hpp"
#include "mechanics/laws/gap_spring.hpp"
#include "mechanics/laws/giuffre_menegotto_pinto.hpp"
#include "mechanics/laws/lead_rubber.hpp"
#include "mechanics/laws/mr_damper.hpp"
#include "mechanics/laws/parallel.hpp"
#include "mechanics/laws/peak_oriented.hpp"
#include "mechanics/laws/pinched_reloading.hpp"
#include "mechanics/laws/ramberg_osgood.hpp"
#include "mechanics/laws/self_centring.hpp"
#include "mechanics/laws/takeda.hpp"
#include "mechanics/laws/viscous.hpp"

namespace hybridtest {
namespace {

using config::Section;

template <class Part>
PartType<Maker<Law>> law(std::string name) {
  const auto read = [](Section& section) -> Maker<Law> {
    return [parameters = read_parameters<Part>(section)] { return std::make_unique<Part>(parameters); };
  };
  return {std::move(name), read, describe<Part>};
}

Maker<Law> read_parallel(Section& section) {
  const std::vector<Maker<Law>> makers = read_laws(section, "laws");
  if (makers.empty()) section.error("laws", "no law in parallel; expected at least one");
  return [makers] { return std::make_unique<Parallel>(make_all(makers)); };
}

void describe_parallel(ParameterTable& table) {
  table.add({.key = "laws",
             .what = "on the same degree of freedom; their forces add up",
             .values = "list of laws",
             .fallback = "—"});
}

}  // namespace

const std::vector<PartType<Maker<Law>>>& laws() {
  static const std::vector<PartType<Maker<Law>>> table{
      law<Elastic>("elastic"),
      law<Bilinear>("bilinear"),
      law<GiuffreMenegottoPinto>("giuffre_menegotto_pinto"),
      law<BoucWen>("bouc_wen"),
      law<BoucWenBaberNoori>("bouc_wen_baber_noori"),
      law<PeakOriented>("peak_oriented"),
      law<PinchedReloading>("pinching"),
      law<Takeda>("takeda"),
      law<SelfCentring>("self_centring"),
      law<RambergOsgood>("ramberg_osgood"),
      law<FrictionPendulum>("friction_pendulum"),
      law<LeadRubber>("lead_rubber"),
      law<MrDamper>("mr_damper"),
      law<Elastomer>("elastomer"),
      law<Friction>("friction"),
      law<GapSpring>("gap"),
      law<Viscous>("viscous"),
      {"parallel", read_parallel, describe_parallel},
  };
  return table;
}

Maker<Law> read_law(Section section) { return read_type(section, laws()); }

Maker<Law> read_specimen_law(Section section) {
  std::vector<PartType<Maker<Law>>> types{{"none", [](Section&) { return Maker<Law>{}; }}};
  types.insert(types.end(), laws().begin(), laws().end());
  return read_type(section, types);
}

std::vector<Maker<Law>> read_laws(Section& section, std::string_view key) {
  std::vector<Maker<Law>> makers;
  for (const Section& entry : section.sections(key, true)) makers.push_back(read_law(entry));
  return makers;
}

std::vector<std::unique_ptr<Law>> make_all(const std::vector<Maker<Law>>& makers) {
  std::vector<std::unique_ptr<Law>> made;
  for (const Maker<Law>& maker : makers) made.push_back(maker());
  return made;
}

}  // namespace hybridtest
