#pragma once

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <filesystem>

namespace hybridtest::fast_dds {

/// Switches DDS Security on: every other participant must prove its identity, may say what its permissions say, and
/// everything is encrypted. With it nobody without credentials of the same test can talk to this participant.
/// @param credentials   folder of one participant, see credentials.hpp.
/// @throws ConfigError as require_valid_credentials().
void add_security(const std::filesystem::path& credentials, eprosima::fastdds::dds::DomainParticipantQos& qos);

}  // namespace hybridtest::fast_dds
