#include "launch/child_process.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <utility>

namespace hybridtest {

ChildProcess::ChildProcess(std::string id, const std::filesystem::path& program,
                           const std::vector<std::string>& arguments, const std::filesystem::path& log_file)
    : id_{std::move(id)}, log_file_{log_file} {
  const int log = open(log_file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (log < 0) throw std::runtime_error{log_file.string() + ": " + std::strerror(errno)};
  std::string program_text = program.string();
  std::vector<std::string> texts = arguments;
  std::vector<char*> argv{program_text.data()};
  for (std::string& text : texts) argv.push_back(text.data());
  argv.push_back(nullptr);

  const pid_t parent = getpid();
  process_ = fork();
  if (process_ < 0) {
    close(log);
    throw std::runtime_error{"cannot start " + program_text + ": " + std::strerror(errno)};
  }
  if (process_ == 0) {
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != parent) _exit(127);
    dup2(log, STDOUT_FILENO);
    dup2(log, STDERR_FILENO);
    execv(program_text.c_str(), argv.data());
    static_cast<void>(!write(STDERR_FILENO, "cannot execute the program\n", 27));
    _exit(127);
  }
  close(log);
}

bool ChildProcess::is_running() noexcept {
  if (exit_code_) return false;
  int status = 0;
  if (waitpid(process_, &status, WNOHANG) != process_) return true;
  if (WIFSIGNALED(status)) signal_ = WTERMSIG(status);
  exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + signal_;
  return false;
}

std::string ChildProcess::last_words() const {
  std::ifstream log{log_file_};
  std::string last;
  for (std::string line; std::getline(log, line);) {
    if (line.find_first_not_of(" \t\r") != std::string::npos) last = line;
  }
  // An event is written as `2026-01-31T12:00:00.000Z error id: text`.
  for (const std::string level : {"Z error ", "Z warning ", "Z info "}) {
    const auto time_end = last.find(level);
    if (time_end != std::string::npos) return last.substr(time_end + level.size());
  }
  return last;
}

void ChildProcess::send_signal(int signal) noexcept {
  if (is_running()) kill(process_, signal);
}

}  // namespace hybridtest
