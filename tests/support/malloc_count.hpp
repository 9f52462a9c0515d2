#pragma once

#include <cstddef>

namespace hybridtest {

/// Calls of malloc, calloc and realloc in this program so far: the matrix library allocates past
/// operator new.
[[nodiscard]] std::size_t malloc_count() noexcept;

/// False where a sanitizer owns the allocator; the count stays zero then.
[[nodiscard]] bool counts_mallocs() noexcept;

}  // namespace hybridtest
