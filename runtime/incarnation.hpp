#pragma once

#include "core/messages.hpp"

namespace hybridtest {

/// A random number that identifies this process among those of the test; not 0.
[[nodiscard]] Incarnation draw_incarnation();

}  // namespace hybridtest
