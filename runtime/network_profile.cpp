#include "runtime/network_profile.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "core/config/section.hpp"
#include "core/config_error.hpp"
#include "core/messages.hpp"

namespace hybridtest {
namespace {

using config::Section;

constexpr const char* kNetworkSchema = "hybridtest-network/1";
constexpr int kDomainMax = 232;
constexpr int kPortMax = 65535;
constexpr int kDiscoveryPort = 11811;
/// On one host, where the profile says nothing: participants and tools together.
constexpr int kParticipantsOfHost = 10;

std::uint16_t to_port(std::int64_t port) { return static_cast<std::uint16_t>(port); }

bool is_udp(NetworkType type) { return type != NetworkType::tcp; }

std::optional<PortRange> parse_range(std::string_view text) {
  const std::size_t dash = text.find('-');
  if (dash == std::string_view::npos) return std::nullopt;
  const auto parse = [](std::string_view digits, std::uint16_t& port) {
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), port);
    return error == std::errc{} && end == digits.data() + digits.size() && port > 0;
  };
  PortRange range;
  if (!parse(text.substr(0, dash), range.first) || !parse(text.substr(dash + 1), range.last)) return std::nullopt;
  return range;
}

/// The ports of UDP follow from the domain; a profile writes them for the people who open them in a firewall.
std::optional<PortRange> read_udp_ports(Section& section, std::uint32_t domain) {
  const PortRange all = udp_ports(domain, kParticipantsOfHost);
  const std::string text = section.text("listens", fmt::format("{}-{}", all.first, all.last));
  const auto range = parse_range(text);
  const bool fits = range && range->first == all.first && range->last > range->first &&
                    (range->last - range->first) % 2 == 1 && range->last <= udp_ports(domain, 100).last;
  if (!fits) {
    section.error("listens", fmt::format("'{}' are not the UDP ports of domain {}: they begin at {}, two for each "
                                         "participant and tool on the host; expected for example {}-{}",
                                         text, domain, all.first, all.first, all.last));
    return std::nullopt;
  }
  return range;
}

NetworkHost read_host(Section section, std::string participant, const NetworkProfile& profile) {
  NetworkHost host;
  host.participant = std::move(participant);
  if (is_udp(profile.type)) {
    host.host = section.text("host");
    host.listens = read_udp_ports(section, profile.domain);
  } else {
    const bool can_be_dialled = section.has_optional("listens");
    host.host = can_be_dialled ? section.text("host") : section.text("host", "");
    if (can_be_dialled) {
      const std::uint16_t port = to_port(section.integer("listens", 1, kPortMax));
      host.listens = PortRange{port, port};
    }
  }
  if (section.has_optional("interface")) host.interface_address = section.text("interface");
  section.finish();
  return host;
}

void read_hosts(Section& root, NetworkProfile& profile) {
  const bool needs_hosts = profile.type == NetworkType::peers || profile.type == NetworkType::tcp;
  if (!needs_hosts && !root.has_optional("hosts")) return;
  Section hosts = root.section("hosts");
  for (const std::string& participant : hosts.keys()) {
    profile.hosts.push_back(read_host(hosts.section(participant), participant, profile));
  }
  hosts.finish();
  if (needs_hosts && profile.hosts.size() < 2) root.error("hosts", "expected one entry for each participant");
  const bool someone_listens =
      std::ranges::any_of(profile.hosts, [](const NetworkHost& host) { return host.listens.has_value(); });
  if (profile.type == NetworkType::tcp && !someone_listens) {
    root.error("hosts",
               "nobody listens: over TCP at least one participant has `listens`, a port that the others reach");
  }
  if (profile.type != NetworkType::tcp) return;
  for (const NetworkHost& one : profile.hosts) {
    for (const NetworkHost& other : profile.hosts) {
      if (&one >= &other || !one.listens || one.host != other.host || one.listens != other.listens) continue;
      root.error("hosts", fmt::format("{} and {} listen at the same port of {}; expected a port for each",
                                      one.participant, other.participant, one.host));
    }
  }
}

void read_tls(Section& root, const std::filesystem::path& directory, NetworkProfile& profile) {
  if (profile.type != NetworkType::tcp) return;
  auto section = root.optional_section("tls");
  if (!section) return;
  const auto file = [&](const char* key) { return directory / section->text(key); };
  profile.tls =
      fast_dds::TlsFiles{.authority = file("authority"), .certificate = file("certificate"), .key = file("key")};
  section->finish();
}

/// `{id}` stands for the participant that reads the profile.
std::filesystem::path own_file(const std::filesystem::path& pattern, std::string_view participant) {
  std::string text = pattern.string();
  constexpr std::string_view kOwn = "{id}";
  for (std::size_t at = text.find(kOwn); at != std::string::npos; at = text.find(kOwn, at + participant.size())) {
    text.replace(at, kOwn.size(), participant);
  }
  return text;
}

