#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "coordinator/opensees/element_port.hpp"
#include "core/client_fault.hpp"

namespace hybridtest {

/// What OpenSees is told of an element when it asks for a matrix. Square, one row per degree of freedom of the element.
struct ElementMatrices {
  Eigen::MatrixXd stiffness_n_per_m;  // initial (12) and tangent (13)
  Eigen::MatrixXd damping_n_s_per_m;  // 14
  Eigen::MatrixXd mass_kg;            // 15
};

/// One client of the protocol of `genericClient`, from its first byte to its last: bytes in, requests out. No sockets.
///
/// First come eleven int32: n, n, n, 0, 1, 0, 0, 0, n, 0 and the number of doubles in each later message, for n degrees
/// of freedom. Then messages of that size, both ways, with the action in the first double. All numbers have the byte
/// order of the host. Only a trial uses more than its first double; the others may carry what the trial before left
/// there.
class GenericClientSession {
 public:
  enum class Outcome : std::uint8_t {
    incomplete,  // all bytes are used, the message goes on
    request,     // the request is filled
    reply,       // reply() is to be sent
    fault,       // fault() tells why; nothing more is read
  };

  /// @param matrices   must outlive the session; their size is that of the element.
  explicit GenericClientSession(const ElementMatrices& matrices);

  /// Reads to the end of the next message, or of the bytes.
  /// @param bytes     what was read is taken off its front.
  /// @param request   its vectors are touched by a trial alone; `element` never.
  [[nodiscard]] Outcome take(std::span<const std::byte>& bytes, ElementRequest& request);
  /// The client has been understood, and its element is that of the scenario.
  [[nodiscard]] bool is_open() const noexcept { return is_open_; }
  /// Bytes have come.
  [[nodiscard]] bool has_begun() const noexcept { return filled_ > 0 || is_open_; }
  /// After 99.
  [[nodiscard]] bool has_ended() const noexcept { return has_ended_; }
  [[nodiscard]] ClientFault fault() const noexcept { return fault_; }
  /// What the client sent instead, see describe().
  [[nodiscard]] double given() const noexcept { return given_; }

  /// A matrix, after Outcome::reply. Valid until the next take().
  [[nodiscard]] std::span<const std::byte> reply() const noexcept { return std::as_bytes(std::span{reply_}); }
  /// The answer to 10. Valid until the next call.
  [[nodiscard]] std::span<const std::byte> force_reply(const Eigen::Ref<const Eigen::VectorXd>& force_n) noexcept;

 private:
  [[nodiscard]] Outcome read_sizes(ElementRequest& request);
  [[nodiscard]] Outcome read_message(ElementRequest& request);
  [[nodiscard]] Outcome read_trial(ElementRequest& request);
  [[nodiscard]] Outcome fail(ClientFault fault, double given = 0.0) noexcept;

  const ElementMatrices& matrices_;
  Eigen::Index size_;
  std::vector<std::byte> message_;
  std::size_t filled_ = 0;  // bytes of the message
  std::vector<double> values_;
  std::vector<double> reply_;
  std::vector<double> force_reply_;
  bool is_open_ = false;
  bool has_ended_ = false;
  ClientFault fault_ = ClientFault::unknown;
  double given_ = 0.0;
};

}  // namespace hybridtest
