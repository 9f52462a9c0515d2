#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <ostream>

#include "core/text/short_number.hpp"
#include "recording/summary/run_summary.hpp"

namespace hybridtest {
namespace {

constexpr double kMillimetres = 1e3;
constexpr double kKilonewtons = 1e-3;
constexpr double kMilliseconds = 1e3;
constexpr double kMillisecondsPerMicrosecond = 1e-3;
constexpr double kPercent = 1e2;

std::string fixed(double value, int decimals) {
  if (!std::isfinite(value)) return "-";
  return short_number(value, decimals);
}

std::string fixed(const std::optional<double>& value, double scale, int decimals) {
  return value ? fixed(*value * scale, decimals) : "-";
}

/// Rows of text under a title, first column to the left, the others to the right.
class TextTable {
 public:
  explicit TextTable(std::vector<std::string> header) : rows_{std::move(header)} {}
  void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }

  /// Nothing without a row below the header.
  void print(std::ostream& stream) const {
    if (rows_.size() < 2) return;
    std::vector<std::size_t> widths(rows_.front().size(), 0);
    for (const auto& row : rows_) {
      for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
    }
    widths.front() = std::max(widths.front(), kFirstWidth);
    stream << '\n';
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      const std::string indent(r == 0 ? 2 : 4, ' ');
      stream << indent << rows_[r][0] << std::string(widths[0] + 4 - indent.size() - rows_[r][0].size(), ' ');
      for (std::size_t i = 1; i < rows_[r].size(); ++i) {
        const std::size_t width = std::max(widths[i], kOtherWidth);
        stream << "  " << std::string(width - rows_[r][i].size(), ' ') << rows_[r][i];
      }
      stream << '\n';
    }
  }

 private:
  static constexpr std::size_t kFirstWidth = 22;
  static constexpr std::size_t kOtherWidth = 9;
  std::vector<std::vector<std::string>> rows_;
};

void print_list(const char* title, const std::vector<std::string>& lines, std::ostream& stream) {
  if (lines.empty()) return;
  stream << "\n  " << title << '\n';
  for (const std::string& line : lines) stream << "    " << line << '\n';
}

/// With the ordinates of its spectrum at the lowest periods of the structure.
void print_ground_motions(const RunSummary& summary, std::ostream& stream) {
  constexpr int kModesShown = 3;
  for (std::size_t i = 0; i < summary.ground_motions.size(); ++i) {
    const GroundMotionSummary& motion = summary.ground_motions[i];
    stream << "  ground motion" << (summary.ground_motions.size() > 1 ? " " + std::to_string(i + 1) : "") << ": "
           << ground_motion_text(motion.facts) << '\n';
    std::string ordinates;
    for (const SpectrumPoint& point : motion.spectrum) {
      if (point.mode == 0 || point.mode > kModesShown) continue;
      ordinates += (ordinates.empty() ? "" : "; ") + fixed(point.period_s, 3) +
                   " s: " + fixed(point.pseudo_acceleration_m_per_s2 / kStandardGravity_m_per_s2, 3) + " g, " +
                   fixed(point.displacement_m * kMillimetres, 1) + " mm";
    }
    if (!ordinates.empty()) stream << "    spectrum (5 %) at the periods of the structure: " << ordinates << '\n';
  }
}

void print_head(const RunSummary& summary, std::ostream& stream) {
  std::string words = verdict(summary);
  int depth = 0;  // names and units in parentheses stay as they are
  for (char& c : words) {
    depth += (c == '(') - (c == ')');
    if (depth == 0) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  }
  stream << words << "  (exit " << summary.exit_code << ")  " << summary.test_name << '\n';
  if (!summary.end.why.empty()) stream << "  cause: " << summary.end.why << '\n';
  stream << "  " << summary.completed_steps;
  if (summary.planned_steps) stream << " of " << *summary.planned_steps;
  stream << " steps, " << fixed(summary.model_time_s, 3) << " s of model time";
  if (summary.wall_time_s) stream << " in " << fixed(*summary.wall_time_s, 2) << " s";
  if (summary.steps_per_second) stream << ", " << fixed(*summary.steps_per_second, 0) << " steps/s";
  stream << '\n';
  print_ground_motions(summary, stream);
}

