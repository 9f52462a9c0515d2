#include "launch/doctor_findings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>

#include "recording/run_file.hpp"
#include "runtime/version.hpp"

namespace hybridtest {
namespace {

using Verdict = DoctorLine::Verdict;

std::string milliseconds_text(double seconds) { return fmt::format("{:.3g} ms", 1e3 * seconds); }
std::string megabytes_text(double bytes) { return fmt::format("{:.3g} MB", bytes / 1e6); }

std::string real_time_text(const RealTimeGrant& grant) {
  std::string text;
  const auto add = [&text](const char* what, int error) {
    if (error != 0) text += fmt::format("{}{}: {}", text.empty() ? "" : "; ", what, std::strerror(error));
  };
  add("SCHED_FIFO", grant.scheduling_error);
  add("locked memory", grant.memory_error);
  add("processor", grant.affinity_error.value_or(0));
  return text;
}

DoctorLine judge_loss(const LinkMeasurement& link, bool is_real_time) {
  const double loss_max = is_real_time ? kLossRatioRealTime_max : kLossRatio_max;
  const bool keeps = link.lost_ratio() <= loss_max;
  return {keeps ? Verdict::good : Verdict::fix, DoctorCode::loss,
          fmt::format("{}: {} of {} commands were answered, {:.3g} % lost", link.substructure.text(), link.answered,
                      link.sent, 100.0 * link.lost_ratio()),
          keeps ? "" : "use a wired connection or a quieter hour; over long distances a profile with TCP"};
}

DoctorLine judge_round_trip(const Scenario& scenario, const LinkMeasurement& link) {
  const double period_s = step_period_s(scenario);
  std::string text = fmt::format("{}: round trip {} at least, {} median, {} for 99 of 100", link.substructure.text(),
                                 milliseconds_text(link.round_trip_s_min), milliseconds_text(link.round_trip_s_median),
                                 milliseconds_text(link.round_trip_s_p99));
  if (scenario.time.mode == CouplingMode::lockstep) return {Verdict::good, DoctorCode::round_trip, text, ""};
  text += fmt::format("; a step takes {}", milliseconds_text(period_s));
  if (scenario.time.mode == CouplingMode::paced) {
    const bool slows = link.round_trip_s_median > period_s;
    return {slows ? Verdict::note : Verdict::good, DoctorCode::round_trip, text,
            slows ? "the test will be slower than its pace; a larger `time.time_scale` says so beforehand" : ""};
  }
  text += fmt::format(", of which {} are for the round trip", milliseconds_text(round_trip_s_max(scenario)));
  if (link.round_trip_s_p99 <= round_trip_s_max(scenario)) return {Verdict::good, DoctorCode::round_trip, text, ""};
  if (scenario.real_time.bridging.start_anyway) {
    return {Verdict::note, DoctorCode::round_trip, text, "the test starts all the same, and bridges what is late"};
  }
  return {Verdict::fix, DoctorCode::round_trip, text,
          "a test in real time needs a shorter way: same building, wired; or `time.mode: paced`"};
}

DoctorLine judge_clock_offset(const LinkMeasurement& link) {
  const bool agrees = std::abs(link.clock_offset_s) <= kClockOffset_s_max;
  return {agrees ? Verdict::good : Verdict::fix, DoctorCode::clock_offset,
          fmt::format("{}: its clock is {:.3g} s {} that of the coordinator, known within {}", link.substructure.text(),
                      std::abs(link.clock_offset_s), link.clock_offset_s < 0.0 ? "behind" : "ahead of",
                      milliseconds_text(link.clock_uncertainty_s)),
          agrees ? "" : "start a time service (chrony or systemd-timesyncd) on both hosts"};
}

}  // namespace

std::string_view name(DoctorCode code) noexcept {
  switch (code) {
    case DoctorCode::host_name: return "host_name";
    case DoctorCode::own_address: return "own_address";
    case DoctorCode::port: return "port";
    case DoctorCode::discovery: return "discovery";
    case DoctorCode::connection: return "connection";
    case DoctorCode::version: return "version";
    case DoctorCode::digest: return "digest";
    case DoctorCode::loss: return "loss";
    case DoctorCode::round_trip: return "round_trip";
    case DoctorCode::clock_offset: return "clock_offset";
    case DoctorCode::clock: return "clock";
    case DoctorCode::disk_room: return "disk_room";
    case DoctorCode::disk_rate: return "disk_rate";
    case DoctorCode::real_time: return "real_time";
  }
  return "";
}

double step_period_s(const Scenario& scenario) {
  constexpr double kLockstep_s = 0.005;
  return scenario.time.mode == CouplingMode::lockstep ? kLockstep_s : scenario.time.step_s * scenario.time.time_scale;
}

double round_trip_s_max(const Scenario& scenario) {
  return scenario.time.step_s - to_seconds(scenario.real_time.bridging.deadline);
}

DoctorLine judge_name(const NetworkHost& host, NetworkType type, const std::optional<std::string>& numeric) {
  const std::string what = fmt::format("{}: host {}", host.participant, host.host);
  if (!numeric) {
    return {Verdict::fix, DoctorCode::host_name, what + " has no IPv4 address here",
            "correct the name in the network profile, or write the address"};
  }
  const bool names_itself = numeric->starts_with("127.") && !host.host.starts_with("127.") && host.host != "localhost";
  if (names_itself && type != NetworkType::one_host) {
    return {Verdict::fix, DoctorCode::host_name,
            fmt::format("{} is {} here, which other hosts cannot reach", what, *numeric),
            "write the address of the network interface in the profile, or correct /etc/hosts"};
  }
  return {Verdict::good, DoctorCode::host_name, fmt::format("{} is {}", what, *numeric), ""};
}

DoctorLine judge_foreign_address(std::string_view participant, const std::string& numeric) {
  return {Verdict::note, DoctorCode::own_address,
          fmt::format("no interface of this host has the address {} of {}", numeric, participant),
          "right where a router forwards the port to this host; otherwise correct the profile"};
}

DoctorLine judge_tcp_port(std::uint16_t port, int error) {
  if (error == 0) return {Verdict::good, DoctorCode::port, fmt::format("TCP port {} is free", port), ""};
  return {Verdict::fix, DoctorCode::port, fmt::format("TCP port {} cannot be used: {}", port, std::strerror(error)),
          "end the program that holds it (`ss -ltnp`), or give another port to `listens`"};
}

DoctorLine judge_udp_ports(const PortRange& range, std::optional<std::uint16_t> free_pair) {
  if (free_pair) {
    return {Verdict::good, DoctorCode::port, fmt::format("UDP ports {} and {} are free", *free_pair, *free_pair + 1),
            ""};
  }
  return {Verdict::fix, DoctorCode::port, fmt::format("no free pair of UDP ports in {}-{}", range.first, range.last),
          "end other participants on this host, or use another domain"};
}

DoctorLine judge_connection(const NetworkHost& host, int error, bool has_tls) {
  const std::string what = fmt::format("{} at {}:{}", host.participant, host.host, host.listens->first);
  if (error == 0) {
    return {Verdict::good, DoctorCode::connection, what + " accepts connections",
            has_tls ? "if it is not found all the same, compare the certificates of both sides" : ""};
  }
  return {Verdict::fix, DoctorCode::connection,
          fmt::format("{} does not accept a connection: {}", what, std::strerror(error)),
          error == ECONNREFUSED ? "nobody listens there now: start doctor or the test there at the same time"
                                : "a firewall or a wrong address on the way: open the port, or correct it"};
}

DoctorLine judge_privileges(std::string_view participant, const RealTimeRequest& request,
                            const std::optional<RealTimeGrant>& grant) {
  if (!grant) {
    return {Verdict::good, DoctorCode::real_time,
            fmt::format("{} needs no real-time privileges in this test", participant), ""};
  }
  if (grant->is_complete()) {
    return {Verdict::good, DoctorCode::real_time,
            fmt::format("SCHED_FIFO priority {} and locked memory are granted", request.priority), ""};
  }
  return {request.allow_degraded ? Verdict::note : Verdict::fix, DoctorCode::real_time,
          "the operating system refuses: " + real_time_text(*grant),
          "raise rtprio and memlock in /etc/security/limits.conf and log in again; see docs/real_time.md"};
}

std::vector<DoctorLine> judge_disk(const RecordedVolume& volume, const std::string& folder,
                                   std::optional<double> free_bytes, double bytes_per_s) {
  if (!free_bytes) {
    return {{Verdict::fix, DoctorCode::disk_room, "cannot write in " + folder,
             "choose another folder with --out, or free the disk"}};
  }
  const bool has_room = *free_bytes >= kSpareDisk_min * volume.bytes;
  const bool is_fast = bytes_per_s >= kSpareDiskRate_min * volume.bytes_per_s;
  return {{has_room ? Verdict::good : Verdict::fix, DoctorCode::disk_room,
           fmt::format("the run takes at most about {}; {} has {} free", megabytes_text(volume.bytes), folder,
                       megabytes_text(*free_bytes)),
           has_room ? "" : "free room, or choose another disk with --out"},
          {is_fast ? Verdict::good : Verdict::fix, DoctorCode::disk_rate,
           fmt::format("the disk takes {}/s; the run writes at most {}", megabytes_text(bytes_per_s),
                       volume.bytes_per_s > 0.0 ? megabytes_text(volume.bytes_per_s) + "/s" : "as fast as it runs"),
           is_fast ? "" : "record to a local disk, not to a network drive"}};
}

DoctorLine judge_clock(bool is_synchronised) {
  if (is_synchronised) return {Verdict::good, DoctorCode::clock, "the clock of this host is synchronised", ""};
  return {Verdict::note, DoctorCode::clock, "the clock of this host is not known to be synchronised",
          "start a time service (chrony or systemd-timesyncd) where recordings are compared by time of day"};
}

std::vector<DoctorLine> judge_others(const Scenario& scenario, std::string_view participant,
                                     const std::vector<HeardParticipant>& heard) {
  std::vector<std::string> expected{std::string{kCoordinatorId}};
  // Over TCP, substructures that nobody can connect to do not hear each other, and need not.
  if (participant == kCoordinatorId) {
    expected.clear();
    for (const SubstructureScenario& one : scenario.substructures) expected.push_back(one.id);
  }
  std::vector<DoctorLine> lines;
  for (const std::string& id : expected) {
    const auto other =
        std::ranges::find(heard, ParticipantId{id}, [](const HeardParticipant& one) { return one.status.id; });
    if (other == heard.end() || other->version.empty()) {
      lines.push_back({Verdict::fix, DoctorCode::discovery,
                       fmt::format("{} was not {}", id, other == heard.end() ? "found" : "heard"),
                       "run `hybridtest doctor` there at the same time, with the same scenario, domain and network "
                       "profile; then check cables, addresses and firewalls"});
      continue;
    }
    lines.push_back({Verdict::good, DoctorCode::discovery, id + " was found", ""});
    const bool same_version = other->version == software_version();
    lines.push_back({same_version ? Verdict::good : Verdict::fix, DoctorCode::version,
                     same_version ? fmt::format("{} has the same version, {}", id, other->version)
                                  : fmt::format("{} has another version: {} there, {} here", id, other->version,
                                                software_version()),
                     same_version ? "" : "install the same version on all hosts"});
    const bool same_scenario = other->status.scenario_digest == scenario.digest;
    lines.push_back(
        {same_scenario ? Verdict::good : Verdict::fix, DoctorCode::digest,
         same_scenario ? fmt::format("{} has the same scenario, digest {:.12}", id, hex(scenario.digest))
                       : fmt::format("{} has another scenario: digest {:.12} there, {:.12} here", id,
                                     hex(other->status.scenario_digest), hex(scenario.digest)),
         same_scenario ? "" : "send one file to all hosts, with the files that it names and the same --set"});
  }
  return lines;
}

std::vector<DoctorLine> judge_link(const Scenario& scenario, const LinkMeasurement& link) {
  if (link.sent == 0) return {};
  std::vector<DoctorLine> lines{judge_loss(link, scenario.time.mode == CouplingMode::real_time)};
  if (link.answered == 0) return lines;
  lines.push_back(judge_round_trip(scenario, link));
  lines.push_back(judge_clock_offset(link));
  return lines;
}

}  // namespace hybridtest
