#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

#include "validation/blind_batches/batch_files.hpp"

namespace hybridtest::blind {

struct MakeSettings {
  std::size_t cases = 0;
  std::uint64_t seed = 0;
  std::filesystem::path directory;
  std::filesystem::path key;  // file, outside of the directory
};

/// Calls one(0) … one(count - 1), each once, in any order, on any threads; throws what one of them throws.
using ForEach = std::function<void(std::size_t count, const std::function<void(std::size_t)>& one)>;

/// Writes a batch and, apart from it, its key. The batch names the SHA-256 of each of its files
/// and of the key; the seed is in the key alone.
/// @throws std::runtime_error when the directory holds something already or cannot be written.
void make_batch(const MakeSettings& settings, const Digest& digest, const ForEach& for_each);

}  // namespace hybridtest::blind
