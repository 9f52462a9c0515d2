#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "validation/blind_batches/batch.hpp"
#include "validation/blind_batches/score/answers.hpp"

namespace hybridtest::blind {

/// One result of a score, and its target.
struct Figure {
  std::string name;                  // words_with_underscores
  std::optional<Estimate> estimate;  // empty if no case applies to it
  std::optional<double> at_least;    // targets
  std::optional<double> at_most;

  /// Whether the end of the interval that faces the target meets it. Of a range: the lower end its lower limit, and
  /// the figure itself its upper one.
  [[nodiscard]] std::optional<bool> is_met() const;
};

/// Truth class -> verdict -> how often.
using ConfusionMatrix = std::map<std::string, std::map<std::string, std::size_t>>;

/// Cases whose gap stands between two multiples of the floor.
struct SeverityRow {
  double from = 0.0;
  double below = 0.0;
  std::vector<Figure> figures;  // the same for each row
};

struct Score {
  std::size_t cases = 0;
  std::size_t clear_cases = 0;
  ConfusionMatrix confusion;                                  // of all; `hidden`: effects below the floor
  ConfusionMatrix clear_confusion;                            // at twice the floor or above
  std::vector<Figure> overall;                                // without targets
  std::vector<Figure> clear;                                  // the results that have targets
  std::vector<SeverityRow> severities;                        // of all with an effect
  std::map<std::string, std::array<std::size_t, 2>> effects;  // clear ones: right, of how many
  std::vector<MarkedCase> wrong;                              // clear ones, largest gap first
};

[[nodiscard]] Score score_of(const std::vector<MarkedCase>& cases);

/// Tables for a terminal: confusion, figures with intervals, targets met or missed, the wrong cases.
[[nodiscard]] std::string score_text(const Score& score);

/// The figures of the clear cases as a row of the table in docs/blind_batches.md, without date, commit and seed.
[[nodiscard]] std::string published_row(const Score& score);

/// Everything of it, schema hybridtest/blind_score/2.
[[nodiscard]] nlohmann::ordered_json score_json(const Score& score);

struct BatchScore {
  std::string text;  // for the terminal
  std::string json;  // hybridtest/blind_score/2
};

/// Where a batch, its answers and its key are.
struct AnsweredBatch {
  std::filesystem::path batch;
  std::filesystem::path answers;
  std::filesystem::path key;
};

/// Opens the keys of one or more batches and scores the answers to all of them together.
/// @throws std::runtime_error for a key or sealed answers that have changed, and for an answer that is
///         not a diagnosis.json; the message names the case.
[[nodiscard]] BatchScore score_batches(const std::vector<AnsweredBatch>& batches, const Digest& digest);

}  // namespace hybridtest::blind
