#pragma once

// All names of Fast DDS that differ between its major versions, so that only this file changes
// for another version.

#include <fastrtps/config.h>

#if FASTRTPS_VERSION_MAJOR != 2
#error "this file is written for Fast DDS 2.x; define the names below for this version"
#endif

#include <fastdds/rtps/common/Locator.h>
#include <fastdds/rtps/common/PortParameters.h>
#include <fastdds/rtps/participant/ParticipantDiscoveryInfo.h>
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>
#include <fastdds/rtps/transport/TCPv4TransportDescriptor.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastdds/rtps/transport/shared_mem/SharedMemTransportDescriptor.h>
#include <fastrtps/attributes/LibrarySettingsAttributes.h>
#include <fastrtps/types/TypesBase.h>
#include <fastrtps/utils/IPFinder.h>
#include <fastrtps/utils/IPLocator.h>
#include <fastrtps/xmlparser/XMLProfileManager.h>

#include <atomic>
#include <cstdint>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <mutex>
#include <utility>

#include "hybridtestPubSubTypes.h"

namespace hybridtest::fast_dds {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastdds::rtps;

using Locator = eprosima::fastrtps::rtps::Locator_t;
using PortParameters = eprosima::fastrtps::rtps::PortParameters;
using IpFinder = eprosima::fastrtps::rtps::IPFinder;
using IpLocator = eprosima::fastrtps::rtps::IPLocator;
using DdsDuration = eprosima::fastrtps::Duration_t;
using GuidPrefix = eprosima::fastrtps::rtps::GuidPrefix_t;
using ReturnCode = eprosima::fastrtps::types::ReturnCode_t;
using DiscoveryProtocol = eprosima::fastrtps::rtps::DiscoveryProtocol_t;
using RemoteServer = eprosima::fastdds::rtps::RemoteServerAttributes;
using Payload = eprosima::fastrtps::rtps::SerializedPayload_t;
using InstanceHandle = eprosima::fastrtps::rtps::InstanceHandle_t;
using DiscoveryInfo = eprosima::fastrtps::rtps::ParticipantDiscoveryInfo;

inline const ReturnCode kReturnOk = ReturnCode::RETCODE_OK;
inline constexpr auto kPreallocated = eprosima::fastrtps::rtps::PREALLOCATED_MEMORY_MODE;
/// Memory of the size of each message, used again for later ones.
inline constexpr auto kReused = eprosima::fastrtps::rtps::DYNAMIC_REUSABLE_MEMORY_MODE;

[[nodiscard]] inline bool participant_left(const DiscoveryInfo& info) {
  return info.status == DiscoveryInfo::REMOVED_PARTICIPANT || info.status == DiscoveryInfo::DROPPED_PARTICIPANT;
}

[[nodiscard]] inline GuidPrefix prefix_of(const DiscoveryInfo& info) { return info.info.m_guid.guidPrefix; }

/// Prefix of the participant that an endpoint belongs to; the handle is the endpoint's GUID.
[[nodiscard]] inline GuidPrefix prefix_of(const InstanceHandle& endpoint) {
  return eprosima::fastrtps::rtps::iHandle2GUID(endpoint).guidPrefix;
}

/// Participants in one process communicate over the network like those in several processes, so
/// results do not depend on shared processes. Call before the first participant.
inline void turn_off_intraprocess_delivery() {
  eprosima::fastrtps::LibrarySettingsAttributes settings;
  settings.intraprocess_delivery = eprosima::fastrtps::INTRAPROCESS_OFF;
  eprosima::fastrtps::xmlparser::XMLProfileManager::library_settings(settings);
}

/// A generated type made safe against what the network sends and against its own scratch memory.
///
/// Generated deserialize() lets exceptions other than "too short" through, which would end the
/// process from a thread of Fast DDS; generated getKey() computes in a buffer that a writing and
/// a receiving thread share.
template <class Generated>
class CheckedType final : public Generated {
 public:
  /// @param malformed      counts payloads that are not of this type; outlives the type.
  /// @param is_described   its description is published for other programs, see describe_live_type().
  explicit CheckedType(std::atomic<std::uint64_t>& malformed, bool is_described = false) : malformed_{malformed} {
    // Not the whole description with every discovery: whoever wants it asks.
    this->auto_fill_type_object(false);
    this->auto_fill_type_information(is_described);
  }

  bool deserialize(Payload* payload, void* sample) override {
    try {
      if (Generated::deserialize(payload, sample)) return true;
    } catch (...) {
    }
    malformed_.fetch_add(1, std::memory_order_relaxed);
    return false;
  }

  bool getKey(void* sample, InstanceHandle* handle, bool force_md5) override {
    const std::lock_guard lock{key_mutex_};
    return Generated::getKey(sample, handle, force_md5);
  }

 private:
  std::atomic<std::uint64_t>& malformed_;
  std::mutex key_mutex_;
};

}  // namespace hybridtest::fast_dds
