#pragma once

#include <chrono>
#include <cstdint>

#include "transport/fast_dds/dds_version.hpp"

namespace hybridtest::fast_dds {

/// Stands between Fast DDS and one of its transports, for what arrives. What is sent goes past it: the senders are
/// those of the lower transport.
class ReceivingTransport : public rtps::ChainingTransport {
 public:
  using ChainingTransport::ChainingTransport;

  bool OpenOutputChannel(rtps::SendResourceList& resources, const Locator& locator) override {
    return low_level_transport_->OpenOutputChannel(resources, locator);
  }

  void shutdown() override { low_level_transport_->shutdown(); }

 private:
  /// Never called, because of the senders.
  bool send(eprosima::fastrtps::rtps::SenderResource*, const eprosima::fastrtps::rtps::octet*, std::uint32_t,
            eprosima::fastrtps::rtps::LocatorsIterator*, eprosima::fastrtps::rtps::LocatorsIterator*,
            const std::chrono::steady_clock::time_point&) final {
    return false;
  }
};

}  // namespace hybridtest::fast_dds
