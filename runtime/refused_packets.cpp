#include "runtime/refused_packets.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <string_view>

namespace hybridtest {

std::string refused_packets_text(const TransportCounters& counters) {
  std::string kinds;
  const auto add = [&](std::uint64_t count, std::string_view what) {
    if (count > 0) kinds += fmt::format("{}{} {}", kinds.empty() ? "" : ", ", count, what);
  };
  add(counters.refused_in_plain_text, "in plain text");
  add(counters.refused_announcements, "that announce falsely or in the name of another");
  add(counters.refused_harmful, "that would hang or end the process");
  add(counters.refused_departures, "that say that a participant has left (each sends some when it leaves)");
  if (kinds.empty()) return {};
  return "packets refused by the packet filter: " + kinds + " (docs/security.md)";
}

TableLayout refused_packets_table() {
  return {std::string{kRefusedPacketsTable},
          {{"harmful", ""}, {"in_plain_text", ""}, {"announcements", ""}, {"departures", ""}}};
}

void record_refused_packets(const TransportCounters& counters, RowSink& sink) {
  sink.append(std::array{
      static_cast<double>(counters.refused_harmful), static_cast<double>(counters.refused_in_plain_text),
      static_cast<double>(counters.refused_announcements), static_cast<double>(counters.refused_departures)});
}

}  // namespace hybridtest
