#pragma once

#include <string>

#include "transport/transport.hpp"

namespace hybridtest {

/// How many packets a participant has refused unread, and of which kind; empty where there were none.
[[nodiscard]] std::string refused_packets_text(const TransportCounters& counters);

}  // namespace hybridtest
