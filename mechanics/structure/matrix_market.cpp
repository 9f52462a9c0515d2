#include "mechanics/structure/matrix_market.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "core/config_error.hpp"
#include "core/input_file.hpp"
#include "core/text/scalar.hpp"
#include "core/text/shown.hpp"

namespace hybridtest {
namespace {

constexpr std::size_t kMaxIssues = 20;
constexpr std::size_t kMaxFileSize = 1U << 30U;

using Words = std::vector<std::string_view>;

/// Keeps the memory of `words`: a file has millions of lines.
void split(std::string_view line, Words& words) {
  constexpr std::string_view kBlank = " \t\r\f\v";
  words.clear();
  while (true) {
    const std::size_t begin = line.find_first_not_of(kBlank);
    if (begin == std::string_view::npos) return;
    line.remove_prefix(begin);
    const std::size_t length = std::min(line.find_first_of(kBlank), line.size());
    words.push_back(line.substr(0, length));
    line.remove_prefix(length);
  }
}

bool is_word(std::string_view word, std::string_view lower_case) {
  return std::equal(word.begin(), word.end(), lower_case.begin(), lower_case.end(),
                    [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b; });
}

struct Banner {
  bool is_coordinate = false;
  bool is_integer = false;
  bool is_symmetric = false;
};

/// A kind of the format that is no matrix of a structure, and why.
struct OtherKind {
  std::string_view word;
  std::string_view why;
};
constexpr std::array kOtherKinds{OtherKind{"pattern", "it has places without values"},
                                 OtherKind{"complex", "the matrices of a structure are real"},
                                 OtherKind{"skew-symmetric", "mass, damping and stiffness are symmetric"},
                                 OtherKind{"hermitian", "the matrices of a structure are real"}};

/// One entry, as Eigen takes it, and where it was given.
struct Entry {
  int at_row = 0;
  int at_column = 0;
  int line = 0;
  double number = 0.0;

  [[nodiscard]] int row() const noexcept { return at_row; }
  [[nodiscard]] int col() const noexcept { return at_column; }
  [[nodiscard]] double value() const noexcept { return number; }
};

class MatrixMarketParser {
 public:
  MatrixMarketParser(std::string_view text, const std::string& name) : left_{text}, name_{name} {}

  [[nodiscard]] Eigen::SparseMatrix<double> parse() {
    read_banner();
    read_size();
    if (banner_.is_coordinate) {
      read_coordinates();
    } else {
      read_array();
    }
    if (next_line()) report("found '" + shown(line_) + "' after the last entry; expected the end of the file");
    report_duplicates();
    throw_if_issues();
    return matrix();
  }

 private:
  /// The next line that is not blank. @return false at the end of the text.
  bool next_line() {
    while (!left_.empty()) {
      const std::size_t length = std::min(left_.find('\n'), left_.size());
      line_ = left_.substr(0, length);
      left_.remove_prefix(std::min(length + 1, left_.size()));
      ++line_number_;
      split(line_, words_);
      if (!words_.empty()) return true;
    }
    return false;
  }

  void report(std::string what) {
    issues_.push_back({.file = name_, .line = line_number_, .column = 0, .what = std::move(what)});
    if (issues_.size() == kMaxIssues) throw ConfigError{std::move(issues_)};
  }

  [[noreturn]] void fail(std::string what) {
    issues_.push_back({.file = name_, .line = line_number_, .column = 0, .what = std::move(what)});
    throw ConfigError{std::move(issues_)};
  }

  void throw_if_issues() {
    if (!issues_.empty()) throw ConfigError{std::move(issues_)};
  }

  bool choose(std::size_t word, std::string_view if_true, std::string_view if_false) {
    if (is_word(words_[word], if_true)) return true;
    if (is_word(words_[word], if_false)) return false;
    const auto* const other =
        std::ranges::find_if(kOtherKinds, [&](const OtherKind& kind) { return is_word(words_[word], kind.word); });
    const std::string why = other == kOtherKinds.end() ? "" : ": " + std::string{other->why};
    report("'" + shown(words_[word]) + "' is not read" + why + "; expected " + std::string{if_true} + " or " +
           std::string{if_false});
    return false;
  }

  void read_banner() {
    constexpr const char* kExpected =
        "expected '%%MatrixMarket matrix', then coordinate or array, real or integer, general or symmetric";
    if (!next_line()) fail(std::string{"the file is empty; "} + kExpected);
    if (line_number_ != 1 || words_.size() != 5 || !is_word(words_[0], "%%matrixmarket") ||
        !is_word(words_[1], "matrix")) {
      fail("found '" + shown(line_) + "'; " + kExpected + " in the first line");
    }
    banner_.is_coordinate = choose(2, "coordinate", "array");
    banner_.is_integer = choose(3, "integer", "real");
    banner_.is_symmetric = choose(4, "symmetric", "general");
    throw_if_issues();
  }

  void read_size() {
    const std::string expected = banner_.is_coordinate ? "expected the numbers of rows, columns and entries"
                                                       : "expected the numbers of rows and columns";
    do {
      if (!next_line()) fail("the file ends here; " + expected);
    } while (words_[0].front() == '%');
    if (words_.size() != (banner_.is_coordinate ? 3U : 2U)) fail("found '" + shown(line_) + "'; " + expected);
    rows_ = read_count(0, 1, kMaxMatrixMarketSize, "rows");
    columns_ = read_count(1, 1, kMaxMatrixMarketSize, "columns");
    throw_if_issues();
    if (banner_.is_symmetric && rows_ != columns_) fail("a symmetric matrix; expected as many columns as rows");
    const std::int64_t all = banner_.is_symmetric ? rows_ * (rows_ + 1) / 2 : rows_ * columns_;
    entries_ = banner_.is_coordinate ? read_count(2, 0, std::min(all, kMaxMatrixMarketEntries), "entries") : all;
    if (entries_ > kMaxMatrixMarketEntries) {
      report("an array of " + std::to_string(entries_) + " entries; expected at most " +
             std::to_string(kMaxMatrixMarketEntries) + ": write the matrix as coordinate");
    }
    throw_if_issues();
  }

