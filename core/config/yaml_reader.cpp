#include "core/config/yaml_reader.hpp"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <sstream>
#include <string>
#include <unordered_map>
#include <utility>

#include "core/config/wording.hpp"
#include "core/text/scalar.hpp"
#include "core/text/shown.hpp"

namespace hybridtest::config {
namespace {

Place place_of(const Source& source, const YAML::Mark& mark) {
  if (source.is_override || mark.is_null()) return {&source, 0, 0};
  return {&source, mark.line + 1, mark.column + 1};
}

/// An error at the end of the text is reported after its last character.
Place place_of_error(const Source& source, const YAML::Mark& mark, std::string_view text) {
  const std::size_t end = text.find_last_not_of(" \t\r\n") + 1;
  if (source.is_override || mark.is_null() || static_cast<std::size_t>(mark.pos) <= end) return place_of(source, mark);
  const std::string_view written = text.substr(0, end);
  const std::size_t line_begin = written.rfind('\n') + 1;  // 0 when there is no line above
  const auto lines = std::count(written.begin(), written.end(), '\n') + 1;
  return {&source, static_cast<int>(lines), static_cast<int>(end - line_begin) + 1};
}

/// The parser marks a quoted or block scalar with "!" and everything without a tag with "?".
bool is_explicit_tag(const std::string& tag) { return !tag.empty() && tag != "?" && tag != "!"; }

/// Builds the tree from the parser's events. The library's own tree loses duplicate keys and
/// the difference between 5 and "5".
class TreeBuilder final : public YAML::EventHandler {
 public:
  TreeBuilder(const Source& source, std::string_view path, int depth_max, std::vector<Finding>& findings)
      : source_{source}, path_{path}, depth_max_{depth_max}, findings_{findings} {}

  [[nodiscard]] Node take_root() { return std::move(root_); }
  [[nodiscard]] const Place& start() const { return start_; }

  /// The brackets that are open, for errors that show only at the end of the text.
  [[nodiscard]] std::string open_brackets() const {
    for (auto open = stack_.rbegin(); open != stack_.rend(); ++open)
      if (open->is_flow && open->start.line > 0)
        return "; " + described(open->node) + " in brackets begins at " + std::to_string(open->start.line) + ':' +
               std::to_string(open->start.column);
    return {};
  }

