#pragma once

#include <string_view>

namespace hybridtest {

/// The program in Tcl that OpenSees runs to give the matrices of a model: import.tcl of this folder, which states its
/// arguments and files.
[[nodiscard]] std::string_view opensees_import_script() noexcept;

}  // namespace hybridtest
