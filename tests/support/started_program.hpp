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

/// Generous: what is waited for comes in a fraction of it, even on a machine that is busy with other things.
inline constexpr std::chrono::seconds kPatience{60};

/// Asks again and again until `condition` holds. @return whether it did in time.
[[nodiscard]] bool wait_until(const std::function<bool()>& condition, std::chrono::milliseconds patience = kPatience);

struct ProgramOptions {
  std::filesystem::path working_directory{};
  /// No file may grow beyond it; writing further fails, as on a full disk. Children inherit it.
  std::optional<std::uint64_t> file_bytes_max{};
};

/// A program of the build in a process of its own; what it prints is kept in files.
///
/// Whoever is still there when this object goes, the program or a descendant, is killed.
class StartedProgram {
 public:
  /// @param output   stem of the files `<output>.out` and `<output>.err`.
  /// @throws std::runtime_error when there is no process to be had.
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

/// Whether the process is there and is no zombie.
[[nodiscard]] bool is_alive(pid_t process);

[[nodiscard]] std::string text_of(const std::filesystem::path& file);

}  // namespace hybridtest
