#include "validation/blind_batches/batch.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <exception>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "core/input_file.hpp"
#include "validation/blind_batches/library_terms.hpp"

namespace hybridtest::blind {

namespace {

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.10g", value);
  return text.data();
}

std::string transfer_yaml(const TransferModel& model) {
  switch (model.kind) {
    case TransferKind::ideal: return "{type: ideal}";
    case TransferKind::delay: return "{type: delay, delay_s: " + number(model.delay_s) + "}";
    case TransferKind::first_order: return "{type: first_order, bandwidth_hz: " + number(model.bandwidth_hz) + "}";
    case TransferKind::second_order:
      return "{type: second_order, natural_frequency_hz: " + number(model.natural_frequency_hz) +
             ", damping_ratio: " + number(model.damping_ratio) + ", delay_s: " + number(model.delay_s) + "}";
  }
  return {};
}

std::string law_yaml(const LawModel& law) {
  const std::string stiffness = ", stiffness_n_per_m: " + number(law.stiffness_n_per_m);
  const std::string yielding =
      ", yield_force_n: " + number(law.yield_force_n) + ", hardening_ratio: " + number(law.hardening_ratio);
  switch (law.kind) {
    case LawKind::none: return "{type: none}";
    case LawKind::elastic: return "{type: elastic" + stiffness + "}";
    case LawKind::bilinear: return "{type: bilinear" + stiffness + yielding + "}";
    case LawKind::giuffre_menegotto_pinto: return "{type: giuffre_menegotto_pinto" + stiffness + yielding + "}";
    case LawKind::bouc_wen:
      return "{type: bouc_wen" + stiffness + ", alpha: " + number(law.alpha) +
             ", gamma_per_m: " + number(law.gamma_per_m) + ", beta_per_m: " + number(law.beta_per_m) + "}";
  }
  return {};
}

/// Fixed width: 15 characters and the comma, whatever the value.
void append_value(std::string& text, double value) {
  std::array<char, 32> digits{};
  const int length = std::snprintf(digits.data(), digits.size(), ",%+.7e", value);
  text.append(digits.data(), static_cast<std::size_t>(length));
}

nlohmann::ordered_json cause_json(const Cause& cause) {
  nlohmann::ordered_json json{{"interface", cause.interface}, {"effect", cause.effect}};
  if (!cause.law.empty()) json["law"] = cause.law;
  return json;
}

nlohmann::ordered_json causes_json(const std::vector<Cause>& causes) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const Cause& cause : causes) json.push_back(cause_json(cause));
  return json;
}

nlohmann::ordered_json effect_json(const Site& site, const PlantEffect& effect) {
  nlohmann::ordered_json json{{"interface", effect.interface}, {"effect", effect.name}};
  if (!effect.law.empty()) json["plant_law"] = effect.law;
  json["parameters"] = in_library_terms(site, effect);
  json["plant_parameters"] = effect.parameters;
  return json;
}

/// The site with the numbers that it has, where the user's model has others.
Site real_site(const BlindCase& blind_case) {
  Site site = blind_case.setting.site;
  for (const PlantEffect& beside : blind_case.truth.besides) {
    if (beside.name == "stiffness_error") site.specimen.stiffness_n_per_m *= beside.of("stiffness_ratio");
  }
  return site;
}

}  // namespace

std::string case_name(std::size_t index) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "case_%04zu", index + 1);
  return text.data();
}

namespace {

std::string compensator_yaml(const CompensatorModel& model) {
  if (model.delay_s <= 0.0) return "{type: none}";
  return "{type: polynomial_displacement, order: " + std::to_string(model.order) +
         ", delay_s: " + number(model.delay_s) + "}";
}

/// One by itself, several as a list.
template <class Text>
std::string one_or_list(const std::vector<Site>& sites, Text text) {
  if (sites.size() == 1) return text(sites.front());
  std::string list;
  for (const Site& site : sites) list += (list.empty() ? "[" : ", ") + text(site);
  return list + "]";
}

}  // namespace

std::vector<Site> sites_of(const CaseSetting& setting) {
  std::vector<Site> sites{setting.site};
  if (setting.loop && setting.loop->other) sites.push_back(*setting.loop->other);
  if (sites.size() > 1 && setting.loop->other_is_first) std::swap(sites[0], sites[1]);
  return sites;
}

