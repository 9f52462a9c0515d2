#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "validation/blind_batches/make_batch.hpp"
#include "validation/blind_batches/sealed_batch.hpp"

namespace hybridtest::blind {

/// Diagnoses a case into a directory: diagnosis.json and whatever else. Throws where it cannot.
using DiagnoseCase = std::function<void(const CaseFiles& files, const std::filesystem::path& out)>;

struct RunOutcome {
  std::size_t answered = 0;
  std::vector<std::string> failures;  // "case_0007: …"
};

/// Diagnoses every case of a batch that ANSWERS does not answer yet, then seals the answers. A
/// case that fails stays without an answer, which is scored as a wrong one; the others go on. No key is needed.
/// @throws std::runtime_error for a changed batch, and for answers that were sealed and changed.
[[nodiscard]] RunOutcome run_batch(const std::filesystem::path& batch, const std::filesystem::path& answers,
                                   const DiagnoseCase& diagnose, const Digest& digest, const ForEach& for_each);

}  // namespace hybridtest::blind
