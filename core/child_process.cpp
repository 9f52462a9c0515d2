#include "core/child_process.hpp"

#include <fcntl.h>
#include <sys/poll.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace hybridtest {
namespace {

constexpr int kNoProgram = 127;  // exit code of a shell that finds no program
constexpr std::int64_t kLongestWait_ms = 1'000'000'000;

/// Of a process that was just forked: only calls that are safe in a signal handler.
[[noreturn]] void become(const ChildStart& start, int log, pid_t parent, char* const* arguments) noexcept {
  setpgid(0, 0);
  if (!start.outlives_parent) {
    prctl(PR_SET_PDEATHSIG, start.is_killed_with_parent ? SIGKILL : SIGTERM);
    if (getppid() != parent) _exit(kNoProgram);
  }
  const int nothing = open("/dev/null", O_RDONLY | O_CLOEXEC);
  if (nothing >= 0) dup2(nothing, STDIN_FILENO);
  dup2(log, STDOUT_FILENO);
  dup2(log, STDERR_FILENO);
  for (const int descriptor : start.kept_descriptors) fcntl(descriptor, F_SETFD, 0);
  if (start.directory.empty() || chdir(start.directory.c_str()) == 0) {
    execv(arguments[0], arguments);
    static_cast<void>(!write(STDERR_FILENO, "cannot execute the program\n", 27));
  } else {
    static_cast<void>(!write(STDERR_FILENO, "cannot enter the working directory\n", 35));
  }
  _exit(kNoProgram);
}

}  // namespace

ChildProcess::ChildProcess(std::string id, const ChildStart& start) : id_{std::move(id)}, log_file_{start.log_file} {
  const int log = open(log_file_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (log < 0) throw std::runtime_error{log_file_.string() + ": " + std::strerror(errno)};
  std::string program = start.program.string();
  std::vector<std::string> texts = start.arguments;
  std::vector<char*> arguments{program.data()};
  for (std::string& text : texts) arguments.push_back(text.data());
  arguments.push_back(nullptr);

  const pid_t parent = getpid();
  process_ = fork();
  if (process_ == 0) become(start, log, parent, arguments.data());
  const int error = errno;
  close(log);
  if (process_ < 0) throw std::runtime_error{"cannot start " + program + ": " + std::strerror(error)};
}

bool ChildProcess::is_running() noexcept {
  if (exit_code_) return false;
  int status = 0;
  if (waitpid(process_, &status, WNOHANG) != process_) return true;
  if (WIFSIGNALED(status)) signal_ = WTERMSIG(status);
  exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + signal_;
  return false;
}

bool ChildProcess::wait_for_end(Duration limit) noexcept {
  if (!is_running()) return true;
  pollfd end{.fd = static_cast<int>(syscall(SYS_pidfd_open, process_, 0)), .events = POLLIN, .revents = 0};
  const auto limit_ms = std::chrono::duration_cast<std::chrono::milliseconds>(limit).count();
  static_cast<void>(poll(&end, 1, static_cast<int>(std::clamp<std::int64_t>(limit_ms, 0, kLongestWait_ms))));
  close(end.fd);
  return !is_running();
}

std::vector<std::string> ChildProcess::last_lines(std::size_t count) const {
  std::ifstream log{log_file_};
  std::vector<std::string> last;
  for (std::string line; std::getline(log, line);) {
    // Some programs, ssh among them, end their lines as a terminal wants it.
    line.erase(line.find_last_not_of(" \t\r") + 1);
    if (line.empty()) continue;
    last.push_back(line);
    if (last.size() > count) last.erase(last.begin());
  }
  return last;
}

std::string ChildProcess::last_words() const {
  const std::vector<std::string> lines = last_lines(1);
  if (lines.empty()) return "";
  // An event is written as `2026-01-31T12:00:00.000Z error id: text`.
  for (const std::string level : {"Z error ", "Z warning ", "Z info "}) {
    const auto time_end = lines.front().find(level);
    if (time_end != std::string::npos) return lines.front().substr(time_end + level.size());
  }
  return lines.front();
}

void ChildProcess::send_signal(int signal) noexcept {
  if (is_running()) ::kill(process_, signal);
}

void ChildProcess::kill() noexcept {
  send_signal(SIGKILL);
  while (!wait_for_end(from_seconds(1.0))) {
  }
}

std::optional<std::filesystem::path> find_program(const std::string& name) {
  const auto is_program = [](const std::filesystem::path& file) {
    std::error_code error;
    return std::filesystem::is_regular_file(file, error) && access(file.c_str(), X_OK) == 0;
  };
  if (name.find('/') != std::string::npos) {
    if (is_program(name)) return name;
    return std::nullopt;
  }
  const char* path = std::getenv("PATH");
  std::istringstream folders{path == nullptr ? "" : path};
  for (std::string folder; std::getline(folders, folder, ':');) {
    const std::filesystem::path file = std::filesystem::path{folder.empty() ? "." : folder} / name;
    if (is_program(file)) return file;
  }
  return std::nullopt;
}

}  // namespace hybridtest
