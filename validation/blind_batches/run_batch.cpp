#include "validation/blind_batches/run_batch.hpp"

#include <exception>
#include <system_error>

namespace hybridtest::blind {
namespace {

namespace fs = std::filesystem;

/// The answer appears under its name when it is whole: what an interrupted run left is done again.
void answer_case(const CaseFiles& files, const fs::path& answers, const DiagnoseCase& diagnose) {
  const fs::path unfinished = answers / (files.name + ".unfinished");
  fs::remove_all(unfinished);
  fs::create_directories(unfinished);
  diagnose(files, unfinished);
  fs::rename(unfinished, answers / files.name);
}

}  // namespace

RunOutcome run_batch(const fs::path& batch, const fs::path& answers, const DiagnoseCase& diagnose, const Digest& digest,
                     const ForEach& for_each) {
  const std::vector<CaseFiles> cases = open_batch(batch, digest);
  fs::create_directories(answers);
  std::vector<std::string> names;
  for (const CaseFiles& files : cases) names.push_back(files.name);
  // Answers that a run sealed are not added to unless they are still what was sealed.
  static_cast<void>(open_answers(batch, answers, names, digest));
  std::vector<std::string> failures(cases.size());
  for_each(cases.size(), [&](std::size_t i) {
    if (fs::exists(answers / cases[i].name)) return;
    try {
      answer_case(cases[i], answers, diagnose);
    } catch (const std::exception& error) {
      failures[i] = cases[i].name + ": " + error.what();
      std::error_code ignored;
      fs::remove_all(answers / (cases[i].name + ".unfinished"), ignored);
    }
  });
  RunOutcome outcome;
  outcome.answered = seal_answers(batch, answers, digest);
  for (std::string& failure : failures) {
    if (!failure.empty()) outcome.failures.push_back(std::move(failure));
  }
  return outcome;
}

}  // namespace hybridtest::blind
