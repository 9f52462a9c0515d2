#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "recording/error.hpp"
#include "recording/run_file.hpp"
#include "recording/summary/run_summary.hpp"

namespace hybridtest {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

template <class Value>
Json optional(const std::optional<Value>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json optional(const std::optional<double>& value) { return value ? number(*value) : Json(nullptr); }

Json json(const std::optional<Percentiles>& values) {
  if (!values) return nullptr;
  return {{"p50", number(values->p50)}, {"p99", number(values->p99)}, {"max", number(values->max)}};
}

Json json(const std::vector<Peak>& peaks, const char* key) {
  Json list = Json::array();
  for (const Peak& peak : peaks) {
    list.push_back({{"dof", peak.dof}, {key, number(peak.value)}, {"model_time_s", number(peak.model_time_s)}});
  }
  return list;
}

Json json(const std::vector<ReferenceComparison>& comparisons) {
  Json list = Json::array();
  for (const ReferenceComparison& comparison : comparisons) list.push_back(Json::parse(text_of(comparison)));
  return list;
}

Json json(const ExchangeSummary& exchange) {
  return {{"round_trip_us", json(exchange.round_trip_us)},
          {"turnaround_us", json(exchange.turnaround_us)},
          {"answered", exchange.answered},
          {"resent", exchange.resent},
          {"bridged", exchange.bridged},
          {"bridged_in_a_row", exchange.bridged_in_a_row},
          {"bridged_energy_j", number(exchange.bridged_energy_j)},
          {"bridged_energy_magnitude_j", number(exchange.bridged_energy_magnitude_j)},
          {"lost", exchange.lost},
          {"extrapolated", exchange.extrapolated},
          {"held", exchange.held},
          {"saturated", exchange.saturated},
          {"late", exchange.late},
          {"missed", exchange.missed},
          {"repeated", exchange.repeated}};
}

Json json(const TrackingError& error) {
  return {{"dof", error.dof},
          {"rms_m", number(error.rms_m)},
          {"rms_relative", optional(error.rms_relative)},
          {"peak_m", number(error.peak_m)},
          {"amplitude", optional(error.amplitude)},
          {"equivalent_delay_s", optional(error.equivalent_delay_s)},
          {"equivalent_frequency_hz", optional(error.equivalent_frequency_hz)},
          {"samples", error.samples}};
}

Json json(const LoopTimingSummary& timing) {
  return {{"starts", timing.starts},
          {"start_lateness_us", json(std::optional{timing.start_lateness_us})},
          {"busy_us", json(std::optional{timing.busy_us})},
          {"overruns", timing.overruns},
          {"memory_locked", timing.memory_locked},
          {"fifo_priority", timing.fifo_priority},
          {"cpu", optional(timing.cpu)}};
}

Json json(const std::vector<ClockRelation>& parts) {
  Json list = Json::array();
  for (const ClockRelation& part : parts) {
    list.push_back({{"begin_s", number(part.begin_s)},
                    {"end_s", number(part.end_s)},
                    {"at_s", number(part.at_s)},
                    {"offset_s", number(part.offset_s)},
                    {"offset_uncertainty_s", number(part.offset_uncertainty_s)},
                    {"drift", number(part.drift)},
                    {"drift_uncertainty", number(part.drift_uncertainty)},
                    {"latency_there_s", number(part.latency_there_s)},
                    {"latency_back_s", number(part.latency_back_s)}});
  }
  return list;
}

Json json(const SubstructureSummary& substructure) {
  Json tracking = Json::array();
  for (const TrackingError& error : substructure.tracking) tracking.push_back(json(error));
  Json energy = nullptr;
  if (substructure.energy_error) {
    energy = {{"peak_j", number(substructure.energy_error->peak_j)},
              {"final_j", number(substructure.energy_error->final_j)}};
  }
  return {{"id", substructure.id},
          {"peak_force", json(substructure.peak_force_n, "force_n")},
          {"exchange", substructure.exchange ? json(*substructure.exchange) : Json(nullptr)},
          {"tracking", tracking},
          {"energy_error", energy},
          {"loop_timing", substructure.loop_timing ? json(*substructure.loop_timing) : Json(nullptr)},
          {"clock", json(substructure.clock)}};
}

Json json(const SpectrumPoint& point) {
  return {{"mode", point.mode == 0 ? Json(nullptr) : Json(point.mode)},
          {"period_s", number(point.period_s)},
          {"displacement_m", number(point.displacement_m)},
          {"velocity_m_per_s", number(point.velocity_m_per_s)},
          {"pseudo_acceleration_m_per_s2", number(point.pseudo_acceleration_m_per_s2)}};
}

Json json(const GroundMotionSummary& motion) {
  Json spectrum = Json::array();
  for (const SpectrumPoint& point : motion.spectrum) spectrum.push_back(json(point));
  return {{"peak_m_per_s2", number(motion.facts.peak_m_per_s2)},
          {"points", motion.facts.points},
          {"duration_s", number(motion.facts.duration_s)},
          {"factor", optional(motion.factor)},
          {"end_velocity_m_per_s", number(motion.end_velocity_m_per_s)},
          {"end_displacement_m", number(motion.end_displacement_m)},
          {"response_spectrum", {{"damping_ratio", kSpectrumDamping}, {"points", spectrum}}}};
}

Json json(const InterlockSummary& interlock) {
  return {{"participant", interlock.participant},
          {"limit_name", interlock.limit_name},
          {"observed", number(interlock.observed)},
          {"limit", number(interlock.limit)},
          {"cause", interlock.cause},
          {"step", interlock.step},
          {"model_time_s", number(interlock.model_time_s)}};
}

Json json(const RefusedPacketsSummary& refused) {
  return {{"harmful", refused.harmful},
          {"in_plain_text", refused.in_plain_text},
          {"announcements", refused.announcements},
          {"departures", refused.departures}};
}

Json json(const ParticipantFileSummary& file) {
  return {{"participant", file.participant},
          {"role", std::string{name(file.role)}},
          {"file", file.file},
          {"closed_cleanly", file.closed_cleanly},
          {"write_failed", file.write_failed},
          {"dropped_rows", file.dropped_rows},
          {"missing_steps", file.missing_steps},
          {"refused_packets", file.refused_packets ? json(*file.refused_packets) : Json(nullptr)}};
}

template <class Value>
Json list(const std::vector<Value>& values) {
  Json result = Json::array();
  for (const Value& value : values) result.push_back(json(value));
  return result;
}

Json json(const RunSummary& summary) {
  return {{"schema", "hybridtest/summary/1"},
          {"test_name", summary.test_name},
          {"verdict", verdict(summary)},
          {"exit_code", summary.exit_code},
          {"stop_reason", std::string{name(summary.stop_reason)}},
          {"end",
           {{"who", summary.end.who}, {"why", summary.end.why}, {"model_time_s", optional(summary.end.model_time_s)}}},
          {"stalls",
           {{"count", summary.stalls.count},
            {"total_s", number(summary.stalls.total_s)},
            {"longest_s", number(summary.stalls.longest_s)},
            {"model_time_s", number(summary.stalls.model_time_s)}}},
          {"data_valid", summary.data_valid},
          {"data_faults", summary.data_faults},
          {"remarks", summary.remarks},
          {"faults", summary.faults},
          {"start_time_utc", summary.start_time_utc},
          {"scenario_digest", summary.scenario_digest},
          {"software_version", summary.software_version},
          {"planned_steps", optional(summary.planned_steps)},
          {"completed_steps", summary.completed_steps},
          {"model_time_s", number(summary.model_time_s)},
          {"wall_time_s", optional(summary.wall_time_s)},
          {"steps_per_second", optional(summary.steps_per_second)},
          {"ground_motions", list(summary.ground_motions)},
          {"references", json(summary.references)},
          {"peak_displacement", json(summary.peak_displacement_m, "displacement_m")},
          {"substructures", list(summary.substructures)},
          {"interlocks", list(summary.interlocks)},
          {"participants", list(summary.participants)}};
}

}  // namespace

void write_summary_json(const RunSummary& summary, std::ostream& stream) {
  // Text in a foreign file may not be UTF-8; the summary is written nevertheless.
  stream << json(summary).dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
}

void write_summary_json(const RunSummary& summary, const std::filesystem::path& path) {
  std::ofstream stream{path};
  write_summary_json(summary, stream);
  stream.close();
  if (!stream) throw RecordingError{path.string() + ": could not be written; check the free space of the disk"};
}

}  // namespace hybridtest
