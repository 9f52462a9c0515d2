#include "launch/doctor_checks.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/poll.h>
#include <sys/socket.h>
#include <sys/timex.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <system_error>
#include <thread>

#include "core/real_time_thread.hpp"
#include "runtime/executor.hpp"
#include "runtime/participant.hpp"

namespace hybridtest {
namespace {

constexpr int kConnect_ms = 3000;

std::optional<std::string> ipv4_of(const std::string& host) {
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  if (getaddrinfo(host.c_str(), nullptr, &hints, &found) != 0 || found == nullptr) return std::nullopt;
  std::array<char, INET_ADDRSTRLEN> text{};
  const auto* address = reinterpret_cast<const sockaddr_in*>(found->ai_addr);
  inet_ntop(AF_INET, &address->sin_addr, text.data(), text.size());
  freeaddrinfo(found);
  return text.data();
}

/// A socket that closes itself.
class Probe {
 public:
  explicit Probe(int type) : type_{type}, descriptor_{socket(AF_INET, type | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)} {}
  ~Probe() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  Probe(const Probe&) = delete;
  Probe& operator=(const Probe&) = delete;

  /// 0 when the address of this host can be listened on, otherwise the error.
  [[nodiscard]] int bind_error(const std::string& numeric, std::uint16_t port) const {
    // Over TCP a connection that has just ended does not hold the port; over UDP the option would hide who does.
    const int reuse = type_ == SOCK_STREAM ? 1 : 0;
    setsockopt(descriptor_, SOL_SOCKET, SO_REUSEADDR, &reuse, sizeof reuse);
    const sockaddr_in address = address_of(numeric, port);
    return bind(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 ? 0 : errno;
  }
  /// 0 when somebody accepts a connection there, otherwise the error.
  [[nodiscard]] int connect_error(const std::string& numeric, std::uint16_t port) const {
    const sockaddr_in address = address_of(numeric, port);
    if (connect(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return 0;
    if (errno != EINPROGRESS) return errno;
    pollfd answer{.fd = descriptor_, .events = POLLOUT, .revents = 0};
    if (poll(&answer, 1, kConnect_ms) == 0) return ETIMEDOUT;
    int error = 0;
    socklen_t size = sizeof error;
    getsockopt(descriptor_, SOL_SOCKET, SO_ERROR, &error, &size);
    return error;
  }

 private:
  static sockaddr_in address_of(const std::string& numeric, std::uint16_t port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    inet_pton(AF_INET, numeric.c_str(), &address.sin_addr);
    return address;
  }

  int type_;
  int descriptor_;
};

bool is_own_address(const std::string& numeric) { return Probe{SOCK_DGRAM}.bind_error(numeric, 0) == 0; }

/// 0 when the port can be listened on, otherwise the error.
int port_error(int type, std::uint16_t port) { return Probe{type}.bind_error("0.0.0.0", port); }

DoctorLine check_name(const NetworkHost& host, NetworkType type) { return judge_name(host, type, ipv4_of(host.host)); }

DoctorLine check_own_port(const NetworkHost& own, NetworkType type) {
  if (type == NetworkType::tcp) return judge_tcp_port(own.listens->first, port_error(SOCK_STREAM, own.listens->first));
  for (int port = own.listens->first; port < own.listens->last; port += 2) {
    const auto first = static_cast<std::uint16_t>(port);
    const auto second = static_cast<std::uint16_t>(port + 1);
    const bool is_free = port_error(SOCK_DGRAM, first) == 0 && port_error(SOCK_DGRAM, second) == 0;
    if (is_free) return judge_udp_ports(*own.listens, first);
  }
  return judge_udp_ports(*own.listens, std::nullopt);
}

RecordedVolume volume_of(const Scenario& scenario, std::string_view participant) {
  const double wall_s = scenario.time.duration_s * scenario.time.time_scale;
  const SubstructureScenario* substructure = scenario.find(participant);
  const std::vector<TableLayout> tables =
      substructure == nullptr ? CoordinatorParticipant::tables(scenario) : substructure_tables(*substructure);
  RecordedVolume volume;
  for (const TableLayout& table : tables) {
    double rows = static_cast<double>(scenario.time.last_step) + 1.0;
    if (substructure != nullptr && substructure->role == Role::experimental_site && table.name == "control") {
      rows = std::max(rows, substructure->site.control_rate_hz * wall_s);
    }
    volume.bytes += 8.0 * rows * static_cast<double>(table.columns.size());
  }
  if (scenario.time.mode != CouplingMode::lockstep && wall_s > 0.0) volume.bytes_per_s = volume.bytes / wall_s;
  return volume;
}

/// [byte/s] of a file that is written and forced to the disk; nothing when it cannot be written.
std::optional<double> write_rate(const std::filesystem::path& directory) {
  constexpr std::size_t kBlock = 1U << 20U;
  constexpr int kBlocks = 16;
  std::string file = (directory / ".hybridtest_doctor_XXXXXX").string();
  const int probe = mkstemp(file.data());
  if (probe < 0) return std::nullopt;
  const std::vector<char> block(kBlock, 'h');
  const ProcessClock clock;
  bool is_written = true;
  for (int i = 0; i < kBlocks; ++i) is_written = is_written && write(probe, block.data(), kBlock) == kBlock;
  is_written = is_written && fdatasync(probe) == 0;
  const double taken_s = to_seconds(clock.now().time_since_epoch());
  close(probe);
  unlink(file.c_str());
  if (!is_written) return std::nullopt;
  return static_cast<double>(kBlock) * kBlocks / std::max(taken_s, 1e-6);
}

}  // namespace

std::vector<DoctorLine> check_addresses(const NetworkProfile& profile, std::string_view participant) {
  std::vector<DoctorLine> lines;
  for (const NetworkHost& host : profile.hosts) {
    if (!host.host.empty()) lines.push_back(check_name(host, profile.type));
  }
  if (profile.type == NetworkType::discovery_server) lines.push_back(check_name(profile.server, profile.type));
  const NetworkHost* own = profile.find(participant);
  if (own == nullptr) return lines;
  const auto numeric = own->host.empty() ? std::nullopt : ipv4_of(own->host);
  if (own->listens && numeric && !is_own_address(*numeric)) {
    lines.push_back(judge_foreign_address(participant, *numeric));
  }
  if (own->listens) lines.push_back(check_own_port(*own, profile.type));
  return lines;
}

std::vector<DoctorLine> check_connections(const NetworkProfile& profile, std::string_view participant) {
  std::vector<DoctorLine> lines;
  if (profile.type != NetworkType::tcp) return lines;
  for (const NetworkHost& host : profile.hosts) {
    const auto numeric = ipv4_of(host.host);
    if (!host.listens || host.participant == participant || !numeric) continue;
    const int error = Probe{SOCK_STREAM}.connect_error(*numeric, host.listens->first);
    lines.push_back(judge_connection(host, error, profile.tls.has_value()));
  }
  return lines;
}

DoctorLine check_privileges(const Scenario& scenario, std::string_view participant) {
  const SubstructureScenario* substructure = scenario.find(participant);
  const RealTimeRequest request = substructure == nullptr ? scenario.real_time.coordinator : substructure->real_time;
  const bool has_loop = substructure != nullptr && substructure->role == Role::experimental_site &&
                        scenario.time.mode != CouplingMode::lockstep;
  if (scenario.time.mode != CouplingMode::real_time && !has_loop) {
    return judge_privileges(participant, request, std::nullopt);
  }
  RealTimeGrant grant;
  std::thread{[&] { grant = enter_real_time(request); }}.join();
  return judge_privileges(participant, request, grant);
}

std::vector<DoctorLine> check_disk(const Scenario& scenario, std::string_view participant,
                                   const std::filesystem::path& directory) {
  std::error_code error;
  std::filesystem::path there = std::filesystem::absolute(directory.empty() ? "." : directory);
  while (!std::filesystem::is_directory(there, error) && there.has_relative_path()) there = there.parent_path();
  const std::filesystem::space_info space = std::filesystem::space(there, error);
  const auto rate = write_rate(there);
  std::optional<double> free_bytes;
  if (!error && rate) free_bytes = static_cast<double>(space.available);
  return judge_disk(volume_of(scenario, participant), there.string(), free_bytes, rate.value_or(0.0));
}

DoctorLine check_clock() {
  timex state{};
  const int answer = adjtimex(&state);
  const bool is_kept = answer >= 0 && answer != TIME_ERROR && (state.status & STA_UNSYNC) == 0;
  return judge_clock(is_kept);
}

}  // namespace hybridtest
