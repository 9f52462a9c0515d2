#include "core/config/node.hpp"

#include <algorithm>

namespace hybridtest::config {

Node* Node::child(std::string_view name) {
  const auto found =
      std::find_if(children.begin(), children.end(), [name](const Node& node) { return node.key == name; });
  return found == children.end() ? nullptr : &*found;
}

Finding found_at(const Place& place, std::string_view path, std::string_view what) {
  const bool is_named = path.empty() || (place.source->is_override && place.source->overridden_path == path);
  return {place, is_named ? std::string{what} : std::string{path} + ": " + std::string{what}};
}

std::string joined_path(std::string_view path, std::string_view key) {
  std::string joined{path};
  if (!joined.empty()) joined += '.';
  joined += key;
  return joined;
}

std::string indexed_path(std::string_view path, std::size_t index) {
  return std::string{path} + '[' + std::to_string(index) + ']';
}

}  // namespace hybridtest::config
