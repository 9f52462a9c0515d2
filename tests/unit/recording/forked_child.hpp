#pragma once

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>

namespace hybridtest {

/// A forked child; the test communicates with it through a pair of pipes, so that no one waits for a fixed time.
class ForkedChild {
 public:
  template <class Body>
  explicit ForkedChild(Body&& body) {
    if (::pipe(to_child_) != 0 || ::pipe(from_child_) != 0) std::abort();
    id_ = ::fork();
    if (id_ == 0) {
      body(*this);
      ::_exit(0);
    }
    ::close(from_child_[1]);
  }
  ~ForkedChild() {
    if (id_ > 0) kill_now();
    ::close(to_child_[0]);
    ::close(to_child_[1]);
    ::close(from_child_[0]);
  }
  ForkedChild(const ForkedChild&) = delete;
  ForkedChild& operator=(const ForkedChild&) = delete;

  // In the child.
  void report(std::uint64_t number) const { (void)!::write(from_child_[1], &number, sizeof number); }
  void await_word() const {
    char word = 0;
    (void)!::read(to_child_[0], &word, 1);
  }
  // In the parent.
  void say_word() const { (void)!::write(to_child_[1], "x", 1); }
  /// The next number the child reported; 0 when it ended.
  [[nodiscard]] std::uint64_t hear() const {
    std::uint64_t number = 0;
    return ::read(from_child_[0], &number, sizeof number) == sizeof number ? number : 0;
  }
  void kill_now() {
    ::kill(id_, SIGKILL);
    (void)wait();
  }
  [[nodiscard]] int wait() {
    int status = 0;
    ::waitpid(id_, &status, 0);
    id_ = 0;
    return status;
  }

 private:
  pid_t id_ = 0;
  int to_child_[2]{};
  int from_child_[2]{};
};

}  // namespace hybridtest
