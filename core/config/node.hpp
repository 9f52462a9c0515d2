#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace hybridtest::config {

/// Deepest nesting of a configuration; far beyond any sensible one, far below the stack.
inline constexpr int kDepthMax = 64;
/// Longest key; longer ones cannot be written back as simple YAML keys.
inline constexpr std::size_t kKeyLengthMax = 200;

/// Where a piece of configuration comes from: a file or one override.
struct Source {
  std::string name;             // file, or `--set key.path`
  bool is_override = false;     // its lines and columns mean nothing to the user
  std::string overridden_path;  // `substructures[0].rig.type`, with an override
  int order = 0;                // overrides count up from 1 in the order given
};

/// Points into a Source that outlives it.
struct Place {
  const Source* source = nullptr;
  int line = 0;    // 1-based; 0 when unknown
  int column = 0;  // 1-based, in bytes; 0 when unknown
};

/// One value of the configuration as it was written.
struct Node {
  enum class Kind {
    null,      // nothing, `~` or `null`
    scalar,    // `text` and `quoted`
    sequence,  // `children`
    mapping,   // `children`, each with a `key`; keys are unique
    refused,   // already reported; reads as absent without a further error
  };
  Kind kind = Kind::null;
  bool quoted = false;
  Place place;
  std::string text;
  std::string key;  // empty outside a mapping
  Place key_place;
  std::vector<Node> children;

  /// @return the child of that key, or null; linear in the number of children.
  [[nodiscard]] Node* child(std::string_view name);
};

/// One thing found wrong, before places become text.
struct Finding {
  Place place;
  std::string what;
};

/// `path: what`, without the path where the place already names it.
[[nodiscard]] Finding found_at(const Place& place, std::string_view path, std::string_view what);

/// `path.key`, or the key alone at the top.
[[nodiscard]] std::string joined_path(std::string_view path, std::string_view key);
/// `path[index]`.
[[nodiscard]] std::string indexed_path(std::string_view path, std::size_t index);

}  // namespace hybridtest::config
