#include "scenario/catalogue/formula.hpp"

#include <muParser.h>
#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "core/config_error.hpp"
#include "core/parameters/unit_of.hpp"
#include "core/text/scalar.hpp"
#include "plant/effects/recorded_input.hpp"
#include "plant/effects/specimen/degradation_drivers.hpp"

namespace hybridtest {

namespace {

constexpr std::array kVariables{
    FormulaVariable{"x", "displacement [m]"},
    FormulaVariable{"v", "velocity [m/s]"},
    FormulaVariable{"a", "acceleration [m/s²]"},
    FormulaVariable{"t", "time [s]"},
    FormulaVariable{"F", "force of the specimen's law and of the effects before this one [N]"},
    FormulaVariable{"path", "travelled path [m]"},
    FormulaVariable{"peak", "largest displacement so far, either way [m]"},
    FormulaVariable{"energy", "dissipated energy so far [J]"},
    FormulaVariable{"cycles", "cycles about zero so far"},
};
enum Place : std::size_t { kX, kV, kA, kT, kF, kPath, kPeak, kEnergy, kCycles };

/// So many numbers can still be told from each other.
constexpr std::size_t kNumbersMax = 8;

/// A formula with places for what it uses.
class Evaluator {
 public:
  /// @throws ConfigError
  explicit Evaluator(const Formula& formula) : numbers_(formula.numbers.size()) {
    try {
      for (std::size_t i = 0; i < kVariables.size(); ++i) {
        parser_.DefineVar(std::string{kVariables[i].name}, &variables_[i]);
      }
      if (!formula.input.empty()) parser_.DefineVar(formula.input, &input_);
      for (std::size_t i = 0; i < numbers_.size(); ++i) parser_.DefineVar(formula.numbers[i].name, &numbers_[i]);
      parser_.SetExpr(formula.added_force_n);
      for (const auto& used : parser_.GetUsedVar()) used_.push_back(used.first);
      static_cast<void>(value());  // compiles it, for good
      if (parser_.GetNumResults() != 1) throw ConfigError{"it has more than one value"};
    } catch (const mu::Parser::exception_type& error) {
      throw ConfigError{in_words(error)};
    }
  }
  // The parser points at the places.
  Evaluator(const Evaluator&) = delete;
  Evaluator& operator=(const Evaluator&) = delete;
  Evaluator(Evaluator&&) = delete;
  Evaluator& operator=(Evaluator&&) = delete;
  ~Evaluator() = default;

  [[nodiscard]] double value() const { return parser_.Eval(); }
  [[nodiscard]] double& variable(std::size_t place) noexcept { return variables_[place]; }
  [[nodiscard]] double& input() noexcept { return input_; }
  [[nodiscard]] std::vector<double>& numbers() noexcept { return numbers_; }
  [[nodiscard]] bool uses(std::string_view name) const { return std::ranges::find(used_, name) != used_.end(); }
  [[nodiscard]] bool has_function(const std::string& name) const { return parser_.GetFunDef().contains(name); }

 private:
  static std::string in_words(const mu::Parser::exception_type& error) {
    switch (error.GetCode()) {
      case mu::ecUNASSIGNABLE_TOKEN:
        return "'" + error.GetToken() +
               "' is none of its parameters, its input, the variables and the functions; expected a formula of these";
      case mu::ecUNEXPECTED_EOF: return "it ends too early";
      default: return error.GetMsg();
    }
  }

  std::array<double, kVariables.size()> variables_{};
  double input_ = 0.0;
  std::vector<double> numbers_;
  mu::Parser parser_;
  std::vector<std::string> used_;
};

class FormulaForce final : public Effect {
 public:
  FormulaForce(const Formula& formula, std::span<const double> values)
      : formula_{formula}, input_{0.0, formula.input.empty() ? 0.0 : values.back()} {
    std::ranges::copy(values.first(formula.numbers.size()), formula_.numbers().begin());
  }
  void follow_input(std::size_t position) noexcept override { input_.follow(position); }
  void after(const StageSample& sample, const Motion& /*motion*/, double& force_n) noexcept override {
    formula_.variable(kX) = sample.motion.displacement_m;
    formula_.variable(kV) = sample.motion.velocity_m_per_s;
    formula_.variable(kA) = sample.motion.acceleration_m_per_s2;
    formula_.variable(kT) = sample.time_s;
    formula_.variable(kF) = force_n;
    formula_.variable(kPath) = path_.after(sample);
    formula_.variable(kPeak) = peak_.after(sample);
    formula_.variable(kEnergy) = energy_.after(sample);
    formula_.variable(kCycles) = cycles_.after(sample);
    formula_.input() = input_.beyond_reference(sample);
    force_n += formula_.value();
  }
  void reset() noexcept override {
    path_ = {};
    peak_ = {};
    energy_ = {};
    cycles_ = {};
  }

