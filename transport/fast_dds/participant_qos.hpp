#pragma once

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>

#include <memory>

#include "transport/fast_dds/fast_dds_settings.hpp"
#include "transport/fast_dds/packet_filter.hpp"
#include "transport/fast_dds/polled_socket.hpp"

namespace hybridtest::fast_dds {

/// Translates the settings for Fast DDS: transports, discovery, leases.
/// @param socket   takes the messages from Fast DDS over UDP; null for a thread of Fast DDS. A profile does not use it.
/// @param refused   counts what the packet filter does not admit.
/// @throws ConfigError as require_usable().
[[nodiscard]] eprosima::fastdds::dds::DomainParticipantQos participant_qos(
    const FastDdsSettings& settings, const std::shared_ptr<PolledSocket>& socket = nullptr,
    const std::shared_ptr<RefusedPackets>& refused = std::make_shared<RefusedPackets>());

}  // namespace hybridtest::fast_dds
