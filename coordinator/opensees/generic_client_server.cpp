#include "coordinator/opensees/generic_client_server.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "core/assert.hpp"
#include "core/config_error.hpp"

namespace hybridtest {
namespace {

/// OpenSees splits a message of UDP into datagrams of this size.
constexpr std::size_t kDatagramBytes = 9126;
/// Requests that wait: the thread reads no further before they are taken.
constexpr std::size_t kRequestsMax = 4096;

std::uint32_t address_of(const std::string& text, const char* key) {
  in_addr address{};
  if (inet_pton(AF_INET, text.c_str(), &address) == 1) return address.s_addr;
  throw ConfigError{std::string{"coordinator."} + key + ": '" + text +
                    "' is no IPv4 address, such as 127.0.0.1; OpenSees understands neither names nor IPv6"};
}

int listening_socket(int type, std::uint32_t address, std::uint16_t port) {
  const int fd = socket(AF_INET, type | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const int on = 1;
  if (type == SOCK_STREAM) setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  sockaddr_in own{};
  own.sin_family = AF_INET;
  own.sin_addr.s_addr = address;
  own.sin_port = htons(port);
  if (fd >= 0 && bind(fd, reinterpret_cast<const sockaddr*>(&own), sizeof own) == 0 &&
      (type != SOCK_STREAM || listen(fd, 4) == 0)) {
    return fd;
  }
  const std::string why = std::strerror(errno);
  if (fd >= 0) close(fd);
  throw ConfigError{"coordinator.elements: cannot listen on port " + std::to_string(port) + ": " + why +
                    "; give the element another port, here and in the model"};
}

std::uint16_t port_of(int fd) {
  sockaddr_in own{};
  socklen_t size = sizeof own;
  getsockname(fd, reinterpret_cast<sockaddr*>(&own), &size);
  return ntohs(own.sin_port);
}

/// Without it, Nagle's algorithm at OpenSees and the delayed acknowledgement here cost 44 ms a step. The system takes
/// it back by itself: it is asked for again after each receive.
void acknowledge_at_once(int fd) {
  const int on = 1;
  setsockopt(fd, IPPROTO_TCP, TCP_QUICKACK, &on, sizeof on);
}

}  // namespace

struct GenericClientServer::Element {
  explicit Element(ServedElement served) : matrices{std::move(served.matrices)} {}
  ~Element() {
    for (const int fd : {listener, datagrams, client}) {
      if (fd >= 0) close(fd);
    }
  }
  Element(const Element&) = delete;
  Element& operator=(const Element&) = delete;

  [[nodiscard]] bool has_client() const noexcept { return session != nullptr; }