 private:
  Evaluator formula_;
  RecordedInput input_;
  TravelledPath path_;
  LargestDisplacement peak_;
  DissipatedEnergy energy_;
  CountedCycles cycles_;
};

/// Which numbers are linear, found by trying: over many values of everything, the force with all of them is the sum of
/// the forces with each alone, in proportion to it, and without them there is none.
class Trials {
 public:
  explicit Trials(const Formula& formula) : formula_{formula}, evaluator_{formula} {}

  /// The largest set of numbers, as bits.
  [[nodiscard]] std::size_t linear_ones() {
    std::size_t best = 0;
    for (std::size_t set = 1; set < (std::size_t{1} << formula_.numbers.size()); ++set) {
      if (std::popcount(set) > std::popcount(best) && is_linear(set)) best = set;
    }
    return best;
  }
  /// Whether the force is absent where this number is zero.
  [[nodiscard]] bool is_absent_without(std::size_t number) {
    const FormulaNumber& range = formula_.numbers[number];
    if (range.low > 0.0 || range.high < 0.0) return false;
    return holds([&](std::size_t trial) {
      draw(trial);
      evaluator_.numbers()[number] = 0.0;
      return std::pair{evaluator_.value(), 0.0};
    });
  }

 private:
  static constexpr std::size_t kTrials = 64;
  static constexpr double kRounding = 1e-9;

  [[nodiscard]] bool is_linear(std::size_t set) {
    for (std::size_t i = 0; i < formula_.numbers.size(); ++i) {
      if (has(set, i) && !is_bounded(formula_.numbers[i])) return false;
    }
    return holds([&](std::size_t trial) {
      draw(trial);
      const std::vector<double> drawn = evaluator_.numbers();
      const double together = evaluator_.value();
      for (std::size_t i = 0; i < drawn.size(); ++i) {
        if (has(set, i)) evaluator_.numbers()[i] = 0.0;
      }
      double sum = evaluator_.value();  // without any, which has to be nothing
      for (std::size_t i = 0; i < drawn.size(); ++i) {
        if (!has(set, i)) continue;
        const double whole = formula_.numbers[i].high != 0.0 ? formula_.numbers[i].high : formula_.numbers[i].low;
        evaluator_.numbers()[i] = whole;
        sum += evaluator_.value() * drawn[i] / whole;
        evaluator_.numbers()[i] = 0.0;
      }
      const double nothing = evaluator_.value();
      return nothing == 0.0 ? std::pair{together, sum} : std::pair{nothing, 0.0};
    });
  }
  static bool has(std::size_t set, std::size_t number) { return ((set >> number) & 1U) != 0U; }
  static bool is_bounded(const FormulaNumber& number) { return number.low > -kUnbounded && number.high < kUnbounded; }

