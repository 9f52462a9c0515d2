#pragma once

#include <memory>

#include "transport/fast_dds/dds_version.hpp"
#include "transport/fast_dds/packet_filter.hpp"
#include "transport/fast_dds/polled_socket.hpp"

namespace hybridtest::fast_dds {

/// UDP as of Fast DDS, but the port of the messages is that of a PolledSocket. Discovery and liveliness keep their own
/// port and the thread of Fast DDS, so a participant whose node computes for long stays alive for the others.
/// Of what arrives at either port, Fast DDS gets what a PacketFilter admits.
/// @param socket    read by whoever waits on the waker of the participant.
/// @param refused   counts what the filter does not admit.
[[nodiscard]] std::shared_ptr<rtps::TransportDescriptorInterface> polled_transport(
    std::shared_ptr<rtps::UDPv4TransportDescriptor> udp, std::shared_ptr<PolledSocket> socket, std::uint32_t domain,
    bool loopback_only, Admission admission = Admission::plain,
    std::shared_ptr<RefusedPackets> refused = std::make_shared<RefusedPackets>());

}  // namespace hybridtest::fast_dds
