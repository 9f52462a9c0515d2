#pragma once

#include <string>

#include "core/messages.hpp"

namespace hybridtest {

/// One sentence for people: what happened, to whom, with its values and units.
[[nodiscard]] std::string describe(const Event& event);

}  // namespace hybridtest
