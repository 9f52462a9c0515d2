#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/config/node.hpp"
#include "core/config/section.hpp"
#include "core/config/section_state.hpp"
#include "core/parameters/range.hpp"

namespace hybridtest::config {

/// `an integer from 1 to 4`.
[[nodiscard]] std::string expected_integer(std::int64_t low, std::int64_t high);

/// A small value inside the range, used to continue after an error.
[[nodiscard]] double usable(const Range& range) noexcept;
[[nodiscard]] std::int64_t usable(std::int64_t low, std::int64_t high) noexcept;

/// Reads single values of the tree of a section and reports errors. A refused node reads as
/// absent, without a further report.
class ValueReader {
 public:
  explicit ValueReader(SectionState& section) : section_{section} {}

  [[nodiscard]] std::optional<double> number(const Node& node, std::string_view path, const Range& range);
  [[nodiscard]] std::optional<std::int64_t> integer(const Node& node, std::string_view path, std::int64_t low,
                                                    std::int64_t high);
  [[nodiscard]] std::optional<bool> boolean(const Node& node, std::string_view path);
  /// @param expected   for messages, such as "a name".
  [[nodiscard]] std::optional<std::string> text(const Node& node, std::string_view path, std::string_view expected);
  /// A node of that kind, or a report and false.
  [[nodiscard]] bool is(Node::Kind kind, const Node& node, std::string_view path, std::string_view expected);

  /// `expected …, found …`, then the advice.
  void report_mismatch(const Node& node, std::string_view path, std::string_view expected,
                       std::string_view advice = {});

 private:
  SectionState& section_;
};

}  // namespace hybridtest::config
