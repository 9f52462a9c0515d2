#include "core/config/override.hpp"

#include <algorithm>
#include <charconv>
#include <optional>
#include <string>
#include <utility>

#include "core/config/wording.hpp"
#include "core/config/yaml_reader.hpp"
#include "core/text/scalar.hpp"
#include "core/text/shown.hpp"

namespace hybridtest::config {
namespace {

/// One step of a path: a key of a mapping or, in brackets, an element of a list.
struct Step {
  bool is_element = false;
  std::string name;
};

bool is_printable(std::string_view text) {
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    if (length == 0 || static_cast<unsigned char>(text.front()) < 0x20U) return false;
    text.remove_prefix(length);
  }
  return true;
}

/// @return nothing when the path is malformed.
std::optional<std::vector<Step>> split_path(std::string_view path) {
  if (!is_printable(path)) return std::nullopt;
  std::vector<Step> steps;
  bool key_expected = true;
  while (!path.empty() || key_expected) {
    if (key_expected) {
      const std::size_t end = std::min(path.find_first_of(".[]"), path.size());
      if (end == 0) return std::nullopt;
      steps.push_back({false, std::string{path.substr(0, end)}});
      path.remove_prefix(end);
      key_expected = false;
    } else if (path.front() == '.') {
      path.remove_prefix(1);
      key_expected = true;
    } else if (path.front() == '[') {
      const std::size_t end = path.find(']');
      if (end == std::string_view::npos || end == 1) return std::nullopt;
      steps.push_back({true, std::string{path.substr(1, end - 1)}});
      path.remove_prefix(end + 1);
    } else {
      return std::nullopt;
    }
  }
  return steps;
}

/// Follows a path through the tree; keeps the error that stops it.
class Walk {
 public:
  explicit Walk(Node& root) : node_{&root} {}

  /// @param may_create   a missing key is added, empty.
  /// @return false when the path cannot be followed further.
  bool take(const Step& step, bool may_create) {
    return step.is_element ? take_element(step.name) : take_key(step.name, may_create);
  }

  [[nodiscard]] Node& node() const { return *node_; }
  [[nodiscard]] bool created() const { return created_; }
  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] const std::string& error() const { return error_; }

 private:
  bool fail(std::string error) {
    error_ = std::move(error);
    return false;
  }

  [[nodiscard]] std::string place() const { return path_.empty() ? "the configuration" : path_; }

  bool take_key(const std::string& key, bool may_create) {
    if (node_->kind != Node::Kind::mapping) {
      const bool is_list = node_->kind == Node::Kind::sequence;
      return fail(
          place() + " is " + described(*node_) + " and has no key '" + shown(key) + "'" +
          (is_list ? "; an element is selected by its number from [0], or by its id: [" + shown(key) + "]" : ""));
    }
    Node* child = node_->child(key);
    if (child == nullptr && !may_create) return fail(place() + " has no key '" + shown(key) + "'" + key_hint(key));
    if (child == nullptr && key.size() > kKeyLengthMax)
      return fail("a key has at most " + std::to_string(kKeyLengthMax) + " characters");
    if (child == nullptr) {
      child = &node_->children.emplace_back();
      child->key = key;
      created_ = true;
    }
    node_ = child;
    path_ = joined_path(path_, shown(key));
    return true;
  }

  bool take_element(const std::string& selector) {
    if (node_->kind != Node::Kind::sequence)
      return fail(place() + " is " + described(*node_) + " and has no elements to select by [" + shown(selector) + "]");
    std::size_t index = 0;
    const char* const end = selector.data() + selector.size();
    const auto result = std::from_chars(selector.data(), end, index);
    const bool is_index = result.ptr == end && result.ec != std::errc::invalid_argument;
    if (!is_index) {
      index = position_of_id(selector);
      if (index == node_->children.size())
        return fail(place() + " has no element with id '" + shown(selector) + "'" + id_hint(selector));
    } else if (result.ec != std::errc{} || index >= node_->children.size()) {
      return fail(place() + " has " + std::to_string(node_->children.size()) + " elements, counted from [0]; found [" +
                  shown(selector) + "]");
    }
    node_ = &node_->children[index];
    path_ = indexed_path(path_, index);
    return true;
  }

  [[nodiscard]] static const std::string* id_of(Node& element) {
    if (element.kind != Node::Kind::mapping) return nullptr;
    const Node* id = element.child("id");
    return id != nullptr && id->kind == Node::Kind::scalar ? &id->text : nullptr;
  }

  [[nodiscard]] std::size_t position_of_id(std::string_view id) const {
    std::size_t position = 0;
    for (Node& element : node_->children) {
      const std::string* const text = id_of(element);
      if (text != nullptr && *text == id) break;
      ++position;
    }
    return position;
  }

  [[nodiscard]] std::string key_hint(std::string_view key) const {
    std::vector<std::string> known;
    for (const Node& child : node_->children) known.push_back(child.key);
    return name_advice(key, known, "known here");
  }

  [[nodiscard]] std::string id_hint(std::string_view id) const {
    std::vector<std::string> known;
    for (Node& element : node_->children)
      if (const std::string* const text = id_of(element)) known.push_back(*text);
    return name_advice(id, known, "known here");
  }

  Node* node_;
  std::string path_;
  std::string error_;
  bool created_ = false;
};

}  // namespace

void apply_override(std::string_view assignment, Source& source, Node& root, std::vector<Finding>& findings) {
  source.is_override = true;
  const std::size_t equals = assignment.find('=');
  const std::string_view path = assignment.substr(0, equals);
  source.name = "--set " + shown(path);
  source.overridden_path = path;
  const Place place{&source, 0, 0};
  const auto refuse = [&](std::string what) { findings.push_back({place, std::move(what)}); };

  const auto steps = split_path(path);
  if (equals == std::string_view::npos || !steps)
    return refuse("expected key.path=value, for example time.step_s=0.002 or substructures[0].rig.type=ideal");
  const int depth_left = kDepthMax - static_cast<int>(steps->size());
  if (depth_left <= 0) return refuse("nested more than " + std::to_string(kDepthMax) + " levels deep");
  const std::string_view value = assignment.substr(equals + 1);
  if (value.find_first_not_of(" \t\r\n") == std::string_view::npos) return refuse("expected a value after '='");

  auto replacement = read_yaml(value, source, path, depth_left, findings);
  if (!replacement) return;

  Walk walk{root};
  for (std::size_t i = 0; i < steps->size(); ++i)
    if (!walk.take((*steps)[i], i + 1 == steps->size())) return refuse(walk.error());
  source.overridden_path = walk.path();
  replacement->key = std::move(walk.node().key);
  replacement->key_place = walk.created() ? place : walk.node().key_place;
  walk.node() = std::move(*replacement);
}

}  // namespace hybridtest::config
