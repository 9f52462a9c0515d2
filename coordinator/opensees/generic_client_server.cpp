#include "coordinator/opensees/generic_client_server.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/tcp.h>
#include <sys/eventfd.h>
#include <sys/poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "core/assert.hpp"
#include "core/config_error.hpp"

namespace hybridtest {
namespace {

/// Datagrams of the client, and those that it expects, are no larger.
constexpr std::size_t kLargestDatagram = 9126;
/// The first byte of a client over UDP, and the answer to it.
constexpr std::byte kUdpHello{'a'};
constexpr std::byte kUdpWelcome{'b'};
/// Of what a client sends, per connection.
constexpr std::size_t kReceiveBuffer = std::size_t{1} << 16;
/// A message over UDP comes in one go; the system may grant less.
constexpr int kUdpSystemBuffer = 1 << 22;
/// Connections of an element that have not said who they are: a port scanner keeps no OpenSees out.
constexpr std::ptrdiff_t kStrangers = 4;
constexpr std::size_t kQueuedRequests = 64;
/// A client whose host has vanished is noticed after about idle + count * interval [s].
constexpr int kKeepAliveIdle = 5;
constexpr int kKeepAliveInterval = 2;
constexpr int kKeepAliveCount = 5;
/// Ports that are tried for one that is free for TCP and for UDP.
constexpr int kFreePortTrials = 32;

void set_option(int socket, int level, int option, int value) noexcept {
  // An option that the system does not grant costs time, not correctness.
  (void)::setsockopt(socket, level, option, &value, sizeof value);
}

[[nodiscard]] in_addr address_of(const std::string& text, const char* key) {
  in_addr address{};
  if (::inet_pton(AF_INET, text.c_str(), &address) == 1) return address;
  throw ConfigError{std::string{"coordinator."} + key + ": '" + text +
                    "' is no IPv4 address, such as 127.0.0.1; OpenSees understands neither names nor IPv6"};
}

[[nodiscard]] bool is_same(const sockaddr_in& a, const sockaddr_in& b) noexcept {
  return a.sin_addr.s_addr == b.sin_addr.s_addr && a.sin_port == b.sin_port;
}

[[nodiscard]] bool is_for_later() noexcept { return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR; }

}  // namespace

/// The sockets on which the clients of one element arrive.
class GenericClientServer::Ports {
 public:
  Ports(in_addr address, const std::string& host, std::uint16_t port) {
    for (int trial = 0; !open(address, port); ++trial) {
      const int error = errno;
      close();
      if (port == 0 && error == EADDRINUSE && trial < kFreePortTrials) continue;
      throw ConfigError{"coordinator.elements: cannot listen on port " + std::to_string(port) + " of " + host + ": " +
                        std::strerror(error) +
                        (error == EADDRNOTAVAIL ? "; write an address of this host as coordinator.listen"
                                                : "; give the element another port, here and in the model")};
    }
  }
  ~Ports() { close(); }
  Ports(const Ports&) = delete;
  Ports& operator=(const Ports&) = delete;

  [[nodiscard]] int tcp() const noexcept { return tcp_; }
  [[nodiscard]] int udp() const noexcept { return udp_; }
  [[nodiscard]] std::uint16_t port() const noexcept { return port_; }

 private:
  [[nodiscard]] bool open(in_addr host, std::uint16_t port) noexcept {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr = host;
    address.sin_port = htons(port);
    const auto* bound = reinterpret_cast<const sockaddr*>(&address);
    tcp_ = ::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    udp_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (tcp_ < 0 || udp_ < 0) return false;
    set_option(tcp_, SOL_SOCKET, SO_REUSEADDR, 1);  // connections of the test before may still be closing
    set_option(udp_, SOL_SOCKET, SO_RCVBUF, kUdpSystemBuffer);
    if (::bind(tcp_, bound, sizeof address) < 0) return false;
    socklen_t size = sizeof address;
    if (::getsockname(tcp_, reinterpret_cast<sockaddr*>(&address), &size) < 0) return false;
    port_ = ntohs(address.sin_port);
    return ::bind(udp_, bound, sizeof address) == 0 && ::listen(tcp_, SOMAXCONN) == 0;
  }
  void close() noexcept {
    for (int* socket : {&tcp_, &udp_}) {
      if (*socket >= 0) ::close(std::exchange(*socket, -1));
    }
  }