std::string site_yaml(const std::vector<Site>& sites) {
  double noise_m = 0.0;  // the largest: a file has one value for all
  double noise_n = 0.0;
  for (const Site& site : sites) {
    noise_m = std::max(noise_m, rounded(site.displacement_noise_m.rms()));
    noise_n = std::max(noise_n, rounded(site.force_noise_n.rms()));
  }
  std::string text;
  const auto transfer = [](const Site& site) { return transfer_yaml(site.transfer_system); };
  const auto law = [](const Site& site) { return law_yaml(site.specimen); };
  const auto compensator = [](const Site& site) { return compensator_yaml(site.compensator); };
  text += "transfer_system: " + one_or_list(sites, transfer) + "\n";
  text += "specimen: " + one_or_list(sites, law) + "\n";
  text += "sensors: {displacement_noise_m: " + number(noise_m) + ", force_noise_n: " + number(noise_n) + "}\n";
  text += "compensator: " + one_or_list(sites, compensator) + "\n";
  const Site& site = sites.front();
  text += "control_rate_hz: " + number(site.rate_hz) + "\n";
  if (site.known_mass_kg > 0.0 || site.known_damping_n_s_per_m > 0.0) text += "effects:\n";
  if (site.known_mass_kg > 0.0) {
    text += "  - {interface: specimen, effect: inertia, mass_kg: " + number(site.known_mass_kg) + "}\n";
  }
  if (site.known_damping_n_s_per_m > 0.0) {
    text += "  - {interface: specimen, effect: viscous_damping, damping_n_s_per_m: " +
            number(site.known_damping_n_s_per_m) + "}\n";
  }
  return text;
}

std::string recording_csv(const std::vector<PlantRecording>& recordings, const RecordedColumns& columns,
                          double rate_hz) {
  std::vector<std::pair<std::string, const History*>> channels;
  for (std::size_t dof = 0; dof < recordings.size(); ++dof) {
    const PlantRecording& recording = recordings[dof];
    const std::string suffix = recordings.size() > 1 ? "_" + std::to_string(dof + 1) : "";
    if (columns.sent) channels.emplace_back("sent_displacement_m" + suffix, &recording.sent_m);
    if (columns.target) channels.emplace_back("target_displacement_m" + suffix, &recording.target_m);
    if (columns.command) channels.emplace_back("command_displacement_m" + suffix, &recording.command_m);
    channels.emplace_back("measured_displacement_m" + suffix, &recording.measured_m);
    channels.emplace_back("measured_force_n" + suffix, &recording.measured_n);
  }
  std::string text = "time_s";
  for (const auto& [name, values] : channels) text += "," + name;
  text += '\n';
  for (std::size_t i = 0; i < recordings.front().measured_m.size(); ++i) {
    std::array<char, 32> time{};
    std::snprintf(time.data(), time.size(), "%.7f", static_cast<double>(i) / rate_hz);
    text += time.data();
    for (const auto& [name, values] : channels) append_value(text, (*values)[i]);
    text += '\n';
  }
  return text;
}

std::vector<std::string> case_csv(const BlindCase& blind_case) {
  const CaseSetting& setting = blind_case.setting;
  const bool has_other = setting.loop && setting.loop->other;
  const auto csv = [&](const PlantRecording& here, const PlantRecording* there) {
    std::vector<PlantRecording> recordings{here};
    if (has_other) recordings.push_back(*there);
    if (has_other && setting.loop->other_is_first) std::swap(recordings[0], recordings[1]);
    return recording_csv(recordings, setting.columns, setting.site.rate_hz);
  };
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < blind_case.fit.size(); ++i) {
    texts.push_back(csv(blind_case.fit[i], has_other ? &blind_case.other_fit[i] : nullptr));
  }
  texts.push_back(csv(blind_case.held_out, &blind_case.other_held_out));
  return texts;
}

