#include "benchmarks/peer_processes.hpp"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>
#include <csignal>
#include <stdexcept>

namespace hybridtest::benchmarks {

PeerProcesses::~PeerProcesses() {
  for (const pid_t process : processes_) ::kill(process, SIGKILL);
  for (const pid_t process : processes_) ::waitpid(process, nullptr, 0);
}

void PeerProcesses::start(const std::vector<std::string>& arguments) {
  const std::string program = "/proc/self/exe";
  std::vector<char*> pointers{const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments) pointers.push_back(const_cast<char*>(argument.c_str()));
  pointers.push_back(nullptr);
  pid_t process = 0;
  if (::posix_spawn(&process, program.c_str(), nullptr, nullptr, pointers.data(), environ) != 0) {
    throw std::runtime_error{"cannot start an echo peer"};
  }
  processes_.push_back(process);
}

}  // namespace hybridtest::benchmarks
