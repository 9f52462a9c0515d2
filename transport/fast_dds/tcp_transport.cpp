#include "transport/fast_dds/tcp_transport.hpp"

#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <utility>

#include "transport/fast_dds/connection_watch.hpp"
#include "transport/fast_dds/receiving_transport.hpp"

namespace hybridtest::fast_dds {
namespace {

/// Closing waits for no more messages than these to stop: others may send on and on.
constexpr int kLateMessages = 50;

struct TcpDescriptor final : rtps::ChainingTransportDescriptor {
  TcpDescriptor(std::shared_ptr<rtps::TransportDescriptorInterface> lower, const std::optional<Locator>& its_own,
                Admission its_admission, std::shared_ptr<RefusedPackets> its_refused, Duration time_of_quiet)
      : ChainingTransportDescriptor{std::move(lower)},
        own{its_own},
        admission{its_admission},
        refused{std::move(its_refused)},
        quiet{time_of_quiet} {}

  [[nodiscard]] rtps::TransportInterface* create_transport() const override;  // the caller owns it

  std::optional<Locator> own;
  Admission admission;
  std::shared_ptr<RefusedPackets> refused;
  Duration quiet;
};

/// Stands before the receiver of a logical port. Several threads enter, one for each connection.
class Gate final : public rtps::TransportReceiverInterface {
 public:
  Gate(rtps::TransportReceiverInterface* receiver, Admission admission, std::shared_ptr<RefusedPackets> refused)
      : receiver_{receiver}, filter_{admission, std::move(refused)} {}

  void OnDataReceived(const unsigned char* bytes, std::uint32_t count, const Locator& local,
                      const Locator& from) override {
    const std::lock_guard lock{mutex_};
    if (receiver_ != nullptr && filter_.admits_discovery({bytes, count}, std::chrono::steady_clock::now())) {
      receiver_->OnDataReceived(bytes, count, local, from);
    }
    ++messages_;
    left_.notify_all();
  }

  /// Waits for who is inside.
  void close() {
    const std::lock_guard lock{mutex_};
    receiver_ = nullptr;
  }

  [[nodiscard]] bool is_open() const {
    const std::lock_guard lock{mutex_};
    return receiver_ != nullptr;
  }
  /// Waits until nobody has come for this time.
  void wait_for_quiet(Duration quiet) {
    std::unique_lock lock{mutex_};
    for (int late = 0; late < kLateMessages; ++late) {
      const std::uint64_t so_far = messages_;
      if (!left_.wait_for(lock, quiet, [&] { return messages_ != so_far; })) return;
    }
  }

 private:
  mutable std::mutex mutex_;
  rtps::TransportReceiverInterface* receiver_;
  PacketFilter filter_;
  std::condition_variable left_;
  std::uint64_t messages_ = 0;
};

class TcpTransport final : public ReceivingTransport {
 public:
  explicit TcpTransport(const TcpDescriptor& descriptor) : ReceivingTransport{descriptor}, descriptor_{descriptor} {}
  TcpTransport(const TcpTransport&) = delete;
  TcpTransport& operator=(const TcpTransport&) = delete;

  ~TcpTransport() override {
    for (const auto& [port, gate] : gates_) {
      // A thread that has left its gate still has a few instructions to do inside the lower transport.
      gate->wait_for_quiet(descriptor_.quiet);
      Locator locator;
      locator.kind = kind();
      IpLocator::setLogicalPort(locator, port);
      low_level_transport_->CloseInputChannel(locator);
    }
    // It ends the threads that hold gates.
    low_level_transport_.reset();
  }

  rtps::TransportDescriptorInterface* get_configuration() override { return &descriptor_; }

  /// The lower one begins with its first port, or with the first connection where there is none. It does not use the
  /// properties.
  bool init(const eprosima::fastrtps::rtps::PropertyPolicy*) override { return true; }

  bool IsInputChannelOpen(const Locator& locator) const override {
    const auto found = gates_.find(IpLocator::getLogicalPort(locator));
    return found != gates_.end() && found->second->is_open();
  }

  bool OpenInputChannel(const Locator& locator, rtps::TransportReceiverInterface* receiver,
                        std::uint32_t bytes_max) override {
    const std::uint16_t port = IpLocator::getLogicalPort(locator);
    if (gates_.contains(port)) return false;
    auto gate = std::make_unique<Gate>(receiver, descriptor_.admission, descriptor_.refused);
    if (!low_level_transport_->OpenInputChannel(locator, gate.get(), bytes_max)) return false;
    gates_.emplace(port, std::move(gate));
    return begin();
  }

  bool CloseInputChannel(const Locator& locator) override {
    const auto found = gates_.find(IpLocator::getLogicalPort(locator));
    if (found == gates_.end()) return false;
    found->second->close();
    return true;
  }

  bool OpenOutputChannel(rtps::SendResourceList& resources, const Locator& locator) override {
    if (is_own(locator) || !begin()) return false;
    watch_.expect(locator);
    return ReceivingTransport::OpenOutputChannel(resources, locator);
  }

 private:
  bool begin() {
    if (!is_begun_) is_begun_ = low_level_transport_->init(nullptr);
    return is_begun_;
  }

  /// Under the address that others use, or under another one of this host.
  [[nodiscard]] bool is_own(const Locator& locator) const {
    if (!descriptor_.own || IpLocator::getPhysicalPort(locator) != IpLocator::getPhysicalPort(*descriptor_.own)) {
      return false;
    }
    return IpLocator::compareAddress(locator, *descriptor_.own) || low_level_transport_->is_local_locator(locator);
  }

  /// Never called: the lower transport has the gates as its receivers.
  void receive(rtps::TransportReceiverInterface*, const eprosima::fastrtps::rtps::octet*, std::uint32_t, const Locator&,
               const Locator&) override {}

  TcpDescriptor descriptor_;
  ConnectionWatch watch_;
  std::map<std::uint16_t, std::unique_ptr<Gate>> gates_;  // by logical port
  bool is_begun_ = false;
};

rtps::TransportInterface* TcpDescriptor::create_transport() const { return new TcpTransport{*this}; }

}  // namespace

std::shared_ptr<rtps::TransportDescriptorInterface> tcp_transport(
    std::shared_ptr<rtps::TransportDescriptorInterface> lower, const std::optional<Locator>& own, Admission admission,
    std::shared_ptr<RefusedPackets> refused, Duration quiet) {
  return std::make_shared<TcpDescriptor>(std::move(lower), own, admission, std::move(refused), quiet);
}

}  // namespace hybridtest::fast_dds
