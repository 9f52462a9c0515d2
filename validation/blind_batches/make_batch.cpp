#include "validation/blind_batches/make_batch.hpp"

#include <fstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace hybridtest::blind {
namespace {

using Json = nlohmann::ordered_json;

void write_file(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file{path, std::ios::binary};
  file << text;
  file.close();
  if (!file) throw std::runtime_error{path.string() + ": could not be written"};
}

struct CaseEntries {
  Json batch;
  Json key;
};

CaseEntries write_case(const MakeSettings& settings, std::size_t index, const Digest& digest) {
  const BlindCase blind_case = draw_case(settings.seed, index);
  const Site& site = blind_case.setting.site;
  const std::filesystem::path directory = settings.directory / case_name(index);
  std::filesystem::create_directories(directory);
  CaseEntries entries;
  entries.batch["case"] = case_name(index);
  const auto write = [&](const std::string& name, const std::string& text) {
    write_file(directory / name, text);
    entries.batch["files"][name] = digest(text);
  };
  write("site.yaml", site_yaml(site));
  for (std::size_t i = 0; i < blind_case.fit.size(); ++i) {
    write("fit_" + std::to_string(i + 1) + ".csv",
          recording_csv(blind_case.fit[i], blind_case.setting.columns, site.rate_hz));
  }
  write("held_out.csv", recording_csv(blind_case.held_out, blind_case.setting.columns, site.rate_hz));
  entries.key = truth_json(case_name(index), blind_case);
  return entries;
}

}  // namespace

void make_batch(const MakeSettings& settings, const Digest& digest, const ForEach& for_each) {
  if (std::filesystem::exists(settings.directory) && !std::filesystem::is_empty(settings.directory)) {
    throw std::runtime_error{settings.directory.string() + ": is not empty; a batch gets a directory of its own"};
  }
  if (std::filesystem::exists(settings.key)) {
    throw std::runtime_error{settings.key.string() + ": is there already; keys are not written over"};
  }
  std::filesystem::create_directories(settings.directory);
  Json batch{{"schema", "hybridtest/blind_batch/1"}};
  Json key{{"schema", "hybridtest/blind_key/1"}, {"seed", settings.seed}};
  std::vector<CaseEntries> entries(settings.cases);
  for_each(settings.cases, [&](std::size_t i) { entries[i] = write_case(settings, i, digest); });
  for (CaseEntries& entry : entries) {
    batch["cases"].push_back(std::move(entry.batch));
    key["cases"].push_back(std::move(entry.key));
  }
  const std::string key_text = key.dump(1) + "\n";
  write_file(settings.key, key_text);
  batch["key_sha256"] = digest(key_text);
  write_file(settings.directory / "batch.json", batch.dump(1) + "\n");
}

}  // namespace hybridtest::blind
