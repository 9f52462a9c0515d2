#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace hybridtest {

/// Why a client of an element was refused or lost. Sent as a number: new reasons go to the end.
enum class ClientFault : std::uint8_t {
  unknown,
  closed,          // the connection, without 99
  address,         // not the one that may connect
  occupied,        // the element has a client
  other_protocol,  // its first message is not that of genericClient
  other_size,      // of the element, in degrees of freedom
  short_messages,  // too few doubles in each for the element (-dataSize)
  other_message,   // an action that the protocol has not
  not_finite,      // its trial
};

/// For messages, such as "its connection closed before its model had ended".
[[nodiscard]] std::string_view describe(ClientFault fault) noexcept;
/// @param given   what the client sent: its degrees of freedom (other_size), the doubles in its messages
///                (short_messages), the action (other_message); without meaning for the other faults.
[[nodiscard]] std::string describe(ClientFault fault, double given);

}  // namespace hybridtest
