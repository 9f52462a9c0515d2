#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/time.hpp"

namespace hybridtest {

/// How a child process is started.
struct ChildStart {
  std::filesystem::path program;           // a path with a '/', see find_program()
  std::vector<std::string> arguments;      // without the name of the program
  std::filesystem::path log_file;          // its standard output and standard error
  std::filesystem::path directory = {};    // its working directory; empty: that of this process
  std::vector<int> kept_descriptors = {};  // close-on-exec descriptors that the child has under the same number
  bool is_killed_with_parent = false;      // SIGKILL when its parent dies; otherwise SIGTERM, so that it stops safely
  bool outlives_parent = false;            // no signal then; it must end by itself
};

/// A program started on this machine. Its output goes to a log file, its standard input is empty. Ctrl-C at the
/// terminal does not reach it. When the thread that started it ends, it receives the signal of ChildStart.
class ChildProcess {
 public:
  /// @throws std::runtime_error when it cannot be started.
  ChildProcess(std::string id, const ChildStart& start);

  [[nodiscard]] const std::string& id() const noexcept { return id_; }
  [[nodiscard]] const std::filesystem::path& log_file() const noexcept { return log_file_; }
  [[nodiscard]] pid_t process() const noexcept { return process_; }
  /// Whether it still runs; stores its exit code when it has ended.
  [[nodiscard]] bool is_running() noexcept;
  /// Waits until it has ended. @return whether it has, within the limit.
  [[nodiscard]] bool wait_for_end(Duration limit) noexcept;
  /// Exit code, 128 + signal when a signal ended it; nothing while it runs.
  [[nodiscard]] std::optional<int> exit_code() const noexcept { return exit_code_; }
  /// The signal that ended it, 0 while it runs and when it exited by itself.
  [[nodiscard]] int signal() const noexcept { return signal_; }
  /// The last lines of its log that are not empty, oldest first.
  [[nodiscard]] std::vector<std::string> last_lines(std::size_t count) const;
  /// The last line of its log, without time and severity; empty when there is none.
  [[nodiscard]] std::string last_words() const;
  void send_signal(int signal) noexcept;
  /// Ends it at once, also when it is stopped, and waits for its end.
  void kill() noexcept;

 private:
  std::string id_;
  std::filesystem::path log_file_;
  pid_t process_ = -1;
  std::optional<int> exit_code_;
  int signal_ = 0;
};

/// The program of this name: in the folders of PATH, or itself where the name has a '/'.
/// @return nothing where there is no such file, or it may not be executed.
[[nodiscard]] std::optional<std::filesystem::path> find_program(const std::string& name);

}  // namespace hybridtest
