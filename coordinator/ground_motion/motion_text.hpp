#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Lines, words and numbers of ground motion files, shared by the formats.
namespace hybridtest::motion_text {

/// One line without its end; `number` from 1.
struct Line {
  std::string_view text;
  int number = 0;
};

/// Splits at line feeds, at carriage returns before them, and at lone carriage returns.
[[nodiscard]] std::vector<Line> split_lines(std::string_view text);

/// Words between blanks and tabs; with `comma_separates` each comma also ends a word and stands
/// alone as an empty word when nothing is before it.
[[nodiscard]] std::vector<std::string_view> split_words(std::string_view line, bool comma_separates);

/// A decimal number with optional sign and E or D exponent, finite; nothing for anything else.
[[nodiscard]] std::optional<double> number(std::string_view word);

[[nodiscard]] std::string upper_case(std::string_view text);
/// Text from the file, made printable and short for a message.
[[nodiscard]] std::string shown(std::string_view text);

/// @param line   0 for the file as a whole.
[[noreturn]] void refuse(const std::string& file, int line, const std::string& what);

}  // namespace hybridtest::motion_text
