#pragma once

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>

#include "transport/fast_dds/fast_dds_settings.hpp"

namespace hybridtest::fast_dds {

/// TCP as the only transport of a participant, with the addresses that it is dialled at and dials.
///
/// The address that others dial is announced as the only one, so that each pair of participants shares one connection,
/// and a host behind a forwarded port is not looked for at the address that it has inside.
/// @param settings   with TCP.
/// @throws ConfigError for addresses as to_tcp_locator(), for files that cannot be read, and when nobody listens.
void add_tcp(const FastDdsSettings& settings, eprosima::fastdds::dds::DomainParticipantQos& qos);

}  // namespace hybridtest::fast_dds