  int tcp_ = -1;
  int udp_ = -1;
  std::uint16_t port_ = 0;
};

/// A client, from its first byte.
class GenericClientServer::Connection {
 public:
  enum class State : std::uint8_t {
    stranger,  // has not said what it is
    client,
    failed,  // was let in, and broke the protocol
    over,
  };

  Connection(std::size_t element, const ElementMatrices& matrices, int socket, const sockaddr_in& peer, bool is_udp)
      : element_{element}, session_{matrices}, socket_{socket}, peer_{peer}, is_udp_{is_udp}, in_(kReceiveBuffer) {
    if (is_udp) return;  // the socket is that of the port
    set_option(socket_, IPPROTO_TCP, TCP_NODELAY, 1);
    set_option(socket_, IPPROTO_TCP, TCP_QUICKACK, 1);
    set_option(socket_, SOL_SOCKET, SO_KEEPALIVE, 1);
    set_option(socket_, IPPROTO_TCP, TCP_KEEPIDLE, kKeepAliveIdle);
    set_option(socket_, IPPROTO_TCP, TCP_KEEPINTVL, kKeepAliveInterval);
    set_option(socket_, IPPROTO_TCP, TCP_KEEPCNT, kKeepAliveCount);
  }
  ~Connection() {
    if (!is_udp_) ::close(socket_);
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  [[nodiscard]] std::size_t element() const noexcept { return element_; }
  [[nodiscard]] GenericClientSession& session() noexcept { return session_; }
  [[nodiscard]] int socket() const noexcept { return socket_; }
  [[nodiscard]] const sockaddr_in& peer() const noexcept { return peer_; }
  [[nodiscard]] bool is_udp() const noexcept { return is_udp_; }
  [[nodiscard]] bool has_unsent() const noexcept { return !out_.empty(); }
  [[nodiscard]] bool has_unread() const noexcept { return end_ > begin_; }
  [[nodiscard]] std::span<const std::byte> unread() const noexcept {
    return std::span{in_}.subspan(begin_, end_ - begin_);
  }
  void read_up_to(std::span<const std::byte> rest) noexcept { begin_ = end_ - rest.size(); }

  /// For what comes next; empty when there is no room.
  [[nodiscard]] std::span<std::byte> space() noexcept {
    if (begin_ == end_) begin_ = end_ = 0;
    if (end_ == in_.size() && begin_ > 0) {
      std::copy(in_.begin() + static_cast<std::ptrdiff_t>(begin_), in_.end(), in_.begin());
      end_ -= std::exchange(begin_, 0);
    }
    return std::span{in_}.subspan(end_);
  }
  void received(std::size_t count) noexcept { end_ += count; }

  void send(std::span<const std::byte> bytes) {
    if (out_.empty()) bytes = bytes.subspan(send_now(bytes));
    out_.insert(out_.end(), bytes.begin(), bytes.end());
  }
  void send_rest() { out_.erase(out_.begin(), out_.begin() + static_cast<std::ptrdiff_t>(send_now(out_))); }

  State state = State::stranger;
  bool asks = false;  // 10 is not answered yet

 private:
  /// @return how much was sent. What an error stops counts as sent: the end of the connection will be read.
  [[nodiscard]] std::size_t send_now(std::span<const std::byte> bytes) noexcept {
    std::size_t sent = 0;
    while (sent < bytes.size()) {
      const std::size_t count = is_udp_ ? std::min(kLargestDatagram, bytes.size() - sent) : bytes.size() - sent;
      const auto* to = is_udp_ ? reinterpret_cast<const sockaddr*>(&peer_) : nullptr;
      const auto done = ::sendto(socket_, bytes.data() + sent, count, MSG_DONTWAIT | MSG_NOSIGNAL, to,
                                 is_udp_ ? sizeof peer_ : socklen_t{0});
      if (done < 0) return is_for_later() ? sent : bytes.size();
      sent += static_cast<std::size_t>(done);
    }
    return sent;
  }

  std::size_t element_;
  GenericClientSession session_;
  int socket_;
  sockaddr_in peer_;
  bool is_udp_;
  std::vector<std::byte> in_;
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  std::vector<std::byte> out_;
};

GenericClientServer::GenericClientServer(const std::string& listen_address, const std::string& client_address,
                                         std::vector<ServedElement> elements, std::function<void()> on_request)
    : on_request_{std::move(on_request)},
      client_address_{address_of(client_address, "from")},
      queue_(kQueuedRequests + 2 * elements.size()) {
  const in_addr address = address_of(listen_address, "listen");
  matrices_.reserve(elements.size());
  for (ServedElement& element : elements) {
    matrices_.push_back(std::move(element.matrices));
    ports_.push_back(std::make_unique<Ports>(address, listen_address, element.port));
  }
  wake_ = ::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
  HYBRIDTEST_ASSERT(wake_ >= 0);
  thread_ = std::thread{[this] { serve(); }};
}

GenericClientServer::~GenericClientServer() {
  {
    const std::lock_guard lock{mutex_};
    is_ending_ = true;
  }
  wake();
  thread_.join();
  ::close(wake_);
}

bool GenericClientServer::take(ElementRequest& request) noexcept {
  bool is_room_awaited = false;
  {
    const std::lock_guard lock{mutex_};
    if (queued_ == 0) return false;
    std::swap(request, queue_[first_]);
    first_ = (first_ + 1) % queue_.size();
    --queued_;
    is_room_awaited = std::exchange(is_full_, false);
  }
  if (is_room_awaited) wake();
  return true;
}

void GenericClientServer::answer_force(int element, const Eigen::Ref<const Eigen::VectorXd>& force_n) noexcept {
  bool is_more = false;
  {
    const std::lock_guard lock{mutex_};
    Connection* connection = client(static_cast<std::size_t>(element));
    if (connection == nullptr || !std::exchange(connection->asks, false)) return;  // lost meanwhile
    connection->send(connection->session().force_reply(force_n));
    is_more = connection->has_unsent() || connection->has_unread();
  }
  if (is_more) wake();
}

std::uint16_t GenericClientServer::port(std::size_t element) const { return ports_.at(element)->port(); }

void GenericClientServer::wake() noexcept {
  const std::uint64_t one = 1;
  (void)!::write(wake_, &one, sizeof one);
}

bool GenericClientServer::is_permitted(const sockaddr_in& from) const noexcept {
  return from.sin_addr.s_addr == client_address_.s_addr;
}

GenericClientServer::Connection* GenericClientServer::client(std::size_t element) noexcept {
  for (const auto& connection : connections_) {
    if (connection->element() == element && connection->state == Connection::State::client) return connection.get();
  }
  return nullptr;
}

void GenericClientServer::push(std::size_t element) {
  HYBRIDTEST_ASSERT(room() > 0);
  ElementRequest& request = queue_[(first_ + queued_) % queue_.size()];
  request_.element = static_cast<int>(element);
  std::swap(request, request_);
  ++queued_;
  is_pushed_ = true;
}

void GenericClientServer::serve() noexcept {
  std::vector<pollfd> watched;
  std::vector<Connection*> owners;
  for (;;) {
    wait(watched, owners);
    {
      const std::lock_guard lock{mutex_};
      if (is_ending_) {
        connections_.clear();
        return;
      }
      std::uint64_t wakes = 0;
      if (watched[0].revents != 0) (void)!::read(wake_, &wakes, sizeof wakes);
      for (std::size_t i = 0; i < owners.size(); ++i) {
        const short events = watched[1 + 2 * ports_.size() + i].revents;
        if ((events & POLLOUT) != 0) owners[i]->send_rest();
        if ((events & (POLLIN | POLLRDHUP | POLLHUP | POLLERR)) != 0) receive(*owners[i]);
      }
      for (std::size_t i = 0; i < ports_.size(); ++i) {
        if (watched[1 + 2 * i].revents != 0) accept(i);
        if (watched[2 + 2 * i].revents != 0) receive_datagrams(i);
      }
      for (const auto& connection : connections_) go_on(*connection);
      std::erase_if(connections_, [](const auto& each) { return each->state == Connection::State::over; });
    }
    if (std::exchange(is_pushed_, false)) on_request_();
  }
}

void GenericClientServer::wait(std::vector<pollfd>& watched, std::vector<Connection*>& owners) {
  watched.clear();
  owners.clear();
  watched.push_back({wake_, POLLIN, 0});
  {
    const std::lock_guard lock{mutex_};
    for (std::size_t i = 0; i < ports_.size(); ++i) {
      watched.push_back({ports_[i]->tcp(), POLLIN, 0});
      watched.push_back({ports_[i]->udp(), static_cast<short>(is_behind(i) ? 0 : POLLIN), 0});
    }
    for (const auto& connection : connections_) {
      int socket = connection->socket();
      short events = 0;
      if (connection->has_unsent()) {
        events = POLLOUT;
      } else if (connection->state == Connection::State::failed || connection->is_udp()) {
        socket = -1;
      } else if (!connection->has_unread()) {
        events = POLLIN | POLLRDHUP;
      } else if (connection->asks) {  // sends on although it waits for an answer
        events = POLLRDHUP;
      } else {
        socket = -1;  // the queue is full
      }
      watched.push_back({socket, events, 0});
      owners.push_back(connection.get());
    }
  }
  (void)::poll(watched.data(), watched.size(), -1);
}

void GenericClientServer::accept(std::size_t element) {
  for (;;) {
    sockaddr_in from{};
    socklen_t size = sizeof from;
    const int socket =
        ::accept4(ports_[element]->tcp(), reinterpret_cast<sockaddr*>(&from), &size, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (socket < 0) return;
    auto connection = std::make_unique<Connection>(element, matrices_[element], socket, from, false);
    if (is_permitted(from)) {
      add(element, std::move(connection));
    } else {
      refuse(element, ClientFault::address);
    }
  }
}

bool GenericClientServer::is_behind(std::size_t element) const noexcept {
  return std::ranges::any_of(connections_, [&](const auto& each) {
    return each->element() == element && each->is_udp() && each->state == Connection::State::client &&
           each->has_unread();
  });
}

void GenericClientServer::receive_datagrams(std::size_t element) {
  while (!is_behind(element)) {
    sockaddr_in from{};
    socklen_t size = sizeof from;
    const auto count = ::recvfrom(ports_[element]->udp(), datagram_.data(), datagram_.size(), 0,
                                  reinterpret_cast<sockaddr*>(&from), &size);
    if (count < 0) return;
    take_datagram(element, from, std::span{datagram_}.first(static_cast<std::size_t>(count)));
  }
}

void GenericClientServer::take_datagram(std::size_t element, const sockaddr_in& from,
                                        std::span<const std::byte> datagram) {
  if (!is_permitted(from)) return refuse(element, ClientFault::address);
  const auto found = std::ranges::find_if(connections_, [&](const auto& each) {
    return each->is_udp() && each->element() == element && is_same(each->peer(), from) &&
           each->state != Connection::State::over;
  });
  const bool is_hello = datagram.size() == 1 && datagram[0] == kUdpHello;
  if (found == connections_.end()) {
    if (!is_hello) return refuse(element, ClientFault::other_protocol);
    if (client(element) != nullptr) return refuse(element, ClientFault::occupied);
    auto connection = std::make_unique<Connection>(element, matrices_[element], ports_[element]->udp(), from, true);
    connection->send(std::span{&kUdpWelcome, 1});
    return add(element, std::move(connection));
  }
  Connection& connection = **found;
  if (is_hello) {  // it has not heard the answer
    if (!connection.session().has_begun()) connection.send(std::span{&kUdpWelcome, 1});
    return;
  }
  const std::span<std::byte> space = connection.space();
  if (datagram.size() > space.size()) return fail(connection, ClientFault::other_message);
  std::ranges::copy(datagram, space.begin());
  connection.received(datagram.size());
  go_on(connection);
}

void GenericClientServer::receive(Connection& connection) {
  if (connection.state == Connection::State::failed || connection.is_udp()) return;
  const std::span<std::byte> space = connection.space();
  const auto count = ::recv(connection.socket(), space.data(), space.size(), 0);
  if (count > 0) {
    // Linux goes back to delayed acknowledgements on its own; with them each small message of the client waits 40 ms.
    set_option(connection.socket(), IPPROTO_TCP, TCP_QUICKACK, 1);
    connection.received(static_cast<std::size_t>(count));
    return;
  }
  if (count < 0 && is_for_later()) return;
  if (connection.state == Connection::State::stranger) {
    connection.state = Connection::State::over;
    if (connection.session().has_begun()) refuse(connection.element(), ClientFault::other_protocol);
    return;
  }
  if (!connection.session().has_ended()) fail(connection, ClientFault::closed);
  connection.state = Connection::State::over;
}

void GenericClientServer::go_on(Connection& connection) {
  using Outcome = GenericClientSession::Outcome;
  if (connection.state == Connection::State::failed) return;
  while (connection.has_unread() && connection.state != Connection::State::over && !connection.asks &&
         !connection.has_unsent()) {
    // One place is kept for the loss of each client.
    if (room() <= ports_.size()) {
      is_full_ = true;
      return;
    }
    std::span<const std::byte> bytes = connection.unread();
    const Outcome outcome = connection.session().take(bytes, request_);
    connection.read_up_to(bytes);
    switch (outcome) {
      case Outcome::incomplete: break;
      case Outcome::reply: connection.send(connection.session().reply()); break;
      case Outcome::fault: return fail(connection, connection.session().fault(), connection.session().given());
      case Outcome::request:
        if (request_.kind == ElementRequest::Kind::connected) {
          open(connection);
          break;
        }
        connection.asks = request_.kind == ElementRequest::Kind::force;
        push(connection.element());
        // Over UDP nothing else says that it has gone.
        if (connection.session().has_ended() && connection.is_udp()) connection.state = Connection::State::over;
        break;
    }
  }
}

void GenericClientServer::open(Connection& connection) {
  if (client(connection.element()) != nullptr) {
    connection.state = Connection::State::over;
    return refuse(connection.element(), ClientFault::occupied);
  }
  for (const auto& each : connections_) {
    if (each->element() == connection.element() && each->state == Connection::State::failed) {
      each->state = Connection::State::over;
    }
  }
  connection.state = Connection::State::client;
  push(connection.element());
}

void GenericClientServer::fail(Connection& connection, ClientFault fault, double given) {
  if (connection.state == Connection::State::stranger) {
    connection.state = Connection::State::over;
    return refuse(connection.element(), fault, given);
  }
  if (connection.state != Connection::State::client) return;
  connection.state = Connection::State::failed;
  connection.asks = false;
  request_.kind = ElementRequest::Kind::lost;
  request_.fault = fault;
  request_.given = given;
  push(connection.element());
}

void GenericClientServer::refuse(std::size_t element, ClientFault fault, double given) {
  ++refused_;
  if (room() <= queue_.size() / 2) return;  // many of them crowd no client out; they are counted
  request_.kind = ElementRequest::Kind::refused;
  request_.fault = fault;
  request_.given = given;
  push(element);
}

void GenericClientServer::add(std::size_t element, std::unique_ptr<Connection> connection) {
  const auto is_stranger = [&](const auto& each) {
    return each->element() == element && each->state == Connection::State::stranger;
  };
  if (std::ranges::count_if(connections_, is_stranger) >= kStrangers) {
    (*std::ranges::find_if(connections_, is_stranger))->state = Connection::State::over;
  }
  connections_.push_back(std::move(connection));
}

}  // namespace hybridtest
