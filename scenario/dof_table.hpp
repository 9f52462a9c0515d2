#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace hybridtest {

/// Directions of a node, in the order of their numbers 1 to 6: displacements along the axes, rotations about them.
inline constexpr std::array<std::string_view, 6> kDirections{"x", "y", "z", "rx", "ry", "rz"};

/// A column of a recording has at most 63 letters, and 22 of `acceleration_…_m_per_s2` are not the name's.
inline constexpr std::size_t kDofNameLongest = 41;

/// The degrees of freedom of a structure, in the order of the rows of its matrices, and how a text addresses one.
///
/// Without a file each has a name. Those of a file have a node and a direction as well, and answer to their name
/// (`roof_x`), to node and direction (`114.x`, `114.1`), and to `node 114 dof 1`.
class DofTable {
 public:
  DofTable() = default;
  /// Named in the scenario; no two alike.
  explicit DofTable(std::vector<std::string> names);

  /// Text in columns with commas: a header `node,direction` or `node,direction,name`, then a row per degree of
  /// freedom. A direction is its name or its number. Without a name, node and direction are the name. Empty lines
  /// and lines that begin with # are skipped.
  /// @param file   stands for the text in messages.
  /// @throws ConfigError listing up to 20 lines that are wrong, each with what was expected.
  [[nodiscard]] static DofTable parse(std::string_view text, const std::string& file);
  /// @throws ConfigError as parse(), and when the file cannot be read.
  [[nodiscard]] static DofTable read(const std::filesystem::path& file);

  [[nodiscard]] std::size_t size() const noexcept { return names_.size(); }
  [[nodiscard]] const std::vector<std::string>& names() const noexcept { return names_; }
  [[nodiscard]] bool has_directions() const noexcept { return !directions_.empty(); }

  /// Its row; nothing for an address that no degree of freedom has.
  [[nodiscard]] std::optional<int> find(std::string_view address) const;
  /// Rows that a pattern matches by name or by node and direction, in order: `*` stands for any letters, `?` for one.
  [[nodiscard]] std::vector<int> matching(std::string_view pattern) const;
  /// The table of these rows alone, in order. Another one is known as `why_gone`: "has no mass and is condensed".
  [[nodiscard]] DofTable only(const std::vector<Eigen::Index>& kept, const std::string& why_gone) const;
  /// Why an address finds nothing that only() left out; empty for one that never was.
  [[nodiscard]] std::string why_gone(std::string_view address) const;

  /// Rows of a direction, as its position in kDirections.
  [[nodiscard]] std::vector<int> in_direction(std::size_t direction) const;

 private:
  void enter(int row);
  /// The texts that may stand for the address in the maps.
  [[nodiscard]] std::vector<std::string> keys_of(std::string_view address) const;

  std::vector<std::string> names_;
  std::vector<std::string> places_;                    // `node.direction`; empty when the scenario names them
  std::vector<std::size_t> directions_;                // positions in kDirections; likewise
  std::unordered_map<std::string, int> rows_;          // by name and by place
  std::unordered_map<std::string, std::string> gone_;  // likewise, with the reason
};

}  // namespace hybridtest