  int index = 0;
  ElementMatrices matrices;
  int listener = -1;                              // TCP
  int datagrams = -1;                             // UDP
  int client = -1;                                // TCP
  sockaddr_in peer{};                             // UDP
  std::unique_ptr<GenericClientSession> session;  // of the client that is there
  std::vector<std::byte> unsent;
  ClientFault refusal = ClientFault::unknown;  // the last one told
};

GenericClientServer::GenericClientServer(const std::string& listen_address, const std::string& client_address,
                                         std::vector<ServedElement> elements, std::function<void()> on_request)
    : client_address_{address_of(client_address, "from")}, on_request_{std::move(on_request)} {
  const std::uint32_t address = address_of(listen_address, "listen");
  for (ServedElement& served : elements) {
    const std::uint16_t port = served.port;
    Element& element = *elements_.emplace_back(std::make_unique<Element>(std::move(served)));
    element.index = static_cast<int>(elements_.size()) - 1;
    element.listener = listening_socket(SOCK_STREAM, address, port);
    element.datagrams = listening_socket(SOCK_DGRAM, address, port_of(element.listener));
  }
  wake_ = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  HYBRIDTEST_ASSERT(wake_ >= 0);
  thread_ = std::thread{[this] { serve(); }};
}

GenericClientServer::~GenericClientServer() {
  is_stopped_ = true;
  eventfd_write(wake_, 1);
  thread_.join();
  close(wake_);
}

std::uint16_t GenericClientServer::port(std::size_t element) const { return port_of(elements_.at(element)->listener); }

bool GenericClientServer::take(ElementRequest& request) noexcept {
  const std::lock_guard lock{mutex_};
  if (requests_.empty()) return false;
  std::swap(request, requests_.front());
  requests_.pop_front();
  if (requests_.size() == kRequestsMax / 2) eventfd_write(wake_, 1);  // there is room again
  return true;
}

void GenericClientServer::answer_force(int element, const Eigen::Ref<const Eigen::VectorXd>& force_n) noexcept {
  const std::lock_guard lock{mutex_};
  Element& asked = *elements_[static_cast<std::size_t>(element)];
  if (!asked.has_client() || !asked.session->answer_force(force_n)) return;
  send_output(asked);
  if (!asked.unsent.empty()) eventfd_write(wake_, 1);
}

void GenericClientServer::serve() noexcept {
  std::vector<pollfd> polled;
  while (!is_stopped_) {
    polled.clear();
    polled.push_back({wake_, POLLIN, 0});
    {
      const std::lock_guard lock{mutex_};
      const bool has_room = requests_.size() < kRequestsMax;
      for (const auto& element : elements_) {
        const short input = has_room ? POLLIN : 0;
        polled.push_back({element->listener, POLLIN, 0});
        polled.push_back({element->datagrams, input, 0});
        polled.push_back({element->client, static_cast<short>(input | (element->unsent.empty() ? 0 : POLLOUT)), 0});
      }
    }
    if (poll(polled.data(), polled.size(), -1) < 0 && errno != EINTR) continue;
    eventfd_t count = 0;
    if (polled[0].revents != 0) eventfd_read(wake_, &count);
    {
      const std::lock_guard lock{mutex_};
      has_news_ = false;
      for (std::size_t i = 0; i < elements_.size(); ++i) {
        Element& element = *elements_[i];
        if (polled[3 * i + 3].revents != 0 && element.client >= 0) {
          send_output(element);
          read_tcp(element);
        }
        if (polled[3 * i + 2].revents != 0) read_udp(element);
        if (polled[3 * i + 1].revents != 0) accept_client(element);
      }
    }
    if (has_news_) on_request_();
  }
}

void GenericClientServer::accept_client(Element& element) {
  sockaddr_in from{};
  socklen_t size = sizeof from;
  const int fd = accept4(element.listener, reinterpret_cast<sockaddr*>(&from), &size, SOCK_CLOEXEC | SOCK_NONBLOCK);
  if (fd < 0) return;
  if (from.sin_addr.s_addr != client_address_ || element.has_client()) {
    close(fd);
    tell(element, ElementRequest::Kind::refused, element.has_client() ? ClientFault::occupied : ClientFault::address);
    return;
  }
  const int on = 1;
  setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  acknowledge_at_once(fd);
  element.client = fd;
  element.session = std::make_unique<GenericClientSession>(element.matrices);
}

void GenericClientServer::read_tcp(Element& element) {
  std::array<std::byte, 1U << 16U> bytes;
  while (element.client >= 0) {
    const ssize_t count = recv(element.client, bytes.data(), bytes.size(), 0);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return;
    if (count <= 0) {
      drop(element, ClientFault::closed);
      return;
    }
    acknowledge_at_once(element.client);
    take_bytes(element, {bytes.data(), static_cast<std::size_t>(count)});
    if (static_cast<std::size_t>(count) < bytes.size()) return;
  }
}

void GenericClientServer::read_udp(Element& element) {
  std::array<std::byte, 1U << 16U> bytes;
  sockaddr_in from{};
  socklen_t size = sizeof from;
  for (ssize_t count = 0;; size = sizeof from) {
    count = recvfrom(element.datagrams, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&from), &size);
    if (count < 0) return;
    const bool is_peer = element.client < 0 && element.has_client() &&
                         from.sin_addr.s_addr == element.peer.sin_addr.s_addr && from.sin_port == element.peer.sin_port;
    if (is_peer) {
      take_bytes(element, {bytes.data(), static_cast<std::size_t>(count)});
    } else if (from.sin_addr.s_addr != client_address_ || element.has_client()) {
      tell(element, ElementRequest::Kind::refused, element.has_client() ? ClientFault::occupied : ClientFault::address);
    } else if (count != 1 || bytes[0] != std::byte{'a'}) {
      tell(element, ElementRequest::Kind::refused, ClientFault::other_protocol);
    } else {
      element.peer = from;
      element.session = std::make_unique<GenericClientSession>(element.matrices);
      const char welcome = 'b';
      static_cast<void>(
          sendto(element.datagrams, &welcome, 1, 0, reinterpret_cast<const sockaddr*>(&from), sizeof from));
    }
  }
}

void GenericClientServer::take_bytes(Element& element, std::span<const std::byte> bytes) {
  element.session->receive(bytes, fresh_);
  for (ElementRequest& request : fresh_) {
    request.element = element.index;
    requests_.push_back(std::move(request));
    has_news_ = true;
  }
  fresh_.clear();
  send_output(element);
  if (const auto fault = element.session->fault()) drop(element, *fault);
}

void GenericClientServer::tell(Element& element, ElementRequest::Kind kind, ClientFault fault) {
  // Of many refusals for one reason the first is told: anybody can send them.
  if (kind == ElementRequest::Kind::refused && std::exchange(element.refusal, fault) == fault) return;
  ElementRequest request;
  request.element = element.index;
  request.kind = kind;
  request.fault = fault;
  requests_.push_back(std::move(request));
  has_news_ = true;
}

void GenericClientServer::send_output(Element& element) {
  if (!element.has_client()) return;
  const std::vector<std::byte> output = element.session->take_output();
  element.unsent.insert(element.unsent.end(), output.begin(), output.end());
  std::size_t sent = 0;
  while (sent < element.unsent.size()) {
    const bool is_tcp = element.client >= 0;
    const std::size_t left = element.unsent.size() - sent;
    const ssize_t count = is_tcp
                              ? send(element.client, element.unsent.data() + sent, left, MSG_NOSIGNAL)
                              : sendto(element.datagrams, element.unsent.data() + sent, std::min(left, kDatagramBytes),
                                       0, reinterpret_cast<const sockaddr*>(&element.peer), sizeof element.peer);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) break;  // no room, which poll() tells of; or a connection that the next read finds closed
    sent += static_cast<std::size_t>(count);
  }
  element.unsent.erase(element.unsent.begin(), element.unsent.begin() + static_cast<std::ptrdiff_t>(sent));
}

void GenericClientServer::drop(Element& element, ClientFault fault) {
  const bool was_connected = element.session->is_connected();
  const bool was_over = element.session->is_over();
  if (element.client >= 0) close(std::exchange(element.client, -1));
  element.session.reset();
  element.unsent.clear();
  if (was_over) return;
  tell(element, was_connected ? ElementRequest::Kind::lost : ElementRequest::Kind::refused, fault);
}

}  // namespace hybridtest
