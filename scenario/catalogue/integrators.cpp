#include "scenario/catalogue/integrators.hpp"

#include "coordinator/integrators/alpha_operator_splitting.hpp"
#include "coordinator/integrators/central_difference.hpp"
#include "coordinator/integrators/explicit_newmark.hpp"
#include "coordinator/integrators/generalised_alpha.hpp"
#include "coordinator/integrators/implicit_newmark.hpp"
#include "coordinator/integrators/kr_alpha.hpp"
#include "coordinator/integrators/rosenbrock_w.hpp"

namespace hybridtest {
namespace {

using config::Section;

template <class Method>
PartType<IntegratorReading> plain(const std::string& type, const std::string& source) {
  IntegratorReading reading{type, type, source, Method::kNeeds,
                            [](const LinearStructure& structure, double step_s, const InitialMotion& initial) {
                              return std::make_unique<Method>(structure, step_s, initial);
                            }};
  return {type, [reading](Section&) { return reading; }};
}

template <class Method>
IntegratorReading reading_with(const std::string& type, const std::string& source,
                               typename Method::Parameters parameters) {
  ParameterTable table;
  parameters.serialize(table);
  std::string text = type;
  for (const ParameterTable::Row& row : table.rows())
    text += (text == type ? " with " : ", ") + row.key + " " + row.fallback;
  return {type, text, source, Method::needs(parameters),
          [parameters](const LinearStructure& structure, double step_s, const InitialMotion& initial) {
            return std::make_unique<Method>(parameters, structure, step_s, initial);
          }};
}

template <class Method>
PartType<IntegratorReading> with_parameters(const std::string& type, const std::string& source) {
  return {
      type,
      [type, source](Section& section) { return reading_with<Method>(type, source, read_parameters<Method>(section)); },
      describe<Method>};
}

/// CR is KR-alpha without numerical damping.
PartType<IntegratorReading> cr() {
  IntegratorReading reading = reading_with<KrAlpha>("cr", "Chen and Ricles, 2008", {.rho_inf = 1.0});
  reading.text = reading.type;
  return {reading.type, [reading](Section&) { return reading; }};
}

}  // namespace

const std::vector<PartType<IntegratorReading>>& integrators() {
  static const std::vector<PartType<IntegratorReading>> table{
      plain<CentralDifference>("central_difference", "Newmark, 1959, as differences"),
      plain<ExplicitNewmark>("explicit_newmark", "Newmark, 1959, with beta = 0"),
      cr(),
      with_parameters<KrAlpha>("kr_alpha", "Kolay and Ricles, 2014"),
      with_parameters<AlphaOperatorSplitting>("alpha_operator_splitting", "Combescure and Pegon, 1997"),
      with_parameters<GeneralisedAlpha>("generalised_alpha", "Schellenberg, Mahin and Fenves, 2009"),
      with_parameters<ImplicitNewmark>("implicit_newmark", "Newmark, 1959, iterated"),
      plain<RosenbrockW>("rosenbrock_w", "Bursi, Gonzalez-Buelga, Vulcan, Neild and Wagg, 2008"),
  };
  return table;
}

IntegratorReading read_integrator(Section section) { return read_type(section, integrators()); }

}  // namespace hybridtest
