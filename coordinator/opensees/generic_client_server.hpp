#pragma once

#include <netinet/in.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "coordinator/opensees/element_port.hpp"
#include "coordinator/opensees/generic_client_session.hpp"

struct pollfd;

namespace hybridtest {

struct ServedElement {
  std::uint16_t port = 0;  // TCP and UDP; 0: one that is free, see GenericClientServer::port()
  ElementMatrices matrices;
};

/// The elements of an OpenSees that leads, over TCP and UDP: one port each, because the protocol does not say which
/// element speaks.
///
/// A thread of its own reads; forces are sent by the thread that answers. The matrices are answered here. What a client
/// sends after 10 waits until that is answered. A client that was let in and then breaks the protocol keeps its
/// connection, without an answer: OpenSees never ends by itself when its connection closes.
class GenericClientServer final : public ElementPort {
 public:
  /// Listens from here on.
  /// @param listen_address   IPv4 address of this host. @param client_address   the only one that may connect.
  /// @param on_request       called by the thread of the server after new requests; must not block.
  /// @throws ConfigError for an address that is none, and for a port that cannot be listened on.
  GenericClientServer(const std::string& listen_address, const std::string& client_address,
                      std::vector<ServedElement> elements, std::function<void()> on_request);
  /// Closes all connections. An OpenSees that still waits then takes a full core until it is ended.
  ~GenericClientServer() override;
  GenericClientServer(const GenericClientServer&) = delete;
  GenericClientServer& operator=(const GenericClientServer&) = delete;

  // One thread.
  bool take(ElementRequest& request) noexcept override;
  void answer_force(int element, const Eigen::Ref<const Eigen::VectorXd>& force_n) noexcept override;

  [[nodiscard]] std::uint16_t port(std::size_t element) const;
  /// Clients that were not let in.
  [[nodiscard]] std::uint64_t refused() const noexcept { return refused_; }

 private:
  class Connection;
  class Ports;

  void serve() noexcept;
  void wait(std::vector<pollfd>& watched, std::vector<Connection*>& owners);
  void accept(std::size_t element);
  void receive_datagrams(std::size_t element);
  /// A client over UDP has sent more than can be dealt with now; the system keeps what follows.
  [[nodiscard]] bool is_behind(std::size_t element) const noexcept;
  void take_datagram(std::size_t element, const sockaddr_in& from, std::span<const std::byte> datagram);
  void receive(Connection& connection);
  /// Deals with what a client sent, as far as it may.
  void go_on(Connection& connection);
  void open(Connection& connection);
  void fail(Connection& connection, ClientFault fault, double given = 0.0);
  void refuse(std::size_t element, ClientFault fault, double given = 0.0);
  void add(std::size_t element, std::unique_ptr<Connection> connection);
  [[nodiscard]] bool is_permitted(const sockaddr_in& from) const noexcept;
  [[nodiscard]] Connection* client(std::size_t element) noexcept;

  [[nodiscard]] std::size_t room() const noexcept { return queue_.size() - queued_; }
  void push(std::size_t element);
  void wake() noexcept;

  std::vector<ElementMatrices> matrices_;  // one per element
  std::function<void()> on_request_;
  in_addr client_address_{};
  std::vector<std::unique_ptr<Ports>> ports_;  // one per element
  int wake_ = -1;
  std::array<std::byte, 65536> datagram_{};

  std::mutex mutex_;  // what follows
  std::vector<std::unique_ptr<Connection>> connections_;
  std::vector<ElementRequest> queue_;
  std::size_t first_ = 0;
  std::size_t queued_ = 0;
  bool is_full_ = false;    // a client waits for room in the queue
  bool is_pushed_ = false;  // since the last call of on_request_
  bool is_ending_ = false;
  ElementRequest request_;

  std::atomic<std::uint64_t> refused_{0};
  std::thread thread_;
};

}  // namespace hybridtest
