#include "validation/blind_batches/score/score_batch.hpp"

#include <stdexcept>

#include "validation/blind_batches/score/score_report.hpp"
#include "validation/blind_batches/sealed_batch.hpp"

namespace hybridtest::blind {

BatchScore score_batch(const std::filesystem::path& batch, const std::filesystem::path& answers,
                       const std::filesystem::path& key, const Digest& digest) {
  const std::vector<KeyCase> cases = read_key(open_key(batch, key, digest));
  std::vector<std::string> names;
  for (const KeyCase& of_case : cases) names.push_back(of_case.name);
  const GivenAnswers given = open_answers(batch, answers, names, digest);
  std::vector<MarkedCase> marked;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    try {
      marked.push_back(mark(cases[i], given.texts[i] ? std::optional{read_answer(*given.texts[i])} : std::nullopt));
    } catch (const std::runtime_error& error) {
      throw std::runtime_error{names[i] + "/diagnosis.json: " + error.what()};
    }
  }
  const Score score = score_of(marked);
  nlohmann::ordered_json json = score_json(score);
  json["batch_sha256"] = digest(read_whole_file(batch / "batch.json"));
  json["answers_sealed"] = given.are_sealed;
  const std::string seal =
      given.are_sealed ? "The answers are as they were sealed.\n" : "The answers are not sealed.\n";
  return {seal + score_text(score), json.dump(1) + "\n"};
}

}  // namespace hybridtest::blind