  void OnDocumentStart(const YAML::Mark& mark) override { start_ = place_of(source_, mark); }
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    Node node = begin(Node::Kind::null, mark, "?", anchor);
    // The parser gives an absent value the position of the next token.
    if (!stack_.empty() && stack_.back().has_key) node.place = stack_.back().key_place;
    add(std::move(node));
  }

  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    Node node = begin(Node::Kind::refused, mark, "?", 0);
    report(node.place, "an alias (*name) is not supported here; write the value itself");
    add(std::move(node));
  }

  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    Node node = begin(Node::Kind::scalar, mark, tag, anchor);
    node.quoted = tag == "!";
    node.text = value;
    add(std::move(node));
  }

  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value style) override {
    push(begin(Node::Kind::sequence, mark, tag, anchor), mark, style);
  }
  void OnSequenceEnd() override { pop(); }

  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value style) override {
    Node node = begin(Node::Kind::mapping, mark, tag, anchor);
    // A mapping under a key is found by its key, wherever its first entry stands.
    if (!stack_.empty() && stack_.back().has_key) node.place = stack_.back().key_place;
    push(std::move(node), mark, style);
  }
  void OnMapEnd() override { pop(); }

 private:
  /// A sequence or mapping that is being read.
  struct Open {
    Node node;
    Place start;
    bool is_flow = false;
    bool has_key = false;  // of a mapping: the next node is the value
    bool drop = false;     // the value belongs to a key that was refused
    std::string key;
    Place key_place;
    std::unordered_map<std::string, Place> first_places;
  };

  Node begin(Node::Kind kind, const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor) {
    Node node;
    node.kind = kind;
    node.place = place_of(source_, mark);
    if (anchor != 0) report(node.place, "an anchor (&name) is not supported here; remove it");
    if (is_explicit_tag(tag)) report(node.place, "a tag (" + shown(tag) + ") is not supported here; remove it");
    return node;
  }

  void push(Node node, const YAML::Mark& mark, YAML::EmitterStyle::value style) {
    if (static_cast<int>(stack_.size()) >= depth_max_)
      throw YAML::ParserException(mark, "nested more than " + std::to_string(kDepthMax) + " levels deep");
    stack_.emplace_back();
    stack_.back().node = std::move(node);
    stack_.back().start = place_of(source_, mark);
    stack_.back().is_flow = style == YAML::EmitterStyle::Flow;
  }

  void pop() {
    Node node = std::move(stack_.back().node);
    stack_.pop_back();
    add(std::move(node));
  }

  void add(Node node) {
    if (stack_.empty()) {
      root_ = std::move(node);
      return;
    }
    Open& open = stack_.back();
    if (open.node.kind == Node::Kind::sequence) {
      open.node.children.push_back(std::move(node));
    } else if (!open.has_key) {
      take_key(open, node);
    } else {
      if (!open.drop) {
        node.key = std::move(open.key);
        node.key_place = open.key_place;
        open.node.children.push_back(std::move(node));
      }
      open.has_key = false;
    }
  }

  void take_key(Open& open, const Node& node) {
    open.drop = true;
    if (node.kind == Node::Kind::scalar && !node.text.empty() && node.text.size() <= kKeyLengthMax) {
      const auto [first, inserted] = open.first_places.try_emplace(node.text, node.place);
      open.drop = !inserted;
      if (!inserted) report_duplicate(node, first->second);
    } else if (node.kind == Node::Kind::scalar && !node.text.empty()) {
      report(node.place,
             "a key has at most " + std::to_string(kKeyLengthMax) + " characters, found " + described(node));
    } else if (node.kind != Node::Kind::refused) {
      report(node.place, "a key must be a name, found " + described(node));
    }
    open.has_key = true;
    open.key = node.text;
    open.key_place = node.place;
  }

  void report_duplicate(const Node& node, const Place& first) {
    std::string what = "duplicate key";
    if (first.line > 0) what += ", first given at " + std::to_string(first.line) + ':' + std::to_string(first.column);
    findings_.push_back(found_at(node.place, joined_path(open_path(), shown(node.text)), what));
  }

  void report(const Place& place, const std::string& what) { findings_.push_back(found_at(place, open_path(), what)); }

  /// Path of what is being read.
  [[nodiscard]] std::string open_path() const {
    std::string path = path_;
    for (const Open& open : stack_) {
      if (open.node.kind == Node::Kind::sequence)
        path = indexed_path(path, open.node.children.size());
      else if (open.has_key)
        path = joined_path(path, shown(open.key));
    }
    return path;
  }

  const Source& source_;
  std::string path_;
  int depth_max_;
  std::vector<Finding>& findings_;
  std::vector<Open> stack_;
  Place start_;
  Node root_;
};

/// Rejects characters that the parser would take for the end of the input, or would ignore.
bool is_plain_text(std::string_view text, const Source& source, std::vector<Finding>& findings) {
  Place place{&source, 1, 1};
  const auto refuse = [&](std::string what) {
    if (source.is_override) place.line = place.column = 0;
    findings.push_back({place, std::move(what)});
    return false;
  };
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = utf8_length(text.substr(i));
    if (length == 0) return refuse("not UTF-8 text");
    const auto byte = static_cast<unsigned char>(text[i]);
    if (byte < 0x20U && byte != '\n' && byte != '\r' && byte != '\t') return refuse("a control character");
    place.column += static_cast<int>(length);
    if (byte == '\n') {
      ++place.line;
      place.column = 1;
    }
    i += length;
  }
  return true;
}

}  // namespace

std::optional<Node> read_yaml(std::string_view text, const Source& source, std::string_view path, int depth_max,
                              std::vector<Finding>& findings) {
  if (text.size() > kBytesMax) {
    findings.push_back({{&source, 0, 0}, "larger than " + std::to_string(kBytesMax >> 20U) + " MiB"});
    return std::nullopt;
  }
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  if (!is_plain_text(text, source, findings)) return std::nullopt;

  // The parser does not report an unclosed quote if the text ends with a new line. The added comment
  // makes it report one.
  std::istringstream stream{std::string{text} + "\n#"};
  TreeBuilder builder{source, path, depth_max, findings};
  try {
    YAML::Parser parser{stream};
    Node root;
    root.place = {&source, source.is_override ? 0 : 1, source.is_override ? 0 : 1};
    if (parser.HandleNextDocument(builder)) root = builder.take_root();
    // Called once only: after some stray tokens the parser finds empty documents forever.
    std::vector<Finding> unused;
    TreeBuilder second{source, path, depth_max, unused};
    if (parser.HandleNextDocument(second)) {
      findings.push_back({second.start(), "a second YAML document, or text outside the first, begins here"});
      return std::nullopt;
    }
    return root;
  } catch (const YAML::Exception& error) {
    findings.push_back({place_of_error(source, error.mark, text), "not YAML: " + error.msg + builder.open_brackets()});
    return std::nullopt;
  }
}

}  // namespace hybridtest::config
