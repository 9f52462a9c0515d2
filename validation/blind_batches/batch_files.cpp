#include "validation/blind_batches/batch_files.hpp"

#include <array>
#include <cstdio>
#include <utility>
#include <vector>

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
  return {{"interface", cause.interface}, {"effect", cause.effect}};
}

}  // namespace

std::string case_name(std::size_t index) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "case_%04zu", index + 1);
  return text.data();
}

std::string site_yaml(const Site& site) {
  std::string text;
  text += "transfer_system: " + transfer_yaml(site.transfer_system) + "\n";
  text += "specimen: " + law_yaml(site.specimen) + "\n";
  text += "sensors: {displacement_noise_m: " + number(site.displacement_noise_m) +
          ", force_noise_n: " + number(site.force_noise_n) + "}\n";
  text += site.compensator.delay_s > 0.0
              ? "compensator: {type: polynomial_displacement, order: " + std::to_string(site.compensator.order) +
                    ", delay_s: " + number(site.compensator.delay_s) + "}\n"
              : "compensator: {type: none}\n";
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

std::string recording_csv(const PlantRecording& recording, const RecordedColumns& columns, double rate_hz) {
  std::vector<std::pair<const char*, const History*>> channels;
  if (columns.sent) channels.emplace_back("sent_displacement_m", &recording.sent_m);
  if (columns.target) channels.emplace_back("target_displacement_m", &recording.target_m);
  if (columns.command) channels.emplace_back("command_displacement_m", &recording.command_m);
  channels.emplace_back("measured_displacement_m", &recording.measured_m);
  channels.emplace_back("measured_force_n", &recording.measured_n);
  std::string text = "time_s";
  for (const auto& [name, values] : channels) text += std::string{","} + name;
  text += '\n';
  for (std::size_t i = 0; i < recording.measured_m.size(); ++i) {
    std::array<char, 32> time{};
    std::snprintf(time.data(), time.size(), "%.7f", static_cast<double>(i) / rate_hz);
    text += time.data();
    for (const auto& [name, values] : channels) append_value(text, (*values)[i]);
    text += '\n';
  }
  return text;
}

nlohmann::ordered_json truth_json(const std::string& name, const BlindCase& blind_case) {
  static constexpr std::array<const char*, 4> kResiduals{"network", "compensator", "transfer_system", "specimen"};
  const Truth& truth = blind_case.truth;
  nlohmann::ordered_json json;
  json["case"] = name;
  json["truth"] = name_of(truth.kind);
  json["effects"] = nlohmann::ordered_json::array();
  for (const PlantEffect& effect : truth.effects) {
    nlohmann::ordered_json entry{{"interface", effect.interface}, {"effect", effect.name}};
    entry["parameters"] = in_library_terms(blind_case.setting.site, effect);
    entry["plant_parameters"] = effect.parameters;
    json["effects"].push_back(std::move(entry));
  }
  json["acceptable"] = nlohmann::ordered_json::array();
  for (const Cause& cause : truth.acceptable) json["acceptable"].push_back(cause_json(cause));
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
    case TruthClass::unknown: return "unknown";
    case TruthClass::pair: return "pair";
  }
  return "";
}

}  // namespace hybridtest::blind
