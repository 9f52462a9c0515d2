#pragma once

#include <chrono>
#include <memory>
#include <optional>

#include "core/time.hpp"
#include "transport/fast_dds/dds_version.hpp"

namespace hybridtest::fast_dds {

/// TCP as of Fast DDS, begun and ended in an order that 2.9 does not keep by itself:
/// - Connections are accepted when the logical ports are open. Otherwise who connects in between is told that there is
///   no such port, asks again from another thread, and may then wait for the answer for ever.
/// - Nothing is passed on once a logical port is closed, and its closing waits for who is still inside. Fast DDS keeps
///   one mark for all connections, so that one takes away the receiver which another is about to use.
/// - Nobody connects to himself. Fast DDS does when a participant reads what it writes, takes the accepted end of that
///   connection for the other one, and leaves a thread behind that outlives the transport.
/// @param lower   the transport of Fast DDS.
/// @param own     where others connect to this participant; nothing when nobody can.
/// @param quiet   no message must have come for this time before Fast DDS closes the port itself.
[[nodiscard]] std::shared_ptr<rtps::TransportDescriptorInterface> tcp_transport(
    std::shared_ptr<rtps::TransportDescriptorInterface> lower, const std::optional<Locator>& own,
    Duration quiet = std::chrono::milliseconds{20});

}  // namespace hybridtest::fast_dds