  /// Whether the two values of each trial agree; those that are no numbers say nothing.
  template <class Pair>
  [[nodiscard]] bool holds(Pair&& pair) {
    bool any = false;
    for (std::size_t trial = 0; trial < kTrials; ++trial) {
      const auto [one, other] = pair(trial);
      if (!std::isfinite(one) || !std::isfinite(other)) continue;
      if (std::abs(one - other) > kRounding * std::max(std::abs(one), std::abs(other))) return false;
      any = any || one != 0.0 || other == 0.0;
    }
    return any;
  }
  /// Values of everything, either sign, from small to large.
  void draw(std::size_t trial) {
    std::size_t place = 0;
    const auto share = [&] {  // evenly over 0 to 1, each place in another order
      const double step = std::sqrt(static_cast<double>(++place) + 1.0);
      const double product = step * (static_cast<double>(trial) + 0.5);
      return product - std::floor(product);
    };
    const auto signed_value = [&] {
      const double magnitude = std::pow(10.0, -4.0 + 8.0 * share());
      return share() < 0.5 ? -magnitude : magnitude;
    };
    for (std::size_t i = 0; i < kVariables.size(); ++i) {
      evaluator_.variable(i) = i >= kPath || i == kT ? std::abs(signed_value()) : signed_value();
    }
    evaluator_.input() = signed_value();
    for (std::size_t i = 0; i < formula_.numbers.size(); ++i) {
      const FormulaNumber& range = formula_.numbers[i];
      evaluator_.numbers()[i] = range.low + share() * (range.high - range.low);
    }
  }

  const Formula& formula_;
  Evaluator evaluator_;
};

EffectTraits traits_of(const Evaluator& formula) {
  using enum EffectFamily;
  EffectTraits traits{.follows_derivatives = formula.uses("v") || formula.uses("a")};
  traits.needs_time = traits.follows_derivatives || formula.uses("t");
  const auto uses_any = [&](const auto&... names) { return (formula.uses(names) || ...); };
  traits.family = uses_any("a")                                       ? mass
                  : uses_any("v")                                     ? rate
                  : uses_any("path", "peak", "energy", "cycles", "t") ? degradation
                  : uses_any("x")                                     ? position
                                                                      : load;
  return traits;
}

void require_names(const Formula& formula, const Evaluator& evaluator) {
  std::vector<std::string> taken;
  const auto require_free = [&](const std::string& name, std::string_view what) {
    if (!is_input_name(name)) {
      throw ConfigError{"'" + name + "' is no name of " + std::string{what} +
                        "; expected lower-case letters, digits and '_', a letter first"};
    }
    const bool is_variable = std::ranges::find(kVariables, name, &FormulaVariable::name) != kVariables.end();
    if (is_variable || evaluator.has_function(name) || std::ranges::find(taken, name) != taken.end()) {
      throw ConfigError{"the name '" + name + "' of " + std::string{what} + " is taken; expected another one"};
    }
    taken.push_back(name);
  };
  if (!formula.input.empty()) require_free(formula.input, "a recorded input");
  for (const FormulaNumber& number : formula.numbers) {
    require_free(number.name, "a parameter");
    if (number.name == kNominalInput.name) throw ConfigError{"the name 'nominal_input' of a parameter is taken"};
    if (!(number.low < number.high)) throw ConfigError{"the range of '" + number.name + "' has no width"};
  }
}

bool assigns(const std::string& text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '=') continue;
    if (i + 1 < text.size() && text[i + 1] == '=') {
      ++i;
    } else if (i == 0 || std::string_view{"<>!"}.find(text[i - 1]) == std::string_view::npos) {
      return true;
    }
  }
  return false;
}

/// What an EffectType points to.
struct Entry {
  Formula formula;
  std::string equation;
  std::vector<std::string> units;
  std::vector<EffectParameter> parameters;
  EffectType type;
};

