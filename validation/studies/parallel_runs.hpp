#pragma once

#include <cstddef>
#include <functional>

namespace hybridtest {

/// Calls run(0) … run(count - 1), each once, on `threads` threads. The assignment to threads is not fixed, so
/// a run may depend only on its number. The first exception of a run is rethrown when all have ended.
/// @param threads   at least 1.
void run_in_parallel(std::size_t count, unsigned threads, const std::function<void(std::size_t)>& run);

/// Processors that this process may use.
[[nodiscard]] unsigned usable_threads();

}  // namespace hybridtest