  std::int64_t read_count(std::size_t word, std::int64_t low, std::int64_t high, const char* what) {
    const Whole whole = read_whole(words_[word]);
    if (whole.form == NumberForm::number && whole.value >= low && whole.value <= high) return whole.value;
    report("'" + shown(words_[word]) + "' " + what + "; expected an integer from " + std::to_string(low) + " to " +
           std::to_string(high));
    return low;
  }

  std::optional<double> read_value(std::string_view word) {
    if (banner_.is_integer) {
      const Whole whole = read_whole(word);
      if (whole.form == NumberForm::number) return static_cast<double>(whole.value);
      report("'" + shown(word) + "'; expected an integer");
      return std::nullopt;
    }
    const Real real = read_real(word);
    if (real.form == NumberForm::number) return real.value;
    report("'" + shown(word) + "'; expected a finite decimal number");
    return std::nullopt;
  }

  /// The next line that holds an entry. @return false at the end, which is reported.
  bool next_entry(std::int64_t found, std::size_t word_count, const char* expected) {
    if (!next_line()) {
      report("the file ends after " + std::to_string(found) + " entries; expected " + std::to_string(entries_));
      return false;
    }
    if (words_.size() == word_count) return true;
    report("found '" + shown(line_) + "'; expected " + expected);
    words_.clear();
    return true;
  }

  void read_coordinates() {
    for (std::int64_t i = 0; i < entries_; ++i) {
      if (!next_entry(i, 3, "row, column and value")) return;
      if (!words_.empty()) read_coordinate();
    }
  }

  void read_coordinate() {
    const std::size_t issues_before = issues_.size();
    const std::int64_t row = read_count(0, 1, rows_, "row") - 1;
    const std::int64_t column = read_count(1, 1, columns_, "column") - 1;
    const std::optional<double> value = read_value(words_[2]);
    if (issues_.size() != issues_before) return;
    if (banner_.is_symmetric && row < column) {
      report("an entry above the diagonal of a symmetric matrix; expected the lower triangle alone");
      return;
    }
    keep(row, column, *value);
  }

  void read_array() {
    std::int64_t found = 0;
    for (std::int64_t column = 0; column < columns_; ++column) {
      for (std::int64_t row = banner_.is_symmetric ? column : 0; row < rows_; ++row, ++found) {
        if (!next_entry(found, 1, "one value")) return;
        if (words_.empty()) continue;
        const std::optional<double> value = read_value(words_[0]);
        if (value && *value != 0.0) keep(row, column, *value);
      }
    }
  }

  void keep(std::int64_t row, std::int64_t column, double value) {
    kept_.push_back({static_cast<int>(row), static_cast<int>(column), line_number_, value});
  }

  /// Sorts the entries; issues stay in the order of lines.
  void report_duplicates() {
    const auto in_order = [](const Entry& a, const Entry& b) {
      return std::tie(a.at_column, a.at_row, a.line) < std::tie(b.at_column, b.at_row, b.line);
    };
    if (!std::ranges::is_sorted(kept_, in_order)) std::ranges::sort(kept_, in_order);
    for (std::size_t i = 1; i < kept_.size() && issues_.size() < kMaxIssues; ++i) {
      const Entry& before = kept_[i - 1];
      if (before.row() != kept_[i].row() || before.col() != kept_[i].col()) continue;
      issues_.push_back({.file = name_,
                         .line = kept_[i].line,
                         .column = 0,
                         .what = "row and column were given in line " + std::to_string(before.line) +
                                 " already; expected each entry once"});
    }
    std::ranges::stable_sort(issues_, {}, &ConfigIssue::line);
  }

  [[nodiscard]] Eigen::SparseMatrix<double> matrix() {
    std::erase_if(kept_, [](const Entry& entry) { return entry.number == 0.0; });
    if (banner_.is_symmetric) {
      const std::size_t lower = kept_.size();
      for (std::size_t i = 0; i < lower; ++i) {
        const Entry entry = kept_[i];
        if (entry.at_row != entry.at_column) kept_.push_back({entry.at_column, entry.at_row, entry.line, entry.number});
      }
    }
    Eigen::SparseMatrix<double> matrix(rows_, columns_);
    matrix.setFromTriplets(kept_.begin(), kept_.end());
    return matrix;
  }

  std::string_view left_;
  const std::string& name_;
  std::string_view line_;
  int line_number_ = 0;
  Words words_;
  std::vector<ConfigIssue> issues_;
  Banner banner_;
  std::int64_t rows_ = 0;
  std::int64_t columns_ = 0;
  std::int64_t entries_ = 0;
  std::vector<Entry> kept_;
};

}  // namespace

Eigen::SparseMatrix<double> read_matrix_market(const std::filesystem::path& file) {
  return parse_matrix_market(read_input_file(file, kMaxFileSize, "a Matrix Market file"), file.string());
}

Eigen::SparseMatrix<double> parse_matrix_market(std::string_view text, const std::string& name) {
  return MatrixMarketParser{text, name}.parse();
}

}  // namespace hybridtest