void fill(Entry& entry) {
  using enum EffectInterface;
  const Formula& formula = entry.formula;
  if (!is_input_name(formula.name) || formula.name == "formula" || find_effect(specimen, formula.name) != nullptr) {
    throw ConfigError{"'" + formula.name +
                      "' cannot be the name of a formula; expected lower-case letters, digits and '_', a letter first, "
                      "and none that an effect of the specimen has"};
  }
  if (formula.numbers.size() > kNumbersMax) {
    throw ConfigError{"it has " + std::to_string(formula.numbers.size()) + " parameters; expected " +
                      std::to_string(kNumbersMax) + " at most"};
  }
  if (assigns(formula.added_force_n)) throw ConfigError{"'=' gives a value to something; expected '==' to compare"};
  const Evaluator nothing{{.name = {}, .added_force_n = "0", .input = {}, .numbers = {}}};
  require_names(formula, nothing);
  const Evaluator evaluator{formula};
  const auto require_used = [&](const std::string& name) {
    if (!evaluator.uses(name)) throw ConfigError{"it does not use '" + name + "'"};
  };
  std::ranges::for_each(formula.numbers, require_used, &FormulaNumber::name);
  if (!formula.input.empty()) require_used(formula.input);
  entry.equation = "F = F0 + " + formula.added_force_n;
  Trials trials{formula};
  const std::size_t linear = trials.linear_ones();
  for (const FormulaNumber& number : formula.numbers) entry.units.push_back(unit_of(number.name));
  for (std::size_t i = 0; i < formula.numbers.size(); ++i) {
    const FormulaNumber& number = formula.numbers[i];
    const bool is_linear = ((linear >> i) & 1U) != 0U;
    entry.parameters.push_back({.name = number.name,
                                .unit = entry.units[i],
                                .what = "a number of the formula",
                                .low = number.low,
                                .high = number.high,
                                .neutral = is_linear || trials.is_absent_without(i) ? 0.0 : kNoNeutral,
                                .is_linear = is_linear});
  }
  if (!formula.input.empty()) entry.parameters.push_back(kNominalInput);
  entry.type = {
      .interface = specimen,
      .name = formula.name,
      .equation = entry.equation,
      .source = "the user's formula",
      .traits = traits_of(evaluator),
      .parameters = entry.parameters,
      .make = [&formula](std::span<const double> values, double /*sample_period_s*/) -> std::unique_ptr<Effect> {
        return std::make_unique<FormulaForce>(formula, values);
      },
      .input = formula.input,
      .formula = &formula};
}

}  // namespace

std::span<const FormulaVariable> formula_variables() noexcept { return kVariables; }

const EffectType& formula_effect(const Formula& formula) {
  static std::mutex mutex;
  static std::map<Formula, Entry> known;
  const std::scoped_lock lock{mutex};
  const auto found = known.find(formula);
  if (found != known.end()) return found->second.type;
  Entry& entry = known[formula];
  entry.formula = formula;
  try {
    fill(entry);
  } catch (const ConfigError&) {
    known.erase(formula);
    throw;
  }
  return entry.type;
}

namespace {

/// A text that may go over several lines as one line.
std::string in_one_line(const std::string& text) {
  std::string line;
  for (const char c : text) {
    const bool is_space = std::isspace(static_cast<unsigned char>(c)) != 0;
    if (!is_space) {
      line += c;
    } else if (!line.empty() && line.back() != ' ') {
      line += ' ';
    }
  }
  while (line.ends_with(' ')) line.pop_back();
  return line;
}

}  // namespace

const EffectType& read_formula(config::Section& section,
                               const std::function<FormulaNumber(config::Section&, const std::string&)>& read_number) {
  Formula formula{.name = section.text("name"),
                  .added_force_n = in_one_line(section.text("added_force_n")),
                  .input = section.has_optional("input") ? section.text("input") : std::string{},
                  .numbers = {}};
  if (std::optional<config::Section> numbers = section.optional_section("parameters")) {
    for (const std::string& name : numbers->keys()) formula.numbers.push_back(read_number(*numbers, name));
    numbers->finish();
  }
  try {
    return formula_effect(formula);
  } catch (const ConfigError& error) {
    section.error("added_force_n", "the formula '" + formula.name + "': " + error.what());
    return formula_effect({.name = "no_force", .added_force_n = "0", .input = {}, .numbers = {}});
  }
}

std::string written_formula(const Formula& formula, std::span<const double> values) {
  std::string lines = "name: " + formula.name + "\n";
  lines += "added_force_n: " + written_text(formula.added_force_n) + "\n";
  if (!formula.input.empty()) lines += "input: " + formula.input + "\n";
  if (!formula.numbers.empty()) lines += "parameters:\n";
  for (std::size_t i = 0; i < formula.numbers.size(); ++i) {
    lines += "  " + formula.numbers[i].name + ": " + written_number(values[i]) + "\n";
  }
  if (!formula.input.empty()) lines += std::string{kNominalInput.name} + ": " + written_number(values.back()) + "\n";
  return lines;
}

}  // namespace hybridtest
