#include "runtime/node_thread.hpp"

#include <utility>

namespace hybridtest {

NodeThread::NodeThread(const RealTimeRequest& request) {
  std::promise<RealTimeGrant> granted;
  std::future<RealTimeGrant> grant = granted.get_future();
  thread_ = std::thread{[this, request, granted = std::move(granted), work = work_.get_future()]() mutable {
    granted.set_value(enter_real_time(request));
    if (const std::function<void()> run = work.get()) run();
    is_over_ = true;
  }};
  grant_ = grant.get();
}

NodeThread::~NodeThread() {
  if (!has_work_) work_.set_value({});
  thread_.join();
}

void NodeThread::run(Node& node, Waker& waker, const ProcessClock& clock, std::function<bool()> is_done,
                     std::function<void(Instant)> between) {
  has_work_ = true;
  work_.set_value([&node, &waker, &clock, is_done = std::move(is_done), between = std::move(between)] {
    run_until(node, waker, clock, is_done, between);
  });
}

}  // namespace hybridtest
