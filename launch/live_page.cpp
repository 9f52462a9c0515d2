#include "launch/live_page.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/poll.h>
#include <unistd.h>

#include <array>
#include <stdexcept>

namespace hybridtest {
namespace {

constexpr int kStart_ms = 20'000;

/// The line that the process writes when it can be asked; empty when it ends before.
std::string read_address(int descriptor) {
  std::string address;
  std::array<char, 512> bytes{};
  pollfd waited{.fd = descriptor, .events = POLLIN, .revents = 0};
  while (address.find('\n') == std::string::npos && poll(&waited, 1, kStart_ms) > 0) {
    const ssize_t received = read(descriptor, bytes.data(), bytes.size());
    if (received <= 0) break;
    address.append(bytes.data(), static_cast<std::size_t>(received));
  }
  return address.substr(0, address.find('\n'));
}

}  // namespace

LivePage start_live_page(const std::string& test_name, const std::filesystem::path& run_directory,
                         const NetworkOptions& network, bool allow_control) {
  std::array<int, 2> pipe_ends{};
  if (pipe2(pipe_ends.data(), O_CLOEXEC) != 0) throw std::runtime_error{"no pipe for the live page"};
  ChildStart start;
  start.program = std::filesystem::read_symlink("/proc/self/exe");
  // The address holds the token, so that it goes through a pipe and not into a file.
  start.arguments = {"watch",
                     test_name,
                     "--out",
                     run_directory.string(),
                     "--end-with-test",
                     "--address-to",
                     std::to_string(pipe_ends[1])};
  if (allow_control) start.arguments.emplace_back("--allow-control");
  for (const std::string& argument : network.arguments()) start.arguments.push_back(argument);
  start.log_file = run_directory / "watch.log";
  start.kept_descriptors = {pipe_ends[1]};
  start.outlives_parent = true;
  auto process = std::make_unique<ChildProcess>("watch", start);
  close(pipe_ends[1]);
  const std::string address = read_address(pipe_ends[0]);
  close(pipe_ends[0]);
  if (address.empty()) {
    process->kill();
    throw std::runtime_error{"the live page did not start: " + process->last_words()};
  }
  fmt::print(stderr, "watch the test at {}\n", address);
  return LivePage{std::move(process)};
}

void LivePage::tell_end() {
  if (!process_->is_running()) return;
  fmt::print(stderr, "the page stays until nobody has looked at it for a minute (process {})\n", process_->process());
}

}  // namespace hybridtest
