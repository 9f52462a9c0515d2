#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace hybridtest {

/// A participant started on this machine. Its output goes to a log file. Ctrl-C at the terminal does
/// not reach it. When its parent dies, it receives SIGTERM and stops safely.
class ChildProcess {
 public:
  /// @throws std::runtime_error when it cannot be started.
  ChildProcess(std::string id, const std::filesystem::path& program, const std::vector<std::string>& arguments,
               const std::filesystem::path& log_file);

  [[nodiscard]] const std::string& id() const noexcept { return id_; }
  [[nodiscard]] const std::filesystem::path& log_file() const noexcept { return log_file_; }
  /// Whether it still runs; stores its exit code when it has ended.
  [[nodiscard]] bool is_running() noexcept;
  /// Exit code, 128 + signal when a signal ended it; nothing while it runs.
  [[nodiscard]] std::optional<int> exit_code() const noexcept { return exit_code_; }
  /// The signal that ended it, 0 while it runs and when it exited by itself.
  [[nodiscard]] int signal() const noexcept { return signal_; }
  /// The last line of its log, without time and severity; empty when there is none.
  [[nodiscard]] std::string last_words() const;
  void send_signal(int signal) noexcept;

 private:
  std::string id_;
  std::filesystem::path log_file_;
  int process_ = -1;
  std::optional<int> exit_code_;
  int signal_ = 0;
};

}  // namespace hybridtest
