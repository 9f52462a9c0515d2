#pragma once

#include <atomic>
#include <functional>
#include <future>
#include <thread>

#include "core/node.hpp"
#include "core/real_time_thread.hpp"
#include "runtime/executor.hpp"
#include "transport/waker.hpp"

namespace hybridtest {

/// Runs a node with deadlines on a thread of its own, so that the thread that made it does what may allocate, lock and
/// write.
class NodeThread {
 public:
  /// Starts the thread and asks for its scheduling; the node runs from run() on.
  explicit NodeThread(const RealTimeRequest& request);
  /// Ends the thread; run() must have been called and the node be done, or run() not been called.
  ~NodeThread();
  NodeThread(const NodeThread&) = delete;
  NodeThread& operator=(const NodeThread&) = delete;

  [[nodiscard]] const RealTimeGrant& grant() const noexcept { return grant_; }

  /// See run_until(). All of it must outlive this; is_done and between are called by the thread.
  void run(Node& node, Waker& waker, const ProcessClock& clock, std::function<bool()> is_done,
           std::function<void(Instant)> between);
  [[nodiscard]] bool is_over() const noexcept { return is_over_.load(); }

 private:
  RealTimeGrant grant_;
  std::promise<std::function<void()>> work_;
  bool has_work_ = false;
  std::atomic<bool> is_over_{false};
  std::thread thread_;
};

}  // namespace hybridtest
