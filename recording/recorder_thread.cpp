#include "recording/recorder_thread.hpp"

namespace hybridtest {

RecorderThread::RecorderThread(Recorder& recorder, Duration period)
    : recorder_{recorder}, period_{period}, thread_{[this] { run(); }} {}

RecorderThread::~RecorderThread() { stop(); }

void RecorderThread::stop() noexcept {
  {
    const std::lock_guard lock{mutex_};
    stopping_ = true;
  }
  wake_.notify_one();
  if (thread_.joinable()) thread_.join();
  recorder_.close();
}

void RecorderThread::run() noexcept {
  std::unique_lock lock{mutex_};
  while (!stopping_) {
    lock.unlock();
    recorder_.drain();
    lock.lock();
    wake_.wait_for(lock, period_, [this] { return stopping_; });
  }
}

}  // namespace hybridtest