/// A limit's unit for people and its factor from SI.
std::pair<double, std::string> unit_of(const std::string& limit_name) {
  if (limit_name == "displacement_limit" || limit_name == "tracking_error" || limit_name == "displacement_step") {
    return {kMillimetres, " mm"};
  }
  if (limit_name == "velocity_limit") return {kMillimetres, " mm/s"};
  if (limit_name == "force_limit" || limit_name == "force_step") return {kKilonewtons, " kN"};
  if (limit_name == "command_age") return {kMilliseconds, " ms"};
  return {1.0, ""};
}

std::string sentence(const InterlockSummary& interlock) {
  const auto [scale, unit] = unit_of(interlock.limit_name);
  const bool has_values = std::isfinite(interlock.observed) && interlock.limit_name != "energy_error";
  const std::string cause = has_values ? interlock.limit_name + ", observed " + fixed(interlock.observed * scale, 3) +
                                             unit + ", limit " + fixed(interlock.limit * scale, 3) + unit
                                       : interlock.cause;
  return interlock.participant + ": " + cause + ", at step " + std::to_string(interlock.step) + " (" +
         fixed(interlock.model_time_s, 3) + " s)";
}

void print_peaks(const RunSummary& summary, std::ostream& stream) {
  TextTable displacement{{"peak displacement", "mm", "at s"}};
  for (const Peak& peak : summary.peak_displacement_m) {
    displacement.add({peak.dof, fixed(peak.value * kMillimetres, 3), fixed(peak.model_time_s, 3)});
  }
  displacement.print(stream);
  TextTable force{{"peak restoring force", "kN", "at s"}};
  for (const SubstructureSummary& substructure : summary.substructures) {
    for (const Peak& peak : substructure.peak_force_n) {
      force.add({substructure.id + " " + peak.dof, fixed(peak.value * kKilonewtons, 3), fixed(peak.model_time_s, 3)});
    }
  }
  force.print(stream);
}

void print_exchanges(const RunSummary& summary, std::ostream& stream) {
  TextTable latency{
      {"round trip", "p50 ms", "p99 ms", "max ms", "own ms", "resent", "bridged", "lost", "late", "held"}};
  TextTable bridges{{"missed deadlines", "bridged", "in a row", "energy added J", "magnitude J", "targets missed"}};
  for (const SubstructureSummary& substructure : summary.substructures) {
    if (!substructure.exchange) continue;
    const ExchangeSummary& exchange = *substructure.exchange;
    std::vector<std::string> row{substructure.id};
    for (const double Percentiles::*value : {&Percentiles::p50, &Percentiles::p99, &Percentiles::max}) {
      row.push_back(exchange.round_trip_us ? fixed(*exchange.round_trip_us.*value * kMillisecondsPerMicrosecond, 3)
                                           : "-");
    }
    row.push_back(exchange.turnaround_us ? fixed(exchange.turnaround_us->p50 * kMillisecondsPerMicrosecond, 3) : "-");
    for (const std::uint64_t count : {exchange.resent, exchange.bridged, exchange.lost, exchange.late, exchange.held}) {
      row.push_back(std::to_string(count));
    }
    latency.add(std::move(row));
    if (exchange.bridged == 0 && exchange.missed == 0) continue;
    bridges.add({substructure.id, std::to_string(exchange.bridged), std::to_string(exchange.bridged_in_a_row),
                 fixed(exchange.bridged_energy_j, 6), fixed(exchange.bridged_energy_magnitude_j, 6),
                 std::to_string(exchange.missed)});
  }
  latency.print(stream);
  bridges.print(stream);
}

/// The last part of the test stands for all.
void print_clocks(const RunSummary& summary, std::ostream& stream) {
  TextTable clocks{{"clock less coordinator's", "s", "+- us", "drift ppm", "+-", "command ms", "answer ms"}};
  for (const SubstructureSummary& substructure : summary.substructures) {
    if (substructure.clock.empty()) continue;
    const ClockRelation& clock = substructure.clock.back();
    clocks.add({substructure.id, fixed(clock.offset_s, 6), fixed(clock.offset_uncertainty_s * 1e6, 1),
                fixed(clock.drift * 1e6, 1), fixed(clock.drift_uncertainty * 1e6, 1),
                fixed(clock.latency_there_s * kMilliseconds, 3), fixed(clock.latency_back_s * kMilliseconds, 3)});
  }
  clocks.print(stream);
}

