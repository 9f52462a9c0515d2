#include "diagnosis/page/diagnosis_json.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace hybridtest {
namespace {

using Json = nlohmann::ordered_json;

Json interval(const report::Interval& interval) { return Json::array({interval.low, interval.high}); }

Json where_entry(const report::InterfaceGap& gap, const Diagnosis& diagnosis) {
  Json entry{{"interface", gap.interface},       {"share", gap.share},
             {"ci95", interval(gap.share_ci95)}, {"nrmse", gap.nrmse},
             {"floor_nrmse", gap.floor_nrmse},   {"time_windows", Json::array()},
             {"bands_hz", Json::array()},        {"regions", Json::array()}};
  if (gap.verdict) entry["verdict"] = report::name_of(*gap.verdict);
  if (gap.repeatability) {
    entry["repeatability"] = {{"nrmse", gap.repeatability->nrmse}, {"source", gap.repeatability->source}};
  }
  if (gap.recurrence) {
    entry["repeats"] = gap.recurrence->is_seen();
    entry["discovered_term"] = {{"variance_removed", gap.recurrence->removed_by_function}};
  }
  const auto place = std::ranges::find(diagnosis.places, gap.interface, &GapPlace::interface);
  if (place == diagnosis.places.end()) return entry;
  for (const TimeWindow& window : place->time_windows) {
    entry["time_windows"].push_back({{"begin_s", window.begin_s}, {"end_s", window.end_s}, {"share", window.share}});
  }
  for (const BandShare& band : place->bands) {
    entry["bands_hz"].push_back({{"low_hz", band.low_hz}, {"high_hz", band.high_hz}, {"share", band.share}});
  }
  for (const GapRegion& region : place->regions) {
    entry["regions"].push_back(
        {{"displacement_m", Json::array({region.displacement_low_m, region.displacement_high_m})},
         {"velocity_m_per_s", Json::array({region.velocity_low_m_per_s, region.velocity_high_m_per_s})},
         {"share", region.share},
         {"time_share", region.time_share}});
  }
  return entry;
}

Json cause_entry(const report::RankedCause& cause) {
  Json entry{{"interface", cause.interface}, {"effect", cause.effect}};
  if (!cause.input.empty()) entry["input"] = cause.input;
  if (cause.is_formula) entry["formula"] = cause.equation;
  if (!cause.law.empty()) {
    entry["law"] = cause.law;
    entry["lost_stiffness"] = cause.lost_stiffness;
  }
  entry["probability"] = cause.probability;
  if (cause.is_cause || cause.share > 0.0) {
    entry["share"] = cause.share;
  } else if (cause.share == 0.0) {
    entry["indistinguishable"] = cause.is_indistinguishable;
  }
  if (cause.may_be_absent) entry["may_be_absent"] = true;
  entry["parameters"] = Json::object();
  for (const report::ReportedParameter& parameter : cause.parameters) {
    Json value{{"value", parameter.value}};
    if (parameter.ci95) value["ci95"] = interval(*parameter.ci95);
    if (parameter.is_at_bound) value["at_bound"] = true;
    if (parameter.is_at_least) value["at_least"] = true;
    if (parameter.in_model) value["in_model"] = *parameter.in_model;
    entry["parameters"][parameter.name] = std::move(value);
  }
  return entry;
}

Json shrink_entry(const report::Shrink& shrink) {
  Json entry{{"nrmse_before", shrink.nrmse_before},
             {"nrmse_after", shrink.nrmse_after},
             {"floor_nrmse", shrink.floor_nrmse},
             {"variance_removed", shrink.variance_removed}};
  if (shrink.ci95) entry["ci95"] = interval(*shrink.ci95);
  if (shrink.explainable_fraction) entry["explainable_fraction"] = *shrink.explainable_fraction;
  entry["unknown_share"] = shrink.unknown_share;
  return entry;
}

Json sensor_entry(const report::SensorFacts& facts) {
  Json entry{{"recording", facts.recording},
             {"column", facts.column},
             {"quantum", facts.quantum},
             {"repeated_share", facts.repeated_share},
             {"clipped_share", facts.clipped_share}};
  if (facts.at_rest) {
    entry["at_rest"] = {{"first", facts.at_rest->first},
                        {"last", facts.at_rest->last},
                        {"drift_per_s", facts.at_rest->drift_per_s},
                        {"rms", facts.at_rest->rms}};
  }
  if (facts.lag_s) entry["lag_s"] = *facts.lag_s;
  return entry;
}

Json predicted_entry(const report::PredictedNumber& number, std::string_view unit) {
  Json entry = Json::object();
  if (!number.of.empty()) entry["dof"] = number.of;
  entry["recorded_" + std::string{unit}] = number.recorded;
  entry["predicted_" + std::string{unit}] = number.predicted;
  entry["ci95"] = interval(number.ci95);
  return entry;
}

Json response_entry(const report::ResponseShrink& shrink) {
  Json entry{{"recording", shrink.recording},
             {"nrmse_before", shrink.nrmse_before},
             {"nrmse_after", shrink.nrmse_after},
             {"peak_error_before", shrink.peak_error_before},
             {"peak_error_after", shrink.peak_error_after}};
  if (shrink.energy_error_before) entry["energy_error_before"] = *shrink.energy_error_before;
  if (shrink.energy_error_after) entry["energy_error_after"] = *shrink.energy_error_after;
  if (shrink.floor_nrmse) entry["floor_nrmse"] = *shrink.floor_nrmse;
  entry["variance_removed"] = shrink.variance_removed;
  if (shrink.ci95) entry["ci95"] = interval(*shrink.ci95);
  if (shrink.nrmse_after_ci95) entry["nrmse_after_ci95"] = interval(*shrink.nrmse_after_ci95);
  if (shrink.peak_error_after_ci95) entry["peak_error_after_ci95"] = interval(*shrink.peak_error_after_ci95);
  if (shrink.energy_error_after_ci95) entry["energy_error_after_ci95"] = interval(*shrink.energy_error_after_ci95);
  if (shrink.explainable_fraction) entry["explainable_fraction"] = *shrink.explainable_fraction;
  if (shrink.unknown_share) entry["unknown_share"] = *shrink.unknown_share;
  entry["peaks"] = Json::array();
  for (const report::PredictedNumber& peak : shrink.peaks) entry["peaks"].push_back(predicted_entry(peak, "m"));
  if (shrink.energy_taken) entry["energy_taken"] = predicted_entry(*shrink.energy_taken, "j");
  return entry;
}

}  // namespace

