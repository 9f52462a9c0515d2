#include "core/config/wording.hpp"

#include "core/text/scalar.hpp"
#include "core/text/shown.hpp"

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

}  // namespace hybridtest::config
