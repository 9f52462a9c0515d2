#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "validation/blind_batches/plant/blind_case.hpp"

namespace hybridtest::blind {

/// A result with its 95 % interval.
struct Estimate {
  double value = 0.0;
  double low = 0.0;
  double high = 0.0;
  std::size_t count = 0;  // number of values
};

/// Share of successes with Wilson's score interval (J. Am. Stat. Assoc. 22, 1927). Nothing for no trials.
[[nodiscard]] std::optional<Estimate> proportion(std::size_t successes, std::size_t trials);

/// Mean, median … of some of 0 … count - 1, drawn with repetition.
using Statistic = std::function<double(const std::vector<std::size_t>& drawn)>;

/// The statistic of all, with the percentile interval of 2000 bootstrap draws (Efron, Ann. Stat. 7, 1979)
/// from a fixed seed. Nothing for no values.
[[nodiscard]] std::optional<Estimate> bootstrap(std::size_t count, const Statistic& statistic);

[[nodiscard]] std::optional<Estimate> mean(const std::vector<double>& values);
[[nodiscard]] std::optional<Estimate> median(const std::vector<double>& values);

/// A given probability, and whether the answer was right.
struct Forecast {
  double probability = 0.0;
  bool came_true = false;
};

/// Expected calibration error over ten equally wide bins (Naeini, Cooper and Hauskrecht, AAAI 2015).
[[nodiscard]] std::optional<Estimate> calibration_error(const std::vector<Forecast>& forecasts);

struct AnsweredParameter {
  double value = 0.0;
  std::optional<std::pair<double, double>> ci95;
};

struct AnsweredCause {
  std::string interface;
  std::string effect;
  std::string law = {};  // of `hysteresis_law`, or that of `yielding`
  double probability = 0.0;
  std::map<std::string, AnsweredParameter> parameters;
};

/// The fields of a diagnosis.json (hybridtest/diagnosis/1) that scoring uses.
struct Answer {
  std::string verdict;
  std::vector<AnsweredCause> causes;            // largest share first; of a set, most probable first
  std::vector<AnsweredCause> corrections = {};  // numbers of the model that are slightly off, said to be no causes
  /// The interface of the largest share, and those whose own verdict is `unknown`.
  std::vector<std::string> faulty_interfaces;
  std::optional<double> variance_removed;  // at the interface, held out

  [[nodiscard]] bool names_a_cause() const { return verdict == "named" || verdict == "set" || verdict == "partial"; }
  [[nodiscard]] bool is_set() const { return verdict == "set"; }
};

/// @throws std::runtime_error that names what is missing or wrong.
[[nodiscard]] Answer read_answer(std::string_view json);

/// Everything that a diagnosis can say, in the order of the confusion matrix; then `missing`, for
/// a case without an answer.
[[nodiscard]] const std::vector<std::string>& known_verdicts();

/// A case of the key, as it was written by truth_json().
struct KeyCase {
  std::string name;
  TruthClass truth = TruthClass::none;
  PlantEffects effects;
  PlantEffects besides{};  // numbers of the model that are slightly wrong as well
  // One for each of `effects`.
  std::vector<double> effect_gaps_to_floor{};
  std::vector<std::vector<Cause>> effect_acceptable{};
  std::vector<Cause> acceptable;
  std::vector<Cause> acceptable_in_part{};  // right in an answer `partial` only
  std::vector<Cause> tolerated{};           // neither right nor wrong
  bool is_separable = true;
  bool is_closed_loop = false;
  std::string gap_at;
  double gap_to_floor = 0.0;
  double held_out_gap_to_floor = 0.0;
  double variance_removed = 0.0;

  /// False where the plant could not compute the gap: how clear the case is, nobody knows.
  [[nodiscard]] bool can_be_scored() const noexcept;
};

/// @throws std::runtime_error if the text is not a key.
[[nodiscard]] std::vector<KeyCase> read_key(std::string_view json);

struct ParameterError {
  std::string name;  // coulomb_friction.friction_force_n
  double relative = 0.0;
  std::optional<bool> is_in_interval;
};

/// The answer with a correction counted as a cause where it is an acceptable one: a wrong number that was found is
/// found, however small. Behind the causes; a `none` with one becomes `named`.
[[nodiscard]] Answer with_true_corrections(const KeyCase& key, Answer answer);

/// The answer without the causes that the key tolerates. A set with one of them, and a list of nothing else, says
/// `none` of the effect; a `partial` of nothing else says `unknown`.
[[nodiscard]] Answer without_tolerated(const KeyCase& key, Answer given);

/// An answer compared with the truth. Fields that do not apply to a case are empty.
struct MarkedCase {
  KeyCase key;
  Answer given;                                  // as it was
  Answer answer;                                 // without what is tolerated
  std::optional<bool> is_interface_right;        // all but none
  std::optional<bool> is_effect_right;           // named, law, pair
  std::optional<bool> is_partial_right;          // partial: the effect of the library found, and the rest left open
  std::optional<bool> is_single_name_right;      // named, where no other cause is acceptable
  std::optional<bool> has_spurious_cause;        // named, law, with the first cause right: another beside it is not
  bool is_sure_and_wrong = false;                // a name or set with a probability of 0.9 or more, and wrong
  std::optional<bool> is_falsely_named;          // none, unknown
  std::optional<bool> is_true_one_covered;       // named and answered by a set
  std::optional<bool> are_both_found;            // pair, each effect at twice the floor
  std::optional<std::size_t> causes_answered;    // named and answered by a name or set; named: 1
  std::optional<Forecast> forecast;              // where a cause is named
  std::optional<double> variance_short;          // true model's variance removed less the answer's, effect right
  std::vector<ParameterError> parameter_errors;  // of the effects
  std::vector<ParameterError> number_errors;     // of the numbers of the model that are slightly wrong

  /// Twice the floor or more in the first fit recording and the held-out one; or no effect is present.
  [[nodiscard]] bool is_clear() const;
  [[nodiscard]] bool is_wrong() const;
};

/// @param answer   nullopt: missing.
[[nodiscard]] MarkedCase mark(const KeyCase& key, const std::optional<Answer>& answer);

}  // namespace hybridtest::blind
