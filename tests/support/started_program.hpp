#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace hybridtest {

/// Long: the awaited event comes in a fraction of it, also on a busy machine.
inline constexpr std::chrono::seconds kPatience{60};

/// Polls until `condition` holds. @return whether it did in time.
[[nodiscard]] bool wait_until(const std::function<bool()>& condition, std::chrono::milliseconds patience = kPatience);

struct ProgramOptions {
  std::filesystem::path working_directory{};
  /// Largest size of a file; further writing fails, as on a full disk. Children inherit it.
  std::optional<std::uint64_t> file_bytes_max{};
};

/// A program of the build in its own process; its output is kept in files.
///
/// The destructor kills the program and its descendants when they still run.
class StartedProgram {
 public:
  /// @param output   stem of the files `<output>.out` and `<output>.err`.
  /// @throws std::runtime_error when no process can be started.
  StartedProgram(const std::filesystem::path& program, std::vector<std::string> arguments,
                 const std::filesystem::path& output, const ProgramOptions& options = {});
  ~StartedProgram();
  StartedProgram(StartedProgram&& other) noexcept;
  StartedProgram(const StartedProgram&) = delete;
  StartedProgram& operator=(const StartedProgram&) = delete;

  [[nodiscard]] pid_t process() const noexcept { return process_; }
  [[nodiscard]] bool is_running();
  /// @return the exit code, 128 + signal when a signal ended it; nothing when it runs on.
  [[nodiscard]] std::optional<int> wait(std::chrono::milliseconds patience = kPatience);
  void signal(int number) const;

  [[nodiscard]] std::string standard_output() const;
  [[nodiscard]] std::string standard_error() const;

  /// The running child process with these words on its command line, in this order; 0 when there is none.
  [[nodiscard]] pid_t child(const std::vector<std::string>& words) const;
  [[nodiscard]] std::vector<pid_t> children() const;

 private:
  std::filesystem::path output_;
  pid_t process_ = -1;
  std::optional<int> exit_code_;
};

/// As kill(2), but 0 and -1 are no process: there kill(2) would stop or end the tests themselves.
/// @return whether the signal was sent.
bool send_signal(pid_t process, int number);

/// Whether the process is there and is no zombie.
[[nodiscard]] bool is_alive(pid_t process);

[[nodiscard]] std::string text_of(const std::filesystem::path& file);

}  // namespace hybridtest
