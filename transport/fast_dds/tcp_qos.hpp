#pragma once

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <memory>

#include "transport/fast_dds/fast_dds_settings.hpp"
#include "transport/fast_dds/packet_filter.hpp"

namespace hybridtest::fast_dds {

/// TCP as the only transport of a participant, with the addresses that it is dialled at and dials.
///
/// The address that others dial is announced as the only one, so that each pair of participants shares one connection,
/// and a host behind a forwarded port is not looked for at the address that it has inside.
/// @param settings   with TCP.
/// @param refused    counts what the packet filter does not admit.
/// @throws ConfigError for addresses as to_tcp_locator(), for files that cannot be read, and when nobody listens.
void add_tcp(const FastDdsSettings& settings, const std::shared_ptr<RefusedPackets>& refused,
             eprosima::fastdds::dds::DomainParticipantQos& qos);

}  // namespace hybridtest::fast_dds
