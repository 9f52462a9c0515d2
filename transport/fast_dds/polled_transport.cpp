#include "transport/fast_dds/polled_transport.hpp"

#include <cstdint>
#include <utility>

#include "transport/fast_dds/filtered_transport.hpp"
#include "transport/fast_dds/receiving_transport.hpp"

namespace hybridtest::fast_dds {
namespace {

struct PolledDescriptor final : rtps::ChainingTransportDescriptor {
  PolledDescriptor(std::shared_ptr<rtps::UDPv4TransportDescriptor> udp, std::shared_ptr<PolledSocket> its_socket,
                   std::uint32_t its_domain, bool is_loopback_only, Admission its_admission,
                   std::shared_ptr<RefusedPackets> its_refused)
      : ChainingTransportDescriptor{filtered_transport(
            std::move(udp), its_admission, its_refused,
            // A participant that leaves sends its last messages before it says so. Fast DDS drops what it reads later.
            [its_socket] { its_socket->receive(); })},
        socket{std::move(its_socket)},
        domain{its_domain},
        loopback_only{is_loopback_only},
        admission{its_admission},
        refused{std::move(its_refused)} {}

  [[nodiscard]] rtps::TransportInterface* create_transport() const override;  // the caller owns it

  std::shared_ptr<PolledSocket> socket;
  std::uint32_t domain;
  bool loopback_only;
  Admission admission;
  std::shared_ptr<RefusedPackets> refused;
};

class PolledTransport final : public ReceivingTransport {
 public:
  explicit PolledTransport(const PolledDescriptor& descriptor)
      : ReceivingTransport{descriptor}, descriptor_{descriptor}, filter_{descriptor.admission, descriptor.refused} {}

  rtps::TransportDescriptorInterface* get_configuration() override { return &descriptor_; }

  bool IsInputChannelOpen(const Locator& locator) const override {
    if (!is_for_messages(locator)) return low_level_transport_->IsInputChannelOpen(locator);
    return descriptor_.socket->is_open_at(IpLocator::getPhysicalPort(locator));
  }

  bool OpenInputChannel(const Locator& locator, rtps::TransportReceiverInterface* receiver,
                        std::uint32_t bytes_max) override {
    if (!is_for_messages(locator)) return low_level_transport_->OpenInputChannel(locator, receiver, bytes_max);
    const auto pass_on = [this, receiver, locator, from = sender_locator()](const std::uint8_t* bytes,
                                                                            std::uint32_t count, std::uint32_t address,
                                                                            std::uint16_t port) mutable {
      if (!filter_.admits_message({bytes, count})) return;
      IpLocator::setIPv4(from, static_cast<eprosima::fastrtps::rtps::octet>(address >> 24U),
                         static_cast<eprosima::fastrtps::rtps::octet>(address >> 16U),
                         static_cast<eprosima::fastrtps::rtps::octet>(address >> 8U),
                         static_cast<eprosima::fastrtps::rtps::octet>(address));
      IpLocator::setPhysicalPort(from, port);
      receiver->OnDataReceived(bytes, count, locator, from);
    };
    return descriptor_.socket->open(IpLocator::getPhysicalPort(locator), descriptor_.loopback_only, bytes_max, pass_on);
  }

  bool CloseInputChannel(const Locator& locator) override {
    if (!is_for_messages(locator)) return low_level_transport_->CloseInputChannel(locator);
    descriptor_.socket->close();
    return true;
  }

 private:
  static Locator sender_locator() {
    Locator locator;
    locator.kind = LOCATOR_KIND_UDPv4;
    return locator;
  }

  /// The ports of messages and of discovery alternate (RTPS 9.6.1); the participant tries every second one.
  [[nodiscard]] bool is_for_messages(const Locator& locator) const {
    if (locator.kind != LOCATOR_KIND_UDPv4 || IpLocator::isMulticast(locator)) return false;
    const PortParameters ports;
    const std::uint32_t first = ports.portBase + ports.domainIDGain * descriptor_.domain + ports.offsetd3;
    const std::uint32_t port = IpLocator::getPhysicalPort(locator);
    return port >= first && (port - first) % ports.participantIDGain == 0;
  }

  /// Never called: the lower transport has the receivers of discovery.
  void receive(rtps::TransportReceiverInterface*, const eprosima::fastrtps::rtps::octet*, std::uint32_t, const Locator&,
               const Locator&) override {}

  PolledDescriptor descriptor_;
  PacketFilter filter_;  // of messages
};

rtps::TransportInterface* PolledDescriptor::create_transport() const { return new PolledTransport{*this}; }

}  // namespace

std::shared_ptr<rtps::TransportDescriptorInterface> polled_transport(
    std::shared_ptr<rtps::UDPv4TransportDescriptor> udp, std::shared_ptr<PolledSocket> socket, std::uint32_t domain,
    bool loopback_only, Admission admission, std::shared_ptr<RefusedPackets> refused) {
  return std::make_shared<PolledDescriptor>(std::move(udp), std::move(socket), domain, loopback_only, admission,
                                            std::move(refused));
}

}  // namespace hybridtest::fast_dds