nlohmann::ordered_json truth_json(const std::string& name, const BlindCase& blind_case) {
  static constexpr std::array<const char*, 4> kResiduals{"network", "compensator", "transfer_system", "specimen"};
  const Truth& truth = blind_case.truth;
  nlohmann::ordered_json json;
  json["case"] = name;
  json["truth"] = name_of(truth.kind);
  json["effects"] = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < truth.effects.size(); ++i) {
    json["effects"].push_back(effect_json(real_site(blind_case), truth.effects[i]));
    json["effects"].back()["gap_to_floor"] = truth.effect_gaps_to_floor[i];
    json["effects"].back()["acceptable"] = causes_json(truth.effect_acceptable[i]);
  }
  json["besides"] = nlohmann::ordered_json::array();
  for (const PlantEffect& beside : truth.besides) {
    json["besides"].push_back(effect_json(blind_case.setting.site, beside));
  }
  json["acceptable"] = causes_json(truth.acceptable);
  json["acceptable_in_part"] = causes_json(truth.acceptable_in_part);
  json["tolerated"] = causes_json(truth.tolerated);
  json["is_separable"] = truth.is_separable;
  json["is_closed_loop"] = blind_case.setting.loop.has_value();
  json["gap_at"] = kResiduals[static_cast<std::size_t>(truth.residual)];
  json["gap_to_floor"] = truth.gap_to_floor;
  json["held_out_gap_to_floor"] = truth.held_out_gap_to_floor;
  json["variance_removed_by_true_model"] = truth.variance_removed;
  return json;
}

std::string_view name_of(TruthClass kind) noexcept {
  switch (kind) {
    case TruthClass::none: return "none";
    case TruthClass::named: return "named";
    case TruthClass::law: return "law";
    case TruthClass::pair: return "pair";
    case TruthClass::partial: return "partial";
    case TruthClass::unknown: return "unknown";
  }
  return "";
}

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

[[noreturn]] void refuse(const fs::path& path, const std::string& why) {
  throw std::runtime_error{path.string() + ": " + why};
}

/// Reads and parses; `take` reports missing fields.
template <class Take>
auto from_json(const fs::path& path, Take take) {
  const std::string text = read_batch_file(path);
  try {
    return take(Json::parse(text));
  } catch (const Json::exception& error) {
    refuse(path,
           std::string{
               "cannot be read as JSON with the expected keys; expected the file as `hybridtest blind` wrote it: "} +
               error.what());
  }
}

fs::path answer_file(const fs::path& answers, const std::string& name) { return answers / name / "diagnosis.json"; }

std::string digest_of(const fs::path& path, const Digest& digest) { return digest(read_batch_file(path)); }

}  // namespace

std::string read_batch_file(const fs::path& path) {
  constexpr std::size_t kBytesMax = std::size_t{1} << 30U;
  return read_input_file(path, kBytesMax, "a file of a blind batch");
}

