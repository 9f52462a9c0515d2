#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "core/client_fault.hpp"

namespace hybridtest {

/// What an element `genericClient` of a running OpenSees says or asks.
struct ElementRequest {
  enum class Kind : std::uint8_t {
    connected,  // with the sizes of the element
    trial,      // 3
    force,      // 10: waits for answer_force()
    commit,     // 5
    die,        // 99: its model ends
    lost,       // the connection closed without 99, or sent what the protocol has not
    refused,    // a client that was not let in; a connected one is not affected
  };
  int element = 0;  // position in the list of elements
  Kind kind = Kind::connected;
  // Of a trial, one entry per degree of freedom of the element, in its order.
  Eigen::VectorXd displacement_m;
  Eigen::VectorXd velocity_m_per_s;
  Eigen::VectorXd acceleration_m_per_s2;
  double time_s = 0.0;                       // of a trial, in OpenSees
  ClientFault fault = ClientFault::unknown;  // lost and refused: why
  double given = 0.0;                        // of the fault, see describe()
};

/// The elements of an OpenSees that leads. Requests of one element come in its order; a force that is asked for is the
/// last request of its element until it is answered.
class ElementPort {
 public:
  virtual ~ElementPort() = default;
  /// The next request, in order of arrival. @return false when there is none.
  virtual bool take(ElementRequest& request) noexcept = 0;
  /// @param force_n   one entry per degree of freedom of the element, resisting a positive displacement.
  virtual void answer_force(int element, const Eigen::Ref<const Eigen::VectorXd>& force_n) noexcept = 0;
};

}  // namespace hybridtest
