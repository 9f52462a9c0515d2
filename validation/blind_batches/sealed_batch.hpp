#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "validation/blind_batches/batch_files.hpp"

namespace hybridtest::blind {

/// A case as whoever diagnoses it gets it.
struct CaseFiles {
  std::string name;
  std::filesystem::path site;
  std::vector<std::filesystem::path> fit;
  std::filesystem::path held_out;
};

/// The whole of a file. @throws std::runtime_error where it cannot be read.
[[nodiscard]] std::string read_whole_file(const std::filesystem::path& path);

/// The cases of a batch, after its files were found to be those that batch.json names. The key is not needed.
/// @throws std::runtime_error for a batch that is incomplete or changed.
[[nodiscard]] std::vector<CaseFiles> open_batch(const std::filesystem::path& batch, const Digest& digest);

/// Writes ANSWERS/answers.json: the SHA-256 of each answer that is there, and of the batch.
/// @returns how many there are.
std::size_t seal_answers(const std::filesystem::path& batch, const std::filesystem::path& answers,
                         const Digest& digest);

/// The text of a batch's key. @throws std::runtime_error when it is not the one whose hash the batch names.
[[nodiscard]] std::string open_key(const std::filesystem::path& batch, const std::filesystem::path& key,
                                   const Digest& digest);

struct GivenAnswers {
  bool are_sealed = false;                        // there is an answers.json, and it fits
  std::vector<std::optional<std::string>> texts;  // of diagnosis.json, one per name
};

/// The answers to the named cases, ANSWERS/<case>/diagnosis.json.
/// @throws std::runtime_error when they were sealed and have changed since, or are sealed for another batch.
[[nodiscard]] GivenAnswers open_answers(const std::filesystem::path& batch, const std::filesystem::path& answers,
                                        const std::vector<std::string>& names, const Digest& digest);

}  // namespace hybridtest::blind
