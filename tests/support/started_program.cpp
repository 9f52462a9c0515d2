#include "tests/support/started_program.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstring>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>
#include <utility>

namespace hybridtest {
namespace {

constexpr std::chrono::milliseconds kPoll{10};

struct ProcessState {
  char state = '?';
  pid_t parent = 0;
};

/// From `/proc/<process>/stat`; the name in brackets may hold anything.
std::optional<ProcessState> state_of(pid_t process) {
  std::string text = text_of("/proc/" + std::to_string(process) + "/stat");
  const std::size_t name_end = text.rfind(')');
  if (name_end == std::string::npos) return {};
  ProcessState state;
  std::istringstream fields{text.substr(name_end + 1)};
  fields >> state.state >> state.parent;
  return state;
}

std::vector<std::string> command_line(pid_t process) {
  std::istringstream text{text_of("/proc/" + std::to_string(process) + "/cmdline")};
  std::vector<std::string> words;
  for (std::string word; std::getline(text, word, '\0');) words.push_back(word);
  return words;
}

std::vector<pid_t> children_of(pid_t parent) {
  std::vector<pid_t> children;
  for (const auto& entry : std::filesystem::directory_iterator{"/proc"}) {
    const std::string name = entry.path().filename();
    pid_t process = 0;
    const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), process);
    if (error != std::errc{} || end != name.data() + name.size()) continue;
    const auto state = state_of(process);
    if (state && state->parent == parent && state->state != 'Z') children.push_back(process);
  }
  return children;
}

void kill_descendants(pid_t process) {
  for (const pid_t child : children_of(process)) {
    kill_descendants(child);
    ::kill(child, SIGKILL);
  }
}

/// In the new process; only what may be called between fork and exec.
[[noreturn]] void become(const char* program, char* const* arguments, int out, int err, const char* working_directory,
                         const rlimit* file_size) {
  if (working_directory != nullptr && ::chdir(working_directory) != 0) ::_exit(126);
  if (file_size != nullptr) {
    // Without this the signal would end the process in place of the failing write.
    ::signal(SIGXFSZ, SIG_IGN);
    if (::setrlimit(RLIMIT_FSIZE, file_size) != 0) ::_exit(126);
  }
  ::dup2(out, STDOUT_FILENO);
  ::dup2(err, STDERR_FILENO);
  ::execv(program, arguments);
  ::_exit(127);
}

}  // namespace

bool wait_until(const std::function<bool()>& condition, std::chrono::milliseconds patience) {
  const auto end = std::chrono::steady_clock::now() + patience;
  while (!condition()) {
    if (std::chrono::steady_clock::now() >= end) return false;
    std::this_thread::sleep_for(kPoll);
  }
  return true;
}

bool is_alive(pid_t process) {
  const auto state = state_of(process);
  return state && state->state != 'Z' && state->state != 'X';
}

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream{file, std::ios::binary};
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

StartedProgram::StartedProgram(const std::filesystem::path& program, std::vector<std::string> arguments,
                               const std::filesystem::path& output, const ProgramOptions& options)
    : output_{output} {
  const auto open_output = [&](const char* extension) {
    return ::open((output_.string() + extension).c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  };
  const int out = open_output(".out");
  const int err = open_output(".err");
  arguments.insert(arguments.begin(), program.string());
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  const std::string directory = options.working_directory.string();
  const rlim_t bytes = options.file_bytes_max.value_or(0);
  const rlimit file_size{bytes, bytes};

  process_ = out < 0 || err < 0 ? -1 : ::fork();
  if (process_ == 0) {
    become(program.c_str(), argv.data(), out, err, directory.empty() ? nullptr : directory.c_str(),
           options.file_bytes_max ? &file_size : nullptr);
  }
  const int error = errno;
  ::close(out);
  ::close(err);
  if (process_ < 0) throw std::runtime_error{program.string() + " cannot be started: " + std::strerror(error)};
}

bool send_signal(pid_t process, int number) { return process > 0 && ::kill(process, number) == 0; }

StartedProgram::StartedProgram(StartedProgram&& other) noexcept
    : output_{std::move(other.output_)},
      process_{std::exchange(other.process_, -1)},
      exit_code_{std::exchange(other.exit_code_, std::nullopt)} {}

StartedProgram::~StartedProgram() {
  if (process_ <= 0 || !is_running()) return;
  kill_descendants(process_);
  send_signal(process_, SIGKILL);
  ::waitpid(process_, nullptr, 0);
}

bool StartedProgram::is_running() {
  if (exit_code_) return false;
  int status = 0;
  if (::waitpid(process_, &status, WNOHANG) != process_) return true;
  exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return false;
}

std::optional<int> StartedProgram::wait(std::chrono::milliseconds patience) {
  static_cast<void>(wait_until([this] { return !is_running(); }, patience));
  return exit_code_;
}

void StartedProgram::signal(int number) const {
  if (!exit_code_) send_signal(process_, number);
}

std::string StartedProgram::standard_output() const { return text_of(output_.string() + ".out"); }
std::string StartedProgram::standard_error() const { return text_of(output_.string() + ".err"); }

std::vector<pid_t> StartedProgram::children() const { return children_of(process_); }

pid_t StartedProgram::child(const std::vector<std::string>& words) const {
  for (const pid_t process : children()) {
    const std::vector<std::string> line = command_line(process);
    if (std::search(line.begin(), line.end(), words.begin(), words.end()) != line.end()) return process;
  }
  return 0;
}

}  // namespace hybridtest
