#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <string_view>

namespace hybridtest {

/// Text of at most `Capacity` bytes without heap; longer text is cut off at construction.
template <std::size_t Capacity>
class FixedText {
 public:
  static constexpr std::size_t kCapacity = Capacity;

  constexpr FixedText() = default;
  constexpr FixedText(std::string_view text) noexcept : size_{std::min(text.size(), Capacity)} {
    std::copy_n(text.data(), size_, bytes_.data());
  }
  constexpr FixedText(const char* text) noexcept : FixedText{std::string_view{text}} {}
  FixedText(const std::string& text) noexcept : FixedText{std::string_view{text}} {}

  [[nodiscard]] constexpr std::string_view view() const noexcept { return {bytes_.data(), size_}; }
  [[nodiscard]] std::string text() const { return std::string{view()}; }
  [[nodiscard]] constexpr bool empty() const noexcept { return size_ == 0; }

  friend constexpr bool operator==(const FixedText& a, const FixedText& b) noexcept { return a.view() == b.view(); }

 private:
  std::array<char, Capacity> bytes_{};
  std::size_t size_ = 0;
};

}  // namespace hybridtest
