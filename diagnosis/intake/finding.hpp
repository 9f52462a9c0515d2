#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace hybridtest {

/// One thing wrong with a recording, by its place. Nothing of a recording is ever repaired.
struct IntakeFinding {
  std::size_t row = 0;       // line of the file, the header being 1; 0 when it belongs to no row
  std::string column;        // empty when it belongs to no column
  std::string value;         // as found; empty where there is none to show
  std::string what;          // what is wrong and what was expected
  std::size_t more = 0;      // rows further down with the same in the same column
  std::size_t last_row = 0;  // the last of them

  /// `FILE:ROW: column 'C': 'VALUE': WHAT (and in 12 more rows, the last 400)`
  [[nodiscard]] std::string text(const std::string& file) const;
};

/// Collects findings; the same kind in the same column becomes one finding that counts its rows.
class FindingList {
 public:
  void add(std::size_t row, const std::string& column, const std::string& value, const std::string& what);
  [[nodiscard]] bool empty() const noexcept { return findings_.empty(); }
  /// In the order of the rows, those without a row first; last, how many were too many to list.
  [[nodiscard]] std::vector<IntakeFinding> sorted() const;

 private:
  /// Of different kinds; a file with more is no recording at all.
  static constexpr std::size_t kMostListed = 50;

  std::vector<IntakeFinding> findings_;
  std::size_t left_out_ = 0;
};

}  // namespace hybridtest
