#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "validation/blind_batches/plant/blind_case.hpp"

/// Files of a batch; see docs/blind_batches.md.
namespace hybridtest::blind {

/// SHA-256 of a text, hexadecimal.
using Digest = std::function<std::string(std::string_view)>;

/// `case_0001` for 0.
[[nodiscard]] std::string case_name(std::size_t index);

/// The user's model of one or two degrees of freedom; depends on the sites alone.
[[nodiscard]] std::string site_yaml(const std::vector<Site>& sites);
/// The sites of a case, in the order of its columns.
[[nodiscard]] std::vector<Site> sites_of(const CaseSetting& setting);

/// Header of names and units, one row per sample; of several degrees of freedom with _1, _2. All numbers have the
/// same width, so that the size of a file shows nothing but its length.
[[nodiscard]] std::string recording_csv(const std::vector<PlantRecording>& recordings, const RecordedColumns& columns,
                                        double rate_hz);
/// Of a case: the recordings to fit, then the one held out.
[[nodiscard]] std::vector<std::string> case_csv(const BlindCase& blind_case);

/// A case's entry in the key.
[[nodiscard]] nlohmann::ordered_json truth_json(const std::string& name, const BlindCase& blind_case);

[[nodiscard]] std::string_view name_of(TruthClass kind) noexcept;

/// A case as given to the diagnosis.
struct CaseFiles {
  std::string name;
  std::filesystem::path site;
  std::vector<std::filesystem::path> fit;
  std::filesystem::path held_out;
};

/// The text of a file of a batch, its key or its answers. @throws ConfigError if it cannot be read.
[[nodiscard]] std::string read_batch_file(const std::filesystem::path& path);

/// The cases of a batch, after its files were checked against batch.json. The key is not needed.
/// @throws std::runtime_error for a batch that is incomplete or changed.
[[nodiscard]] std::vector<CaseFiles> open_batch(const std::filesystem::path& batch, const Digest& digest);

/// Writes ANSWERS/answers.json: the SHA-256 of each existing answer, and of the batch.
/// @returns the number of answers.
std::size_t seal_answers(const std::filesystem::path& batch, const std::filesystem::path& answers,
                         const Digest& digest);

/// The text of a batch's key. @throws std::runtime_error if its hash differs from that in batch.json.
[[nodiscard]] std::string open_key(const std::filesystem::path& batch, const std::filesystem::path& key,
                                   const Digest& digest);

struct GivenAnswers {
  bool are_sealed = false;                        // answers.json exists and matches the answers
  std::vector<std::optional<std::string>> texts;  // of diagnosis.json, one per name
};

/// The answers to the named cases, ANSWERS/<case>/diagnosis.json.
/// @throws std::runtime_error when they were sealed and have changed since, or are sealed for another batch.
[[nodiscard]] GivenAnswers open_answers(const std::filesystem::path& batch, const std::filesystem::path& answers,
                                        const std::vector<std::string>& names, const Digest& digest);

struct MakeSettings {
  std::size_t cases = 0;
  std::uint64_t seed = 0;
  std::filesystem::path directory;
  std::filesystem::path key;  // file, outside of the directory
};

/// Calls one(i) for each of the named cases, each once, in any order, on any threads; throws what one of them throws.
using ForEach = std::function<void(const std::vector<std::string>& names, const std::function<void(std::size_t)>& one)>;

/// Writes a batch and, in a separate file, its key. batch.json contains the SHA-256 of each file of the batch and of
/// the key. Only the key contains the seed.
/// @throws std::runtime_error if the directory is not empty or cannot be written.
void make_batch(const MakeSettings& settings, const Digest& digest, const ForEach& for_each);

/// Diagnoses a case and writes diagnosis.json and other files into a directory. Throws on failure.
using DiagnoseCase = std::function<void(const CaseFiles& files, const std::filesystem::path& out)>;

struct RunOutcome {
  std::size_t answered = 0;
  std::vector<std::string> failures;  // "case_0007: …"
};

/// Diagnoses every case of a batch that has no answer in ANSWERS yet, then seals the answers. A
/// case that fails has no answer, which is scored as a wrong one; the other cases continue. No key is needed.
/// @throws std::runtime_error for a changed batch, and for answers that were sealed and changed.
[[nodiscard]] RunOutcome run_batch(const std::filesystem::path& batch, const std::filesystem::path& answers,
                                   const DiagnoseCase& diagnose, const Digest& digest, const ForEach& for_each);

}  // namespace hybridtest::blind