std::string address(const std::string& host, std::uint16_t port) { return fmt::format("{}:{}", host, port); }

void use_peers(const NetworkProfile& profile, fast_dds::FastDdsSettings& settings) {
  settings.looks_by_multicast = false;
  for (const NetworkHost& host : profile.hosts) {
    // The first port of each pair is that of discovery.
    for (int port = host.listens->first; port < host.listens->last; port += 2) {
      const std::string peer = address(host.host, to_port(port));
      if (std::ranges::find(settings.initial_peers, peer) == settings.initial_peers.end()) {
        settings.initial_peers.push_back(peer);
      }
    }
  }
}

/// Of two that listen the later one in the file dials, so that they share one connection.
void use_tcp(const NetworkProfile& profile, std::string_view participant, fast_dds::FastDdsSettings& settings) {
  fast_dds::TcpSettings tcp;
  for (const NetworkHost& host : profile.hosts) {
    if (!host.listens) continue;
    const std::string where = address(host.host, host.listens->first);
    if (host.participant == participant) {
      tcp.listens_at = where;
      break;
    }
    tcp.dials.push_back(where);
  }
  if (profile.tls) {
    tcp.tls = fast_dds::TlsFiles{.authority = profile.tls->authority,
                                 .certificate = own_file(profile.tls->certificate, participant),
                                 .key = own_file(profile.tls->key, participant)};
  }
  settings.tcp = tcp;
}

}  // namespace

const NetworkHost* NetworkProfile::find(std::string_view participant) const noexcept {
  const auto found = std::ranges::find(hosts, participant, &NetworkHost::participant);
  return found == hosts.end() ? nullptr : &*found;
}

PortRange udp_ports(std::uint32_t domain, int participants) {
  const int first = 7400 + 250 * static_cast<int>(domain) + 10;
  return {to_port(first), to_port(std::min(kPortMax, first + 2 * participants - 1))};
}

void move_to_domain(NetworkProfile& profile, std::uint32_t domain) {
  const int shift = udp_ports(domain, 1).first - udp_ports(profile.domain, 1).first;
  profile.domain = domain;
  if (!is_udp(profile.type)) return;
  for (NetworkHost& host : profile.hosts) {
    host.listens = PortRange{to_port(host.listens->first + shift), to_port(host.listens->last + shift)};
  }
}

NetworkProfile read_network_profile(const std::filesystem::path& file) {
  config::Document document = config::Document::load(file);
  Section root = document.root();
  static_cast<void>(root.choice("schema", {kNetworkSchema}));
  NetworkProfile profile;
  profile.type =
      static_cast<NetworkType>(root.choice("type", {"one_host", "multicast", "peers", "discovery_server", "tcp"}));
  profile.domain = static_cast<std::uint32_t>(root.integer("domain", 0, kDomainMax, 0));
  read_hosts(root, profile);
  if (profile.type == NetworkType::discovery_server) {
    Section server = root.section("server");
    const std::uint16_t port = to_port(server.integer("listens", 1, kPortMax, kDiscoveryPort));
    profile.server = {.participant = "server",
                      .host = server.text("host"),
                      .listens = PortRange{port, port},
                      .interface_address = {}};
    if (server.has_optional("interface")) profile.server.interface_address = server.text("interface");
    server.finish();
  }
  read_tls(root, document.directory(), profile);
  root.finish();
  document.throw_if_errors();
  return profile;
}

fast_dds::FastDdsSettings settings_of(const NetworkProfile& profile, std::string_view participant) {
  fast_dds::FastDdsSettings settings;
  settings.domain = profile.domain;
  const NetworkHost* own = profile.find(participant);
  const bool must_be_named = profile.type == NetworkType::peers || profile.type == NetworkType::tcp;
  if (own == nullptr && must_be_named && participant != kOperatorId) {
    std::string known;
    for (const NetworkHost& host : profile.hosts) known += (known.empty() ? "" : ", ") + host.participant;
    throw ConfigError{fmt::format("--network: the profile has no host for '{}'; it has {}; add an entry to `hosts`",
                                  participant, known)};
  }
  if (own != nullptr) settings.interface_address = own->interface_address;
  switch (profile.type) {
    case NetworkType::one_host: settings.loopback_only = true; break;
    case NetworkType::multicast: break;
    case NetworkType::peers: use_peers(profile, settings); break;
    case NetworkType::discovery_server:
      settings.discovery_server = address(profile.server.host, profile.server.listens->first);
      break;
    case NetworkType::tcp: use_tcp(profile, participant, settings); break;
  }
  return settings;
}

}  // namespace hybridtest