void print_sites(const RunSummary& summary, std::ostream& stream) {
  TextTable tracking{{"tracking error", "RMS mm", "RMS %", "peak mm", "delay ms", "amplitude"}};
  TextTable energy{{"energy error", "peak J", "final J"}};
  TextTable timing{{"control loop", "late p50 us", "p99 us", "max us", "busy p99 us", "overruns", "priority", "cpu"}};
  for (const SubstructureSummary& substructure : summary.substructures) {
    for (const TrackingError& error : substructure.tracking) {
      tracking.add({substructure.id + " " + error.dof, fixed(error.rms_m * kMillimetres, 4),
                    fixed(error.rms_relative, kPercent, 2), fixed(error.peak_m * kMillimetres, 4),
                    fixed(error.equivalent_delay_s, kMilliseconds, 2), fixed(error.amplitude, 1.0, 4)});
    }
    if (substructure.loop_timing) {
      const LoopTimingSummary& loop = *substructure.loop_timing;
      timing.add({substructure.id, fixed(loop.start_lateness_us.p50, 0), fixed(loop.start_lateness_us.p99, 0),
                  fixed(loop.start_lateness_us.max, 0), fixed(loop.busy_us.p99, 0), std::to_string(loop.overruns),
                  loop.fifo_priority > 0 ? "FIFO " + std::to_string(loop.fifo_priority) : "ordinary",
                  loop.cpu ? std::to_string(*loop.cpu) : "any"});
    }
    if (substructure.energy_error) {
      energy.add(
          {substructure.id, fixed(substructure.energy_error->peak_j, 3), fixed(substructure.energy_error->final_j, 3)});
    }
  }
  tracking.print(stream);
  energy.print(stream);
  timing.print(stream);
}

/// Of those that refused any.
void print_refused_packets(const RunSummary& summary, std::ostream& stream) {
  TextTable refused{{"packets refused", "harmful", "plain text", "false", "departures"}};
  for (const ParticipantFileSummary& file : summary.participants) {
    if (!file.refused_packets || file.refused_packets->total() == 0) continue;
    std::vector<std::string> row{file.participant};
    for (const auto kind : {&RefusedPacketsSummary::harmful, &RefusedPacketsSummary::in_plain_text,
                            &RefusedPacketsSummary::announcements, &RefusedPacketsSummary::departures}) {
      row.push_back(std::to_string((*file.refused_packets).*kind));
    }
    refused.add(std::move(row));
  }
  refused.print(stream);
}

}  // namespace

std::string verdict(const RunSummary& summary) {
  std::string text{test_end(summary.stop_reason).verdict};
  const bool is_completed = summary.stop_reason == StopReason::completed;
  std::string where = is_completed || summary.end.who == kOperatorId ? "" : summary.end.who;
  if (!is_completed && summary.end.model_time_s) {
    where += (where.empty() ? "at " : ", at ") + fixed(*summary.end.model_time_s, 3) + " s";
  }
  if (!where.empty()) text += " (" + where + ")";
  if (const StallSummary& stalls = summary.stalls; stalls.count > 0) {
    text += "; specimens held (" + (stalls.count == 1 ? "once" : std::to_string(stalls.count) + " times, up to") + " " +
            fixed(stalls.longest_s, 2) + " s at " + fixed(stalls.model_time_s, 3) + " s)";
  }
  return summary.data_valid ? text : text + "; data invalid";
}

void print_comparisons(const std::vector<ReferenceComparison>& comparisons, std::ostream& stream) {
  for (const ReferenceComparison& comparison : comparisons) {
    TextTable table{
        {"against reference " + comparison.reference, "peak mm", "reference mm", "RMS diff. %", "largest %"}};
    for (const DofComparison& dof : comparison.dofs) {
      table.add({dof.dof, fixed(dof.peak_m * kMillimetres, 3), fixed(dof.reference_peak_m * kMillimetres, 3),
                 fixed(dof.rms_relative, kPercent, 4), fixed(dof.difference_relative, kPercent, 4)});
    }
    table.print(stream);
  }
}

void print_summary(const RunSummary& summary, std::ostream& stream) {
  print_head(summary, stream);
  std::vector<std::string> interlocks;
  for (const InterlockSummary& interlock : summary.interlocks) interlocks.push_back(sentence(interlock));
  print_list("interlocks", interlocks, stream);
  print_list("data invalid because", summary.data_faults, stream);
  print_list("faults", summary.faults, stream);
  print_peaks(summary, stream);
  print_comparisons(summary.references, stream);
  print_exchanges(summary, stream);
  print_clocks(summary, stream);
  print_sites(summary, stream);
  print_refused_packets(summary, stream);
  print_list("remarks", summary.remarks, stream);
}

}  // namespace hybridtest
