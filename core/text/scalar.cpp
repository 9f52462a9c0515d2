#include "core/text/scalar.hpp"

#include <algorithm>
#include <array>
#include <charconv>

namespace hybridtest {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

std::string lowered(std::string_view text) {
  std::string low{text};
  std::transform(low.begin(), low.end(), low.begin(), lower);
  return low;
}

std::size_t skip_digits(std::string_view text, std::size_t i) {
  while (i < text.size() && is_digit(text[i])) ++i;
  return i;
}

/// [+-]? (digits [. digits?]? | . digits) ([eE] [+-]? digits)?
bool is_real(std::string_view text) {
  std::size_t i = !text.empty() && (text[0] == '+' || text[0] == '-') ? 1 : 0;
  const std::size_t whole = i;
  i = skip_digits(text, i);
  std::size_t digits = i - whole;
  if (i < text.size() && text[i] == '.') {
    const std::size_t fraction = ++i;
    i = skip_digits(text, i);
    digits += i - fraction;
  }
  if (digits == 0) return false;
  if (i < text.size() && (text[i] == 'e' || text[i] == 'E')) {
    ++i;
    if (i < text.size() && (text[i] == '+' || text[i] == '-')) ++i;
    const std::size_t exponent = i;
    i = skip_digits(text, i);
    if (i == exponent) return false;
  }
  return i == text.size();
}

bool is_whole(std::string_view text) {
  const std::size_t sign = !text.empty() && (text[0] == '+' || text[0] == '-') ? 1 : 0;
  return text.size() > sign && skip_digits(text, sign) == text.size();
}

bool is_not_finite(std::string_view text) {
  std::string low = lowered(text);
  if (!low.empty() && (low[0] == '+' || low[0] == '-')) low.erase(0, 1);
  if (!low.empty() && low[0] == '.') low.erase(0, 1);
  return low == "nan" || low == "inf" || low == "infinity";
}

/// from_chars knows no plus sign.
std::string_view without_plus(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  return text;
}

/// Words that some version of YAML takes for null or a boolean.
bool is_reserved_word(std::string_view text) {
  static constexpr std::array<std::string_view, 9> kWords = {"null", "true", "false", "yes", "no",
                                                             "on",   "off",  "y",     "n"};
  return std::find(kWords.begin(), kWords.end(), lowered(text)) != kWords.end();
}

bool is_plain_safe(std::string_view text) {
  if (text.empty() || !(is_letter(text[0]) || text[0] == '_' || text[0] == '/')) return false;
  return std::all_of(text.begin(), text.end(), [](char c) {
    return is_letter(c) || is_digit(c) || c == '_' || c == '.' || c == '/' || c == '-' || c == '+';
  });
}

void append_escaped(std::string& out, char c) {
  constexpr std::string_view kHexDigits = "0123456789abcdef";
  const auto byte = static_cast<unsigned char>(c);
  if (c == '\n') {
    out += "\\n";
  } else if (c == '\t') {
    out += "\\t";
  } else if (c == '"' || c == '\\') {
    out += {'\\', c};
  } else if (byte < 0x20U || byte == 0x7FU) {
    out += {'\\', 'x', kHexDigits[byte >> 4U], kHexDigits[byte & 0xFU]};
  } else {
    out += c;
  }
}

std::string quoted(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) append_escaped(out, c);
  return out + '"';
}

}  // namespace

Real read_real(std::string_view text) noexcept {
  if (!is_real(text)) return {is_not_finite(text) ? NumberForm::not_finite : NumberForm::not_a_number};
  text = without_plus(text);
  Real real{NumberForm::number};
  const auto result = std::from_chars(text.data(), text.data() + text.size(), real.value);
  if (result.ec == std::errc::result_out_of_range) return {NumberForm::not_representable};
  if (result.ec != std::errc{} || result.ptr != text.data() + text.size()) return {NumberForm::not_a_number};
  return real;
}

Whole read_whole(std::string_view text) noexcept {
  if (!is_whole(text)) {
    const NumberForm form = read_real(text).form;
    return {form == NumberForm::number ? NumberForm::not_whole : form};
  }
  text = without_plus(text);
  Whole whole{NumberForm::number};
  const auto result = std::from_chars(text.data(), text.data() + text.size(), whole.value);
  if (result.ec != std::errc{}) return {NumberForm::not_representable};
  return whole;
}

std::string written_number(double value) {
  std::array<char, 32> buffer{};
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  std::string text{buffer.data(), result.ptr};
  const std::size_t exponent = text.find('e');
  if (exponent != std::string::npos && text.find('.') == std::string::npos) text.insert(exponent, ".0");
  return text;
}

std::string written_integer(std::int64_t value) { return std::to_string(value); }

std::string written_boolean(bool value) { return value ? "true" : "false"; }

std::string written_text(std::string_view text) {
  return is_plain_safe(text) && !is_reserved_word(text) ? std::string{text} : quoted(text);
}

/// Well-formed sequences of The Unicode Standard, table 3-7.
std::size_t utf8_length(std::string_view text) noexcept {
  const auto byte = [text](std::size_t i) -> unsigned {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U;
  };
  const auto within = [](unsigned value, unsigned low, unsigned high) { return value >= low && value <= high; };
  const auto tail = [&](std::size_t i) { return within(byte(i), 0x80, 0xBF); };
  const unsigned lead = byte(0);
  if (text.empty()) return 0;
  if (lead < 0x80) return 1;
  if (within(lead, 0xC2, 0xDF)) return tail(1) ? 2 : 0;
  if (within(lead, 0xE0, 0xEF)) {
    const unsigned low = lead == 0xE0 ? 0xA0 : 0x80;
    const unsigned high = lead == 0xED ? 0x9F : 0xBF;  // no surrogates
    return within(byte(1), low, high) && tail(2) ? 3 : 0;
  }
  if (within(lead, 0xF0, 0xF4)) {
    const unsigned low = lead == 0xF0 ? 0x90 : 0x80;
    const unsigned high = lead == 0xF4 ? 0x8F : 0xBF;  // up to U+10FFFF
    return within(byte(1), low, high) && tail(2) && tail(3) ? 4 : 0;
  }
  return 0;
}

}  // namespace hybridtest
