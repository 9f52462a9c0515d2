#pragma once

#include <chrono>
#include <memory>
#include <optional>

#include "core/time.hpp"
#include "transport/fast_dds/dds_version.hpp"
#include "transport/fast_dds/packet_filter.hpp"

namespace hybridtest::fast_dds {

/// TCP as of Fast DDS, begun and ended in an order that 2.9 does not keep by itself:
/// - Connections are accepted when the logical ports are open. Otherwise who connects in between is told that there is
///   no such port, asks again from another thread, and may then wait for the answer for ever.
/// - Nothing is passed on once a logical port is closed, and its closing waits for who is still inside. Fast DDS keeps
///   one mark for all connections, so that one takes away the receiver which another is about to use.
/// - Nobody connects to himself. Fast DDS does when a participant reads what it writes, takes the accepted end of that
///   connection for the other one, and leaves a thread behind that outlives the transport.
/// - A connection over which nothing comes is made again, see ConnectionWatch.
/// Of the messages that arrive, Fast DDS gets what a PacketFilter admits. TLS is taken off before.
/// @param lower     the transport of Fast DDS.
/// @param own       where others connect to this participant; nothing when nobody can.
/// @param refused   counts what the filter does not admit.
/// @param quiet     no message must have come for this time before Fast DDS closes the port itself.
[[nodiscard]] std::shared_ptr<rtps::TransportDescriptorInterface> tcp_transport(
    std::shared_ptr<rtps::TransportDescriptorInterface> lower, const std::optional<Locator>& own,
    Admission admission = Admission::plain,
    std::shared_ptr<RefusedPackets> refused = std::make_shared<RefusedPackets>(),
    Duration quiet = std::chrono::milliseconds{20});

}  // namespace hybridtest::fast_dds