std::vector<CaseFiles> open_batch(const fs::path& batch, const Digest& digest) {
  return from_json(batch / "batch.json", [&](const Json& json) {
    std::vector<CaseFiles> cases;
    for (const Json& entry : json.at("cases")) {
      CaseFiles files;
      files.name = entry.at("case").get<std::string>();
      for (const auto& [name, hash] : entry.at("files").items()) {
        const fs::path path = batch / files.name / name;
        if (digest_of(path, digest) != hash.get<std::string>())
          refuse(path, "has changed since the batch was made; expected the original file. Make the batch again");
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
  if (!file)
    refuse(answers / "answers.json", "cannot be written; check the permissions and the free space of the folder");
  return seal["answers"].size();
}

std::string open_key(const fs::path& batch, const fs::path& key, const Digest& digest) {
  std::string text = read_batch_file(key);
  const auto named =
      from_json(batch / "batch.json", [](const Json& json) { return json.at("key_sha256").get<std::string>(); });
  if (digest(text) != named)
    refuse(key, "is not the key of the batch " + batch.string() +
                    ", or has changed; expected the key that was made with it");
  return text;
}

GivenAnswers open_answers(const fs::path& batch, const fs::path& answers, const std::vector<std::string>& names,
                          const Digest& digest) {
  GivenAnswers given;
  for (const std::string& name : names) {
    const fs::path file = answer_file(answers, name);
    given.texts.push_back(fs::exists(file) ? std::optional{read_batch_file(file)} : std::nullopt);
  }
  const fs::path seal = answers / "answers.json";
  if (!fs::exists(seal)) return given;
  from_json(seal, [&](const Json& json) {
    if (json.at("batch_sha256") != digest_of(batch / "batch.json", digest)) {
      refuse(seal, "belongs to another batch than " + batch.string() + "; expected the answers to this batch");
    }
    for (std::size_t i = 0; i < names.size(); ++i) {
      const auto hash = json.at("answers").find(names[i]);
      const bool was_sealed = hash != json.at("answers").end();
      const bool is_same = was_sealed == given.texts[i].has_value() &&
                           (!was_sealed || hash->get<std::string>() == digest(*given.texts[i]));
      if (!is_same)
        refuse(answer_file(answers, names[i]),
               "has changed since the answers were sealed; expected the sealed file. Delete the folder of the "
               "answers and run the batch again");
    }
    return true;
  });
  given.are_sealed = true;
  return given;
}

namespace {

using Json = nlohmann::ordered_json;

void write_file(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file{path, std::ios::binary};
  file << text;
  file.close();
  if (!file)
    throw std::runtime_error{path.string() +
                             ": cannot be written; check the permissions and the free space of the folder"};
}

struct CaseEntries {
  Json batch;
  Json key;
};

CaseEntries write_case(const MakeSettings& settings, std::size_t index, const Digest& digest) {
  const BlindCase blind_case = draw_case(settings.seed, index);
  const std::filesystem::path directory = settings.directory / case_name(index);
  std::filesystem::create_directories(directory);
  CaseEntries entries;
  entries.batch["case"] = case_name(index);
  const auto write = [&](const std::string& name, const std::string& text) {
    write_file(directory / name, text);
    entries.batch["files"][name] = digest(text);
  };
  write("site.yaml", site_yaml(sites_of(blind_case.setting)));
  const std::vector<std::string> texts = case_csv(blind_case);
  for (std::size_t i = 0; i + 1 < texts.size(); ++i) write("fit_" + std::to_string(i + 1) + ".csv", texts[i]);
  write("held_out.csv", texts.back());
  entries.key = truth_json(case_name(index), blind_case);
  return entries;
}

}  // namespace

void make_batch(const MakeSettings& settings, const Digest& digest, const ForEach& for_each) {
  if (std::filesystem::exists(settings.directory) && !std::filesystem::is_empty(settings.directory)) {
    throw std::runtime_error{settings.directory.string() +
                             ": this directory is not empty; expected a new or empty directory"};
  }
  if (std::filesystem::exists(settings.key)) {
    throw std::runtime_error{
        settings.key.string() +
        ": this key exists; expected the name of a new file, because an existing key is never replaced"};
  }
  std::filesystem::create_directories(settings.directory);
  Json batch{{"schema", "hybridtest/blind_batch/1"}};
  Json key{{"schema", "hybridtest/blind_key/1"}, {"seed", settings.seed}};
  std::vector<CaseEntries> entries(settings.cases);
  std::vector<std::string> names;
  for (std::size_t i = 0; i < settings.cases; ++i) names.push_back(case_name(i));
  for_each(names, [&](std::size_t i) { entries[i] = write_case(settings, i, digest); });
  for (CaseEntries& entry : entries) {
    batch["cases"].push_back(std::move(entry.batch));
    key["cases"].push_back(std::move(entry.key));
  }
  const std::string key_text = key.dump(1) + "\n";
  write_file(settings.key, key_text);
  batch["key_sha256"] = digest(key_text);
  write_file(settings.directory / "batch.json", batch.dump(1) + "\n");
}

namespace {

namespace fs = std::filesystem;

/// The answer gets its final name when it is complete; an incomplete answer of an interrupted run is repeated.
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
  // Answers are added to a sealed set only if the sealed answers are unchanged.
  static_cast<void>(open_answers(batch, answers, names, digest));
  std::vector<const CaseFiles*> open;  // what an earlier run answered is left as it is
  std::vector<std::string> open_names;
  for (const CaseFiles& files : cases) {
    if (fs::exists(answers / files.name)) continue;
    open.push_back(&files);
    open_names.push_back(files.name);
  }
  std::vector<std::string> failures(open.size());
  for_each(open_names, [&](std::size_t i) {
    try {
      answer_case(*open[i], answers, diagnose);
    } catch (const std::exception& error) {
      failures[i] = open_names[i] + ": " + error.what();
      std::error_code ignored;
      fs::remove_all(answers / (open_names[i] + ".unfinished"), ignored);
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
