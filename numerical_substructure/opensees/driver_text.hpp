#pragma once

#include <string_view>

namespace hybridtest {

/// The program in Tcl that OpenSees runs for us: driver.tcl of this folder, which states its arguments and messages.
[[nodiscard]] std::string_view opensees_driver() noexcept;

}  // namespace hybridtest
