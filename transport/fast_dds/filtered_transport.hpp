#pragma once

#include <functional>
#include <memory>

#include "transport/fast_dds/dds_version.hpp"
#include "transport/fast_dds/packet_filter.hpp"

namespace hybridtest::fast_dds {

/// UDP as of Fast DDS, which gets what a PacketFilter admits, one packet at a time from all ports: Fast DDS 2.9 takes
/// in two announcements of one participant at the same time, and one thread then reads the addresses that the other has
/// deleted (its pull request 4268).
/// @param lower     the transport of Fast DDS.
/// @param refused   counts what the filter does not admit.
/// @param first     called before a packet is taken in; may be empty.
[[nodiscard]] std::shared_ptr<rtps::TransportDescriptorInterface> filtered_transport(
    std::shared_ptr<rtps::TransportDescriptorInterface> lower, Admission admission,
    std::shared_ptr<RefusedPackets> refused, std::function<void()> first = nullptr);

}  // namespace hybridtest::fast_dds
