#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>

#include "core/time.hpp"
#include "recording/recorder.hpp"

namespace hybridtest {

/// Drains a recorder on a thread of its own, at ordinary priority.
///
/// Rows reach the file at most one period, plus the time that writing takes, after they were
/// appended. Nothing thrown leaves the thread; see Recorder::failed().
class RecorderThread {
 public:
  /// Half of the allowed delay of the file; writing may take the other half.
  static constexpr Duration kDefaultPeriod{50'000'000};

  /// @param recorder   must outlive the thread; nothing else may drain it in the meantime.
  explicit RecorderThread(Recorder& recorder, Duration period = kDefaultPeriod);
  /// Stops.
  ~RecorderThread();
  RecorderThread(const RecorderThread&) = delete;
  RecorderThread& operator=(const RecorderThread&) = delete;

  /// Ends the thread, then drains and closes the recorder. Producers must have stopped.
  void stop() noexcept;

 private:
  void run() noexcept;

  Recorder& recorder_;
  Duration period_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace hybridtest
