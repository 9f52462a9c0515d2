#include "numerical_substructure/opensees/opensees_child.hpp"

#include <fcntl.h>
#include <sys/poll.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <utility>

#include "core/opensees_program.hpp"
#include "core/text/scalar.hpp"
#include "numerical_substructure/opensees/driver_text.hpp"

namespace hybridtest {
namespace {

/// Of a reply: letter, 3 bytes, size of the text, 4 numbers.
constexpr std::size_t kReplyHead = 8 + 4 * sizeof(double);

std::array<int, 2> pipe_ends() {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) {
    throw std::runtime_error{std::string{"no pipe to OpenSees: "} + std::strerror(errno)};
  }
  return ends;
}

std::string descriptor_file(int descriptor) { return "/dev/fd/" + std::to_string(descriptor); }

std::filesystem::path temporary_folder() {
  std::string name = (std::filesystem::temp_directory_path() / "hybridtest_opensees_XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error{name + ": " + std::strerror(errno)};
  return name;
}

/// Whether something can be read, or the other end has closed.
bool is_readable(int descriptor, int limit_ms) noexcept {
  pollfd entry{.fd = descriptor, .events = POLLIN, .revents = 0};
  int ready = 0;
  do {
    ready = poll(&entry, 1, limit_ms);
  } while (ready < 0 && errno == EINTR);
  return ready > 0;
}

int milliseconds(Duration limit) noexcept {
  return static_cast<int>(std::chrono::duration_cast<std::chrono::milliseconds>(limit).count());
}

}  // namespace

OpenSeesChild::OpenSeesChild(const OpenSeesSettings& settings, OpenSeesPurpose purpose,
                             const std::filesystem::path& log, std::function<void()> wake)
    : dofs_{settings.interface.size()}, wake_{std::move(wake)} {
  const std::filesystem::path program = find_opensees(settings.program);
  limit_opensees_threads();
  folder_ = temporary_folder();
  const std::filesystem::path driver = folder_ / "driver.tcl";
  std::ofstream{driver} << opensees_driver();
  const std::array<int, 2> requests = pipe_ends();
  const std::array<int, 2> replies = pipe_ends();
  std::vector<std::string> arguments{driver.string(),
                                     descriptor_file(requests[0]),
                                     descriptor_file(replies[1]),
                                     std::filesystem::absolute(settings.script).lexically_normal().string(),
                                     purpose == OpenSeesPurpose::test ? "test" : "stiffness",
                                     written_number(settings.step_s),
                                     written_number(settings.tolerance_m / settings.length_unit_m),
                                     (folder_ / "trial").string()};
  for (const OpenSeesDof& dof : settings.interface) {
    arguments.insert(arguments.end(), {std::to_string(dof.node), std::to_string(dof.dof)});
  }
  process_.emplace("OpenSees", ChildStart{.program = program,
                                          .arguments = std::move(arguments),
                                          .log_file = log.empty() ? folder_ / "opensees.log" : log,
                                          .directory = std::filesystem::absolute(settings.script).parent_path(),
                                          .kept_descriptors = {requests[0], replies[1]},
                                          .is_killed_with_parent = true});
  close(requests[0]);
  close(replies[1]);
  requests_ = requests[1];
  replies_ = replies[0];
  if (wake_) watch_ = std::thread{[this] { watch(); }};
}

OpenSeesChild::~OpenSeesChild() {
  close(requests_);  // the driver ends here, and files of recorders are written out
  if (!process_->wait_for_end(kOpenSeesLeave)) process_->kill();
  if (watch_.joinable()) {
    asked_.store(-1);
    asked_.notify_all();
    watch_.join();
  }
  close(replies_);
  std::error_code error;
  std::filesystem::remove_all(folder_, error);
}

void OpenSeesChild::watch() noexcept {
  int seen = 0;
  while (true) {
    asked_.wait(seen);
    seen = asked_.load();
    if (seen < 0) return;
    static_cast<void>(is_readable(replies_, -1));
    wake_();
  }
}

bool OpenSeesChild::send(DriverRequest request, std::span<const double> displacements) noexcept {
  bytes_.assign(8 + displacements.size_bytes(), '\0');
  bytes_[0] = static_cast<char>(request);
  std::memcpy(bytes_.data() + 8, displacements.data(), displacements.size_bytes());
  // A pipe takes more than one request. A process that has ended gives EPIPE; SIGPIPE is held back for the call.
  struct sigaction ignore {};
  struct sigaction before {};
  ignore.sa_handler = SIG_IGN;
  sigaction(SIGPIPE, &ignore, &before);
  std::size_t sent = 0;
  while (sent < bytes_.size()) {
    const ssize_t taken = write(requests_, bytes_.data() + sent, bytes_.size() - sent);
    if (taken < 0 && errno == EINTR) continue;
    if (taken < 0) break;
    sent += static_cast<std::size_t>(taken);
  }
  sigaction(SIGPIPE, &before, nullptr);
  asked_.fetch_add(1);
  asked_.notify_all();
  return sent == bytes_.size();
}

bool OpenSeesChild::read_some(char* bytes, std::size_t size, Duration limit) noexcept {
  for (std::size_t have = 0; have < size;) {
    if (!is_readable(replies_, milliseconds(limit))) return false;
    const ssize_t got = read(replies_, bytes + have, size - have);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    have += static_cast<std::size_t>(got);
  }
  return true;
}

DriverArrival OpenSeesChild::take(DriverReply& reply, Duration limit) noexcept {
  if (!is_readable(replies_, milliseconds(limit))) return DriverArrival::none;
  const std::size_t numbers = dofs_ * sizeof(double);
  bytes_.resize(kReplyHead + numbers);
  if (!read_some(bytes_.data(), bytes_.size(), kReplyRest)) return DriverArrival::ended;
  std::int32_t text_size = 0;
  std::array<double, 4> state{};
  std::memcpy(&text_size, bytes_.data() + 4, sizeof text_size);
  std::memcpy(state.data(), bytes_.data() + 8, sizeof state);
  reply.kind = static_cast<DriverReply::Kind>(bytes_[0]);
  reply.residual = state[0];
  reply.tolerance = state[1];
  reply.forces.resize(dofs_);
  std::memcpy(reply.forces.data(), bytes_.data() + kReplyHead, numbers);
  reply.text.resize(static_cast<std::size_t>(text_size));
  return read_some(reply.text.data(), reply.text.size(), kReplyRest) ? DriverArrival::reply : DriverArrival::ended;
}

int OpenSeesChild::exit_code() noexcept {
  static_cast<void>(process_->wait_for_end(kOpenSeesLeave));
  return process_->exit_code().value_or(0);
}

std::string OpenSeesChild::last_words() const {
  std::string words;
  for (const std::string& line : process_->last_lines(kOpenSeesLines)) words += "\n  " + line;
  return words.empty() ? "" : "; the end of its output (" + process_->log_file().string() + "):" + words;
}

}  // namespace hybridtest
