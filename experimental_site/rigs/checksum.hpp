#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace hybridtest {

/// CRC-32 of IEEE 802.3 (reflected, polynomial 0x04C11DB7, first and last inverted), as in zlib and
/// PNG; of "123456789" it is 0xCBF43926.
[[nodiscard]] std::uint32_t crc32(std::span<const std::byte> bytes) noexcept;

}  // namespace hybridtest
