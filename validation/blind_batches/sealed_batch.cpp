#include "validation/blind_batches/sealed_batch.hpp"

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

namespace hybridtest::blind {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

[[noreturn]] void refuse(const fs::path& path, const std::string& why) {
  throw std::runtime_error{path.string() + ": " + why};
}

/// Reads and takes apart; what is missing in it is found by `take`.
template <class Take>
auto from_json(const fs::path& path, Take take) {
  const std::string text = read_whole_file(path);
  try {
    return take(Json::parse(text));
  } catch (const Json::exception& error) {
    refuse(path, std::string{"is not what was written there: "} + error.what());
  }
}

fs::path answer_file(const fs::path& answers, const std::string& name) { return answers / name / "diagnosis.json"; }

std::string digest_of(const fs::path& path, const Digest& digest) { return digest(read_whole_file(path)); }

}  // namespace

std::string read_whole_file(const fs::path& path) {
  std::ifstream file{path, std::ios::binary};
  std::ostringstream text;
  text << file.rdbuf();
  if (!file) refuse(path, "cannot be read");
  return std::move(text).str();
}

std::vector<CaseFiles> open_batch(const fs::path& batch, const Digest& digest) {
  return from_json(batch / "batch.json", [&](const Json& json) {
    std::vector<CaseFiles> cases;
    for (const Json& entry : json.at("cases")) {
      CaseFiles files;
      files.name = entry.at("case").get<std::string>();
      for (const auto& [name, hash] : entry.at("files").items()) {
        const fs::path path = batch / files.name / name;
        if (digest_of(path, digest) != hash.get<std::string>()) refuse(path, "has changed since the batch was made");
        if (name == "site.yaml") files.site = path;
        if (name == "held_out.csv") files.held_out = path;
        if (name.starts_with("fit_")) files.fit.push_back(path);
      }
      cases.push_back(std::move(files));
    }
    return cases;
  });
}

std::size_t seal_answers(const fs::path& batch, const fs::path& answers, const Digest& digest) {
  const std::vector<std::string> names = from_json(batch / "batch.json", [](const Json& json) {
    std::vector<std::string> found;
    for (const Json& entry : json.at("cases")) found.push_back(entry.at("case").get<std::string>());
    return found;
  });
  Json seal{{"schema", "hybridtest/blind_answers/1"}, {"batch_sha256", digest_of(batch / "batch.json", digest)}};
  seal["answers"] = Json::object();
  for (const std::string& name : names) {
    const fs::path file = answer_file(answers, name);
    if (fs::exists(file)) seal["answers"][name] = digest_of(file, digest);
  }
  std::ofstream file{answers / "answers.json", std::ios::binary};
  file << seal.dump(1) << '\n';
  file.close();
  if (!file) refuse(answers / "answers.json", "could not be written");
  return seal["answers"].size();
}

std::string open_key(const fs::path& batch, const fs::path& key, const Digest& digest) {
  std::string text = read_whole_file(key);
  const auto named =
      from_json(batch / "batch.json", [](const Json& json) { return json.at("key_sha256").get<std::string>(); });
  if (digest(text) != named) refuse(key, "is not the key of " + batch.string() + ", or was changed");
  return text;
}

GivenAnswers open_answers(const fs::path& batch, const fs::path& answers, const std::vector<std::string>& names,
                          const Digest& digest) {
  GivenAnswers given;
  for (const std::string& name : names) {
    const fs::path file = answer_file(answers, name);
    given.texts.push_back(fs::exists(file) ? std::optional{read_whole_file(file)} : std::nullopt);
  }
  const fs::path seal = answers / "answers.json";
  if (!fs::exists(seal)) return given;
  from_json(seal, [&](const Json& json) {
    if (json.at("batch_sha256") != digest_of(batch / "batch.json", digest)) {
      refuse(seal, "seals answers to another batch than " + batch.string());
    }
    for (std::size_t i = 0; i < names.size(); ++i) {
      const auto hash = json.at("answers").find(names[i]);
      const bool was_sealed = hash != json.at("answers").end();
      const bool is_same = was_sealed == given.texts[i].has_value() &&
                           (!was_sealed || hash->get<std::string>() == digest(*given.texts[i]));
      if (!is_same) refuse(answer_file(answers, names[i]), "has changed since the answers were sealed");
    }
    return true;
  });
  given.are_sealed = true;
  return given;
}

}  // namespace hybridtest::blind
