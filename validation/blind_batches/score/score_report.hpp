#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "validation/blind_batches/score/score.hpp"

namespace hybridtest::blind {

/// Tables for a terminal: confusion, figures with intervals, targets met or missed, the wrong cases.
[[nodiscard]] std::string score_text(const Score& score);

/// Everything of it, schema hybridtest/blind_score/1.
[[nodiscard]] nlohmann::ordered_json score_json(const Score& score);

}  // namespace hybridtest::blind
