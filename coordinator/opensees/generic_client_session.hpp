#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "coordinator/opensees/element_port.hpp"

namespace hybridtest {

/// What OpenSees is told of an element when it asks for its matrices (12 to 15), n x n each.
struct ElementMatrices {
  Eigen::MatrixXd stiffness_n_per_m;  // initial and tangent
  Eigen::MatrixXd damping_n_s_per_m;
  Eigen::MatrixXd mass_kg;
};

/// One connection of an element `genericClient`, as bytes: what arrives becomes requests, what is answered becomes
/// bytes.
///
/// First come 11 integers of 32 bits: the sizes of the displacement, velocity, acceleration, force and time that
/// OpenSees sends (n, n, n, 0, 1), of those that it wants (0, 0, 0, n, 0), and the number of doubles in each message.
/// Then come messages of that many doubles with the action in the first one, and what is beyond its values is left over
/// from an older message: 3 trial [3, d(n), v(n), a(n), t], 5 commit, 10 force, 12 to 15 initial stiffness, tangent,
/// damping and mass, 99 die. Forces and matrices are answered by a message of the same length that begins with them,
/// column by column. Integers and doubles are in the order of bytes of the machine; there is no frame and no checksum.
/// (The classes GenericClient of OpenSees and its sockets.)
class GenericClientSession {
 public:
  /// A message at most: 30 000 doubles of a trial, or a matrix of 500 x 500.
  static constexpr std::int32_t kDataSizeMax = 1 << 18;

  /// @param matrices   of the element; their size is its number of degrees of freedom, at least 1.
  explicit GenericClientSession(ElementMatrices matrices);

  /// Takes bytes that arrived, in any portions. After a fault it takes nothing more.
  /// @param requests   new ones are appended; their `element` is left alone. `lost` is not among them.
  void receive(std::span<const std::byte> bytes, std::vector<ElementRequest>& requests);
  /// Why the client is no client of this element; nothing while it is.
  [[nodiscard]] std::optional<ClientFault> fault() const noexcept { return fault_; }
  [[nodiscard]] bool is_connected() const noexcept { return data_size_ > 0; }
  /// The client said that its model ends (99).
  [[nodiscard]] bool is_over() const noexcept { return is_over_; }

  /// Answers the force that is asked for. @return false when none is, or when it has another size.
  [[nodiscard]] bool answer_force(const Eigen::Ref<const Eigen::VectorXd>& force_n);
  /// Bytes to send since the last call.
  [[nodiscard]] std::vector<std::byte> take_output();

 private:
  [[nodiscard]] std::size_t wanted_bytes() const noexcept;
  void read_sizes(std::vector<ElementRequest>& requests);
  void read_message(std::vector<ElementRequest>& requests);
  void answer(const Eigen::Ref<const Eigen::VectorXd>& values);

  ElementMatrices matrices_;
  Eigen::Index dofs_;
  std::int32_t data_size_ = 0;  // 0 before the sizes have come
  bool is_over_ = false;
  bool is_asked_ = false;
  std::optional<ClientFault> fault_;
  std::vector<std::byte> arrived_;  // of the message that is not whole yet
  std::vector<std::byte> output_;
  std::vector<double> message_;
};

}  // namespace hybridtest
