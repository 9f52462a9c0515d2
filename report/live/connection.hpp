#pragma once

#include <array>
#include <string>

#include "report/live/http_library.hpp"
#include "runtime/executor.hpp"

namespace hybridtest {

/// One client of the live view. Each request with its answer has a time and a size that it must not exceed, whatever
/// the number of pieces it comes in.
class Connection final : public httplib::Stream {
 public:
  Connection(socket_t socket, const ProcessClock& clock) : socket_{socket}, clock_{clock} {}
  ~Connection() override;
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// Waits for the first byte of a request, in short pieces.
  /// @param is_stopping   asked between them.
  [[nodiscard]] bool waits_for_request(Duration limit, const std::function<bool()>& is_stopping);
  /// From now on time and size count for the next request.
  void begin_request(Duration limit);
  /// The request has used up its time or its size.
  [[nodiscard]] bool is_exhausted() const { return left() <= Duration{0} || bytes_left_ == 0; }

  [[nodiscard]] bool is_readable() const override;
  [[nodiscard]] bool is_writable() const override;
  ssize_t read(char* bytes, std::size_t size) override;
  ssize_t write(const char* bytes, std::size_t size) override;
  void get_remote_ip_and_port(std::string& ip, int& port) const override;
  void get_local_ip_and_port(std::string& ip, int& port) const override;
  [[nodiscard]] socket_t socket() const override { return socket_; }

 private:
  [[nodiscard]] bool wait(short events, Duration limit) const;
  [[nodiscard]] Duration left() const;

  socket_t socket_;
  const ProcessClock& clock_;
  Instant deadline_{};
  std::size_t bytes_left_ = 0;
  std::array<char, 4096> buffer_{};
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
};

}  // namespace hybridtest
