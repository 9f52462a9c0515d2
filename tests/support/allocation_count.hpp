#pragma once

#include <cstddef>

namespace hybridtest {

/// Calls of operator new in this program so far.
[[nodiscard]] std::size_t allocation_count() noexcept;

}  // namespace hybridtest
