#pragma once

#include <memory>
#include <string_view>

#include "transport/fast_dds/fast_dds_settings.hpp"
#include "transport/transport.hpp"

namespace hybridtest::fast_dds {

/// Joins a test over DDS: one DomainParticipant, in the partition named as the test.
///
/// Threads of Fast DDS fill the inboxes; the ports may be used from any one thread each. All
/// ports must be gone before the transport.
///
/// @param test_name   1 to 64 characters without `*?[]/`, which have a meaning in partitions.
/// @throws ConfigError for such a name, and for settings as require_usable().
/// @throws std::runtime_error when Fast DDS refuses: no free port.
[[nodiscard]] std::unique_ptr<Transport> make_fast_dds_transport(const FastDdsSettings& settings,
                                                                 std::string_view test_name);

}  // namespace hybridtest::fast_dds
