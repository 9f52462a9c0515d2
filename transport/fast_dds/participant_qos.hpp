#pragma once

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>

#include "transport/fast_dds/fast_dds_settings.hpp"

namespace hybridtest::fast_dds {

/// Translates the settings for Fast DDS: transports, discovery, leases.
/// @throws ConfigError as require_usable().
[[nodiscard]] eprosima::fastdds::dds::DomainParticipantQos participant_qos(const FastDdsSettings& settings);

}  // namespace hybridtest::fast_dds
