#include "transport/fast_dds/filtered_transport.hpp"

#include <chrono>
#include <mutex>
#include <utility>

#include "transport/fast_dds/receiving_transport.hpp"

namespace hybridtest::fast_dds {
namespace {

struct FilteredDescriptor final : rtps::ChainingTransportDescriptor {
  FilteredDescriptor(std::shared_ptr<rtps::TransportDescriptorInterface> lower, Admission its_admission,
                     std::shared_ptr<RefusedPackets> its_refused, std::function<void()> what_is_first)
      : ChainingTransportDescriptor{std::move(lower)},
        admission{its_admission},
        refused{std::move(its_refused)},
        first{std::move(what_is_first)} {}

  [[nodiscard]] rtps::TransportInterface* create_transport() const override;  // the caller owns it

  Admission admission;
  std::shared_ptr<RefusedPackets> refused;
  std::function<void()> first;
};

class FilteredTransport final : public ReceivingTransport {
 public:
  explicit FilteredTransport(const FilteredDescriptor& descriptor)
      : ReceivingTransport{descriptor}, descriptor_{descriptor}, filter_{descriptor.admission, descriptor.refused} {}
  FilteredTransport(const FilteredTransport&) = delete;
  FilteredTransport& operator=(const FilteredTransport&) = delete;

  /// The threads of the lower transport end before what they use.
  ~FilteredTransport() override { low_level_transport_.reset(); }

  rtps::TransportDescriptorInterface* get_configuration() override { return &descriptor_; }

 private:
  void receive(rtps::TransportReceiverInterface* receiver, const eprosima::fastrtps::rtps::octet* bytes,
               std::uint32_t count, const Locator& local, const Locator& from) override {
    if (descriptor_.first) descriptor_.first();
    const std::lock_guard lock{mutex_};
    if (!filter_.admits_discovery({bytes, count}, std::chrono::steady_clock::now())) return;
    receiver->OnDataReceived(bytes, count, local, from);
  }

  FilteredDescriptor descriptor_;
  PacketFilter filter_;
  std::mutex mutex_;  // held while a packet is looked at and taken in
};

rtps::TransportInterface* FilteredDescriptor::create_transport() const { return new FilteredTransport{*this}; }

}  // namespace

std::shared_ptr<rtps::TransportDescriptorInterface> filtered_transport(
    std::shared_ptr<rtps::TransportDescriptorInterface> lower, Admission admission,
    std::shared_ptr<RefusedPackets> refused, std::function<void()> first) {
  return std::make_shared<FilteredDescriptor>(std::move(lower), admission, std::move(refused), std::move(first));
}

}  // namespace hybridtest::fast_dds
