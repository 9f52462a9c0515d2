#pragma once

#include <sys/socket.h>

#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "coordinator/opensees/element_port.hpp"
#include "coordinator/opensees/generic_client_session.hpp"

namespace hybridtest {

struct ServedElement {
  std::uint16_t port = 0;  // 0: one that is free, see GenericClientServer::port()
  ElementMatrices matrices;
};

/// The elements of an OpenSees that leads, over sockets: each has a port of its own, on which it takes one client by
/// TCP or by UDP. A thread reads, and answers matrix questions by itself.
///
/// OpenSees waits in recv() for each answer, for ever; it does not notice that a connection is closed, and then runs in
/// a circle. So a connection is kept open until the server is destroyed, and whoever ends the test ends the process of
/// OpenSees first.
class GenericClientServer final : public ElementPort {
 public:
  /// Listens from here on.
  /// @param listen_address   IPv4 address of this host. @param client_address   the only one that may connect.
  /// @param on_request       called by the thread of the server after new requests.
  /// @throws ConfigError for an address that is none, and for a port that cannot be listened on.
  GenericClientServer(const std::string& listen_address, const std::string& client_address,
                      std::vector<ServedElement> elements, std::function<void()> on_request);
  ~GenericClientServer() override;
  GenericClientServer(const GenericClientServer&) = delete;
  GenericClientServer& operator=(const GenericClientServer&) = delete;

  bool take(ElementRequest& request) noexcept override;
  void answer_force(int element, const Eigen::Ref<const Eigen::VectorXd>& force_n) noexcept override;

  /// That the element listens on.
  [[nodiscard]] std::uint16_t port(std::size_t element) const;

 private:
  struct Element;

  void serve() noexcept;
  void accept_client(Element& element);
  void read_tcp(Element& element);
  void read_udp(Element& element);
  void take_bytes(Element& element, std::span<const std::byte> bytes);
  void tell(Element& element, ElementRequest::Kind kind, ClientFault fault);
  void send_output(Element& element);
  void drop(Element& element, ClientFault fault);

  std::uint32_t client_address_;
  std::function<void()> on_request_;
  std::vector<std::unique_ptr<Element>> elements_;
  std::mutex mutex_;  // of what follows, and of the clients of the elements
  std::deque<ElementRequest> requests_;
  std::vector<ElementRequest> fresh_;
  bool has_news_ = false;
  std::atomic<bool> is_stopped_{false};
  int wake_ = -1;  // an event that ends poll()
  std::thread thread_;
};

}  // namespace hybridtest