std::string diagnosis_json(const Diagnosis& diagnosis) {
  const report::DiagnosisReport& report = diagnosis.report;
  Json json{{"schema", "hybridtest/diagnosis/1"}, {"model", report.model_file}, {"recordings", Json::array()}};
  for (const report::ReportedRecording& recording : report.recordings) {
    json["recordings"].push_back({{"file", recording.file},
                                  {"sha256", recording.sha256},
                                  {"role", recording.role == RecordingRole::fit ? "fit" : "held_out"},
                                  {"quasi_static", recording.is_quasi_static}});
  }
  json["where"] = Json::array();
  for (const report::InterfaceGap& gap : report.where) {
    if (gap.is_judged) json["where"].push_back(where_entry(gap, diagnosis));
  }
  json["not_judged"] = Json::object();
  for (const report::InterfaceGap& gap : report.where) {
    if (!gap.is_judged) json["not_judged"][gap.interface] = gap.why_not;
  }
  json["sensors"] = Json::array();
  for (const report::SensorFacts& facts : report.sensors) json["sensors"].push_back(sensor_entry(facts));
  json["findings"] = Json::array();
  for (const report::Finding& finding : report.findings) {
    json["findings"].push_back({{"recording", finding.recording},
                                {"interface", finding.interface},
                                {"what", finding.what},
                                {"what_to_do", finding.what_to_do}});
  }
  json["verdict"] = report::name_of(report.verdict);
  if (report.set_leaves_a_part) json["leaves_a_part"] = true;
  if (report.is_pieced_together) json["pieced_together"] = true;
  json["causes"] = Json::array();
  json["alternatives"] = Json::array();
  for (const report::RankedCause& cause : report.ranking) {
    json[cause.is_cause ? "causes" : "alternatives"].push_back(cause_entry(cause));
  }
  json["corrections"] = Json::array();
  for (const report::RankedCause& number : report.corrections) json["corrections"].push_back(cause_entry(number));
  json["shrink"] = Json::object();
  if (report.interface_shrink) json["shrink"]["interface"] = shrink_entry(*report.interface_shrink);
  if (report.response_shrink) {
    json["shrink"]["response"] = response_entry(*report.response_shrink);
  } else if (!report.why_no_response.empty()) {
    json["shrink"]["why_no_response"] = report.why_no_response;
  }
  json["next_experiment"] = report.next_experiment;
  json["notes"] = report.notes;
  return json.dump(1) + "\n";
}

}  // namespace hybridtest
