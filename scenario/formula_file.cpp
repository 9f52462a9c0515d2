#include "scenario/formula_file.hpp"

#include <algorithm>
#include <string>

#include "core/config/section.hpp"
#include "scenario/catalogue/formula.hpp"

namespace hybridtest {

namespace {

FormulaNumber read_range(config::Section& numbers, const std::string& name) {
  constexpr Range kSense{.low = -kUnbounded, .high = kUnbounded};
  config::Section range = numbers.section(name);
  FormulaNumber number{.name = name, .low = range.number("from", kSense), .high = range.number("to", kSense)};
  range.finish();
  if (number.low < number.high) return number;
  range.error("to", "expected more than 'from'");
  return {.name = name};
}

}  // namespace

std::vector<const EffectType*> read_formulas(const std::filesystem::path& file) {
  config::Document document = config::Document::load(file);
  config::Section root = document.root();
  std::vector<const EffectType*> formulas;
  for (config::Section entry : root.sections("formulas", true)) {
    const EffectType& formula = read_formula(entry, read_range);
    if (std::ranges::find(formulas, formula.name, &EffectType::name) != formulas.end()) {
      entry.error("name", "two formulas have the name '" + std::string{formula.name} + "'");
    }
    if (!entry.has("parameters")) {
      entry.error("parameters", "missing; expected at least one, with the range in which it is looked for");
    }
    entry.finish();
    formulas.push_back(&formula);
  }
  root.finish();
  document.throw_if_errors();
  return formulas;
}

}  // namespace hybridtest
