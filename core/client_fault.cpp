#include "core/client_fault.hpp"

#include <cstdio>

namespace hybridtest {

std::string_view describe(ClientFault fault) noexcept {
  switch (fault) {
    case ClientFault::unknown: break;
    case ClientFault::closed:
      return "its connection closed before its model had ended; look at the end of opensees.log";
    case ClientFault::address: return "it comes from another address than coordinator.from";
    case ClientFault::occupied: return "the element has a client already; give each genericClient a port of its own";
    case ClientFault::other_protocol: return "it does not speak the protocol of genericClient";
    case ClientFault::other_size:
      return "its number of degrees of freedom differs from that of the element in the scenario "
             "(coordinator.elements)";
    case ClientFault::short_messages:
      return "its messages are too short for the element; give genericClient a larger -dataSize, at least 3 n + 2 and "
             "n x n for n degrees of freedom";
    case ClientFault::other_message: return "it sent a message that the protocol of genericClient has not";
    case ClientFault::not_finite:
      return "it sent a displacement that is not a number: the analysis of OpenSees has diverged; look at its model "
             "and "
             "its step";
  }
  return "it gives no reason";
}

std::string describe(ClientFault fault, double given) {
  char number[32];
  std::snprintf(number, sizeof number, "%.6g", given);
  std::string text{describe(fault)};
  if (fault == ClientFault::other_size) return text + "; it has " + number;
  if (fault == ClientFault::short_messages) return text + "; they have " + number + " doubles";
  if (fault == ClientFault::other_message) return text + ", with the action " + number;
  return text;
}

}  // namespace hybridtest
