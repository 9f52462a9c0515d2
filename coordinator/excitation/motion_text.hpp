#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "coordinator/excitation/read_ground_motion.hpp"

/// Lines, words, numbers and units of ground motion files, shared by the formats.
namespace hybridtest::motion_text {

/// One line without its end; `number` from 1.
struct Line {
  std::string_view text;
  int number = 0;
};

/// Without the mark that some programs put before UTF-8 text.
[[nodiscard]] std::string_view without_byte_order_mark(std::string_view text);

/// Splits at line feeds, at carriage returns before them, and at lone carriage returns.
[[nodiscard]] std::vector<Line> split_lines(std::string_view text);

/// Words between blanks and tabs. With `comma_separates` a comma also ends a word; a comma with no
/// word before it gives an empty word.
[[nodiscard]] std::vector<std::string_view> split_words(std::string_view line, bool comma_separates);

/// A decimal number with optional sign and E or D exponent, finite; std::nullopt for anything else.
[[nodiscard]] std::optional<double> number(std::string_view word);

[[nodiscard]] std::string upper_case(std::string_view text);
/// Text from the file, made printable and short for a message.
[[nodiscard]] std::string shown(std::string_view text);

/// @param line   0 for the file as a whole.
[[noreturn]] void refuse(const std::string& file, int line, const std::string& what);

}  // namespace hybridtest::motion_text

namespace hybridtest {

[[nodiscard]] double metres_per_second_squared(AccelerationUnit unit) noexcept;

/// @throws ConfigError when the options give another step than the file's, by more than one percent.
void require_same_step(const std::string& file, int line, double dt_s, const GroundMotionOptions& options);

}  // namespace hybridtest
