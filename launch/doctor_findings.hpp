#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/real_time_thread.hpp"
#include "runtime/link_check.hpp"
#include "runtime/network_profile.hpp"
#include "scenario/scenario.hpp"

namespace hybridtest {

/// What `hybridtest doctor` looks at. `docs/across_hosts.md` explains each by its name.
enum class DoctorCode : std::uint8_t {
  host_name,
  own_address,
  port,
  discovery,
  connection,
  version,
  digest,
  loss,
  round_trip,
  clock_offset,
  clock,
  disk_room,
  disk_rate,
  real_time,
};
inline constexpr std::array kDoctorCodes{DoctorCode::host_name,    DoctorCode::own_address, DoctorCode::port,
                                         DoctorCode::discovery,    DoctorCode::connection,  DoctorCode::version,
                                         DoctorCode::digest,       DoctorCode::loss,        DoctorCode::round_trip,
                                         DoctorCode::clock_offset, DoctorCode::clock,       DoctorCode::disk_room,
                                         DoctorCode::disk_rate,    DoctorCode::real_time};
[[nodiscard]] std::string_view name(DoctorCode code) noexcept;

/// What `hybridtest doctor` says of one subject.
struct DoctorLine {
  enum class Verdict : std::uint8_t { good, note, fix };

  Verdict verdict = Verdict::good;
  DoctorCode code = DoctorCode::host_name;
  std::string text;    // what was found
  std::string advice;  // what to do; empty where nothing is to be done
};

/// Words of each line that is not `ok`, in its text or its advice. `docs/across_hosts.md` explains each.
inline constexpr std::array<std::string_view, 20> kDoctorFindings{
    "has no IPv4 address here",
    "which other hosts cannot reach",
    "no interface of this host has the address",
    "cannot be used",
    "no free pair of UDP ports",
    "was not found",
    "was not heard",
    "does not accept a connection",
    "has another version",
    "has another scenario",
    "commands were answered",
    "needs a shorter way",
    "the test starts all the same",
    "the test will be slower than its pace",
    "its clock is",
    "is not known to be synchronised",
    "cannot write in",
    "free room, or choose another disk",
    "not to a network drive",
    "the operating system refuses",
};

/// Beyond which recordings of different hosts cannot be laid side by side by their clocks.
inline constexpr double kClockOffset_s_max = 1.0;
/// Best-effort loss that repeated commands make up for at a small price.
inline constexpr double kLossRatio_max = 0.05;
/// In real time each lost message is a bridged step.
inline constexpr double kLossRatioRealTime_max = 0.01;
/// Room on the disk over the size of the run.
inline constexpr double kSpareDisk_min = 1.5;
/// Rate of the disk over that of the run.
inline constexpr double kSpareDiskRate_min = 4.0;

/// What a participant records.
struct RecordedVolume {
  double bytes = 0.0;
  double bytes_per_s = 0.0;  // 0 where the pace is not given
};

// Each function below takes what was measured and says what it means. None measures.

/// @param numeric   IPv4 address of the host of the profile; nothing when its name does not resolve.
[[nodiscard]] DoctorLine judge_name(const NetworkHost& host, NetworkType type,
                                    const std::optional<std::string>& numeric);
/// The address under which the others reach this participant is of no interface of this host.
[[nodiscard]] DoctorLine judge_foreign_address(std::string_view participant, const std::string& numeric);
/// @param error   of listening on the port; 0 when it is free.
[[nodiscard]] DoctorLine judge_tcp_port(std::uint16_t port, int error);
/// @param free_pair   first port of a pair that is free; nothing when there is none in the range.
[[nodiscard]] DoctorLine judge_udp_ports(const PortRange& range, std::optional<std::uint16_t> free_pair);
/// @param error   of connecting to the host; 0 when it accepted.
[[nodiscard]] DoctorLine judge_connection(const NetworkHost& host, int error, bool has_tls);
/// @param grant   the answer of the operating system; nothing when the participant asks for nothing.
[[nodiscard]] DoctorLine judge_privileges(std::string_view participant, const RealTimeRequest& request,
                                          const std::optional<RealTimeGrant>& grant);
/// @param free_bytes   on the disk; nothing when nothing can be written there.
[[nodiscard]] std::vector<DoctorLine> judge_disk(const RecordedVolume& volume, const std::string& folder,
                                                 std::optional<double> free_bytes, double bytes_per_s);
[[nodiscard]] DoctorLine judge_clock(bool is_synchronised);

/// The other participants as they were heard: presence, version, scenario.
[[nodiscard]] std::vector<DoctorLine> judge_others(const Scenario& scenario, std::string_view participant,
                                                   const std::vector<HeardParticipant>& heard);
/// One link: loss, round trip and clock.
[[nodiscard]] std::vector<DoctorLine> judge_link(const Scenario& scenario, const LinkMeasurement& link);

/// Of the time between two steps by the wall clock; as often commands are sent. In lockstep, that of one round trip.
[[nodiscard]] double step_period_s(const Scenario& scenario);
/// What a round trip may take in real time: as the coordinator asks for before it starts.
[[nodiscard]] double round_trip_s_max(const Scenario& scenario);

}  // namespace hybridtest
