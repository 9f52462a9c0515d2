#include "runtime/deferring_transport.hpp"

#include <utility>

#include "core/ring_port.hpp"

namespace hybridtest {
namespace {

/// Messages of one kind while the other thread sleeps; a node sends a few in such a time at most.
constexpr std::size_t kWaitingMost = 256;

}  // namespace

class DeferringTransport::Line {
 public:
  virtual ~Line() = default;
  virtual void send_waiting() noexcept = 0;
};

template <class Message>
class DeferringTransport::LineOf final : public Line {
 public:
  explicit LineOf(std::unique_ptr<Outbox<Message>> target) : target_{std::move(target)} {}

  [[nodiscard]] bool push(const Message& message) noexcept { return waiting_.send(message); }
  void send_waiting() noexcept override {
    while (waiting_.take(message_)) target_->send(message_);
  }

 private:
  std::unique_ptr<Outbox<Message>> target_;
  RingPort<Message> waiting_{kWaitingMost};
  Message message_;
};

template <class Message>
class DeferringTransport::DeferredOutbox final : public Outbox<Message> {
 public:
  explicit DeferredOutbox(std::shared_ptr<LineOf<Message>> line) noexcept : line_{std::move(line)} {}
  bool send(const Message& message) noexcept override { return line_->push(message); }

 private:
  std::shared_ptr<LineOf<Message>> line_;
};

DeferringTransport::~DeferringTransport() = default;

template <class Message>
std::unique_ptr<Outbox<Message>> DeferringTransport::defer(std::unique_ptr<Outbox<Message>> target) {
  auto line = std::make_shared<LineOf<Message>>(std::move(target));
  lines_.push_back(line);
  return std::make_unique<DeferredOutbox<Message>>(std::move(line));
}

void DeferringTransport::send_waiting() noexcept {
  for (const auto& line : lines_) line->send_waiting();
}

std::unique_ptr<Outbox<TestAnnouncement>> DeferringTransport::announcement_outbox() {
  return defer(network_.announcement_outbox());
}
std::unique_ptr<Outbox<ParticipantStatus>> DeferringTransport::status_outbox() {
  return defer(network_.status_outbox());
}
std::unique_ptr<Outbox<TestControl>> DeferringTransport::control_outbox() { return defer(network_.control_outbox()); }
std::unique_ptr<Outbox<Event>> DeferringTransport::event_outbox() { return defer(network_.event_outbox()); }

}  // namespace hybridtest
