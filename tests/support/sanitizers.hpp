#pragma once

namespace hybridtest {

/// A sanitizer makes code several times slower: long repetitions are shortened by this factor, and by nothing without
/// one.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr int kShortenedBy = 10;
#else
inline constexpr int kShortenedBy = 1;
#endif

}  // namespace hybridtest
