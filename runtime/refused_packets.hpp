#pragma once

#include <string>
#include <string_view>

#include "core/records.hpp"
#include "transport/transport.hpp"

namespace hybridtest {

/// How many packets a participant has refused unread, and of which kind; empty where there were none.
[[nodiscard]] std::string refused_packets_text(const TransportCounters& counters);

/// The same in its recording: one row at the end, also where there were none.
inline constexpr std::string_view kRefusedPacketsTable = "refused_packets";
[[nodiscard]] TableLayout refused_packets_table();
void record_refused_packets(const TransportCounters& counters, RowSink& sink);

}  // namespace hybridtest
