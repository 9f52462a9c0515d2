#pragma once

#include "core/messages.hpp"

namespace hybridtest {

/// A number that no other process of the test will draw; not 0.
[[nodiscard]] Incarnation draw_incarnation();

}  // namespace hybridtest
