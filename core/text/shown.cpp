#include "core/text/shown.hpp"

#include "core/text/nearest_name.hpp"
#include "core/text/scalar.hpp"

namespace hybridtest {

std::string shown(std::string_view text) {
  constexpr std::size_t kShownLengthMax = 60;
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    if (i >= kShownLengthMax) return out + "...";
    const std::size_t length = utf8_length(text.substr(i));
    const auto byte = static_cast<unsigned char>(text[i]);
    if (length <= 1 && (length == 0 || byte < 0x20U || byte == 0x7FU)) {
      out += byte == '\n' ? "\\n" : "?";
      ++i;
    } else {
      out += text.substr(i, length);
      i += length;
    }
  }
  return out;
}

std::string listed(const std::vector<std::string>& names) {
  constexpr std::size_t kNamesMax = 20;
  std::string text;
  for (std::size_t i = 0; i < names.size() && i < kNamesMax; ++i) text += (i > 0 ? ", " : "") + shown(names[i]);
  if (names.size() > kNamesMax) text += " and " + std::to_string(names.size() - kNamesMax) + " more";
  return text;
}

std::string name_advice(std::string_view name, const std::vector<std::string>& known, std::string_view label) {
  std::string text = "; ";
  text += label;
  if (const auto nearest = nearest_name(name, known)) {
    text = "; did you mean '" + shown(*nearest) + "'? ";
    text += label;
    text[text.size() - label.size()] = static_cast<char>(label.front() - 'a' + 'A');
  }
  return text + ": " + (known.empty() ? "none" : listed(known));
}

}  // namespace hybridtest
