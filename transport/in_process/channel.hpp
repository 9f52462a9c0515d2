#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "transport/bounded_queue.hpp"
#include "transport/transport.hpp"

namespace hybridtest::in_process {

/// The state that the ports of a participant share.
struct ParticipantState {
  std::string test_name;
  Waker waker;
  std::atomic<bool> alive{true};
  std::atomic<std::uint64_t> overflowed{0};
  std::atomic<std::uint64_t> unsent{0};
};

/// One inbox of a channel.
template <class Message>
struct Subscription {
  std::shared_ptr<ParticipantState> participant;
  std::optional<SubstructureIndex> only;  // messages for this substructure alone
  BoundedQueue<Message> queue{kInboxCapacity<Message>};

  bool deliver(const Message& message) noexcept {
    const bool accepted = queue.push(message);
    if (!accepted) participant->overflowed.fetch_add(1, std::memory_order_relaxed);
    participant->waker.signal();
    return accepted;
  }

  void deliver_displacing(const Message& message) noexcept {
    queue.push_displacing(message);
    participant->waker.signal();
  }
};

/// All traffic of one message type on the hub.
template <class Message>
class Channel {
 public:
  using SubscriptionPtr = std::shared_ptr<Subscription<Message>>;

  /// @param keep_newest   the newest message of each sender waits for late joiners.
  explicit Channel(bool keep_newest) : keep_newest_{keep_newest} {}

  void subscribe(const SubscriptionPtr& subscription) {
    const std::lock_guard lock{mutex_};
    for (const Kept& kept : kept_) {
      if (reaches(*kept.sender, *subscription)) subscription->deliver(kept.message);
    }
    subscriptions_.push_back(subscription);
    for (const auto& sender : senders_) {
      if (reaches(*sender, *subscription)) sender->waker.signal();  // a receiver exists now
    }
  }

  void unsubscribe(const Subscription<Message>* subscription) noexcept {
    const std::lock_guard lock{mutex_};
    std::erase_if(subscriptions_, [&](const SubscriptionPtr& other) { return other.get() == subscription; });
  }

  void add_sender(const std::shared_ptr<ParticipantState>& sender) {
    const std::lock_guard lock{mutex_};
    senders_.push_back(sender);
    for (const SubscriptionPtr& subscription : subscriptions_) {
      if (reaches(*sender, *subscription)) subscription->participant->waker.signal();
    }
  }

  void remove_sender(const ParticipantState& sender) noexcept {
    const std::lock_guard lock{mutex_};
    const auto found =
        std::find_if(senders_.begin(), senders_.end(), [&](const auto& other) { return other.get() == &sender; });
    if (found != senders_.end()) senders_.erase(found);
  }

  [[nodiscard]] bool has_sender(const ParticipantState& participant) const noexcept {
    const std::lock_guard lock{mutex_};
    return std::any_of(senders_.begin(), senders_.end(), [&](const auto& s) { return s.get() == &participant; });
  }

  [[nodiscard]] bool has_receiver(const ParticipantState& participant) const noexcept {
    const std::lock_guard lock{mutex_};
    return std::any_of(subscriptions_.begin(), subscriptions_.end(),
                       [&](const SubscriptionPtr& s) { return s->participant.get() == &participant; });
  }

  /// @return false when the inbox of any receiver was full.
  bool send(const std::shared_ptr<ParticipantState>& sender, const Message& message) noexcept {
    const std::lock_guard lock{mutex_};
    if (!sender->alive) return false;  // checked under the lock: nothing is sent after leave()
    if (keep_newest_) keep(sender, message);
    bool accepted = true;
    for (const SubscriptionPtr& subscription : subscriptions_) {
      if (reaches(*sender, *subscription) && wants(*subscription, message)) {
        accepted = subscription->deliver(message) && accepted;
      }
    }
    return accepted;
  }

  /// Forgets a participant. @return its newest message, where those are kept.
  std::optional<Message> leave(const ParticipantState& participant) noexcept {
    const std::lock_guard lock{mutex_};
    std::optional<Message> newest;
    for (const Kept& kept : kept_) {
      if (kept.sender.get() == &participant) newest = kept.message;
    }
    std::erase_if(kept_, [&](const Kept& kept) { return kept.sender.get() == &participant; });
    std::erase_if(subscriptions_, [&](const SubscriptionPtr& s) { return s->participant.get() == &participant; });
    std::erase_if(senders_, [&](const auto& sender) { return sender.get() == &participant; });
    return newest;
  }

  template <class Visitor>
  void for_each_reached_by(const ParticipantState& sender, Visitor visit) const noexcept {
    const std::lock_guard lock{mutex_};
    for (const SubscriptionPtr& subscription : subscriptions_) {
      if (reaches(sender, *subscription)) visit(subscription);
    }
  }

  /// Those who send to the inboxes of this receiver that take messages of this substructure only.
  template <class Visitor>
  void for_each_reaching(const ParticipantState& receiver, SubstructureIndex only, Visitor visit) const noexcept {
    const std::lock_guard lock{mutex_};
    for (const SubscriptionPtr& subscription : subscriptions_) {
      if (subscription->participant.get() != &receiver || subscription->only != only) continue;
      for (const auto& sender : senders_) {
        if (reaches(*sender, *subscription)) visit(*sender);
      }
    }
  }

 private:
  struct Kept {
    std::shared_ptr<ParticipantState> sender;
    Message message;
  };

  static bool reaches(const ParticipantState& sender, const Subscription<Message>& subscription) noexcept {
    return subscription.participant.get() != &sender && subscription.participant->test_name == sender.test_name;
  }

  static bool wants(const Subscription<Message>& subscription, const Message& message) noexcept {
    if constexpr (requires { message.substructure; }) {
      return !subscription.only || *subscription.only == message.substructure;
    } else {
      return true;
    }
  }

  void keep(const std::shared_ptr<ParticipantState>& sender, const Message& message) noexcept {
    const auto same = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& k) { return k.sender == sender; });
    if (same == kept_.end()) {
      kept_.push_back({sender, message});
    } else {
      same->message = message;
    }
  }

  const bool keep_newest_;
  mutable std::mutex mutex_;
  std::vector<std::shared_ptr<ParticipantState>> senders_;  // one entry per open outbox
  std::vector<SubscriptionPtr> subscriptions_;
  std::vector<Kept> kept_;
};

}  // namespace hybridtest::in_process
