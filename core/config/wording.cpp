#include "core/config/wording.hpp"

#include "core/config/scalar.hpp"
#include "core/config/section.hpp"

namespace hybridtest::config {

std::string described(const Node& node) {
  switch (node.kind) {
    case Node::Kind::null: return "nothing";
    case Node::Kind::sequence: return "a list";
    case Node::Kind::mapping: return "a mapping";
    case Node::Kind::refused: return "an alias";
    case Node::Kind::scalar: break;
  }
  if (!node.quoted) {
    if (node.text == "true" || node.text == "false") return node.text;
    const NumberForm form = read_real(node.text).form;
    if (form == NumberForm::not_finite) return shown(node.text);
    if (form != NumberForm::not_a_number) return "the number " + shown(node.text);
  }
  return "the text \"" + shown(node.text) + '"';
}

std::string shown(std::string_view text) {
  constexpr std::size_t kLongest = 60;
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    if (i >= kLongest) return out + "...";
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
  constexpr std::size_t kMost = 20;
  std::string text;
  for (std::size_t i = 0; i < names.size() && i < kMost; ++i) text += (i > 0 ? ", " : "") + shown(names[i]);
  if (names.size() > kMost) text += " and " + std::to_string(names.size() - kMost) + " more";
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

}  // namespace hybridtest::config
