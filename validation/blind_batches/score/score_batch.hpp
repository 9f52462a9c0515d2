#pragma once

#include <filesystem>
#include <string>

#include "validation/blind_batches/batch_files.hpp"

namespace hybridtest::blind {

struct BatchScore {
  std::string text;  // for a person
  std::string json;  // hybridtest/blind_score/1
};

/// Opens the key of a batch and scores the answers to it.
/// @throws std::runtime_error for a key or sealed answers that have changed, and for an answer that is
///         no diagnosis.json, by the name of its case.
[[nodiscard]] BatchScore score_batch(const std::filesystem::path& batch, const std::filesystem::path& answers,
                                     const std::filesystem::path& key, const Digest& digest);

}  // namespace hybridtest::blind
