#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace hybridtest {

enum class NumberForm {
  number,
  not_a_number,       // any other text
  not_finite,         // .nan, inf and their spellings
  not_representable,  // beyond what a double, or a 64-bit integer, holds
  not_whole,          // a number, but not written as an integer
};

struct Real {
  NumberForm form = NumberForm::not_a_number;
  double value = 0.0;
};
struct Whole {
  NumberForm form = NumberForm::not_a_number;
  std::int64_t value = 0;
};

/// Decimal numbers as YAML 1.2 writes them: `12`, `-0.5`, `20.0e3`, `1e-5`, `.5`. No
/// hexadecimal, no underscores, no locale.
[[nodiscard]] Real read_real(std::string_view text) noexcept;
/// Decimal digits with an optional sign.
[[nodiscard]] Whole read_whole(std::string_view text) noexcept;

/// Shortest text that reads back as the same double. An exponent gets a mantissa with a point,
/// without which YAML 1.1 readers take it for text.
[[nodiscard]] std::string written_number(double value);
[[nodiscard]] std::string written_integer(std::int64_t value);
[[nodiscard]] std::string written_boolean(bool value);
/// Plain where every YAML reader takes it for text, otherwise double-quoted; for keys too.
[[nodiscard]] std::string written_text(std::string_view text);

/// Length in bytes of the UTF-8 character at the front; 0 when it is none.
[[nodiscard]] std::size_t utf8_length(std::string_view text) noexcept;

}  // namespace hybridtest
