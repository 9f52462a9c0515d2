#include "mechanics/structure/matrix_market.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "core/config_error.hpp"
#include "core/random.hpp"

namespace hybridtest {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Eigen::MatrixXd parse(const std::string& text) { return Eigen::MatrixXd{parse_matrix_market(text, "k.mtx")}; }

std::vector<std::string> issues(const std::string& text) {
  std::vector<std::string> texts;
  try {
    static_cast<void>(parse(text));
  } catch (const ConfigError& error) {
    for (const ConfigIssue& issue : error.issues()) texts.push_back(issue.text());
  }
  return texts;
}

// The example of the format's description: 5 x 5, unsymmetric, with comments.
const std::string kGeneral =
    "%%MatrixMarket matrix coordinate real general\n"
    "% a comment\n"
    "%\n"
    "  5  5  8\n"
    "    1     1   1.000e+00\n"
    "    2     2   1.050e+01\n"
    "    3     3   1.500e-02\n"
    "    1     4   6.000e+00\n"
    "    4     2   2.505e+02\n"
    "    4     4  -2.800e+02\n"
    "    4     5   3.332e+01\n"
    "    5     5   1.200e+01\n";

TEST(MatrixMarket, ReadsTheExampleOfTheFormat) {
  const Eigen::MatrixXd expected{{1.0, 0.0, 0.0, 6.0, 0.0},
                                 {0.0, 10.5, 0.0, 0.0, 0.0},
                                 {0.0, 0.0, 0.015, 0.0, 0.0},
                                 {0.0, 250.5, 0.0, -280.0, 33.32},
                                 {0.0, 0.0, 0.0, 0.0, 12.0}};
  EXPECT_EQ(parse(kGeneral), expected);
}

TEST(MatrixMarket, FillsTheUpperTriangleOfASymmetricMatrix) {
  const Eigen::MatrixXd expected{{4.0e6, -3.0e6}, {-3.0e6, 3.0e6}};
  EXPECT_EQ(parse("%%MatrixMarket matrix coordinate real symmetric\n2 2 3\n1 1 4.0e6\n2 1 -3e6\n2 2 +3.0E+06\n"),
            expected);
  EXPECT_EQ(parse("%%MatrixMarket matrix array real symmetric\n2 2\n4.0e6\n-3.0e6\n3.0e6\n"), expected);
}

TEST(MatrixMarket, ReadsArraysColumnByColumn) {
  EXPECT_EQ(parse("%%MatrixMarket matrix array integer general\n2 3\n1\n2\n3\n4\n5\n-6\n"),
            (Eigen::MatrixXd{{1.0, 3.0, 5.0}, {2.0, 4.0, -6.0}}));
}

TEST(MatrixMarket, AcceptsCommonFileVariants) {
  // Upper case, carriage returns, tabs, blank lines, no final newline.
  EXPECT_EQ(parse("%%MATRIXMARKET Matrix Coordinate Integer General\r\n\r\n1\t1 1\r\n\r\n1 1 7"),
            (Eigen::MatrixXd{{7.0}}));
  EXPECT_EQ(parse("%%MatrixMarket matrix coordinate real general\n2 1 0\n"), (Eigen::MatrixXd{{0.0}, {0.0}}));
}

TEST(MatrixMarket, ReportsErrorsOfFirstLine) {
  EXPECT_THAT(issues(""), ElementsAre(HasSubstr("empty")));
  EXPECT_THAT(issues("1 1 1\n1 1 1\n"), ElementsAre(HasSubstr("k.mtx:1: found '1 1 1'; expected '%%MatrixMarket")));
  EXPECT_THAT(
      issues("%%MatrixMarket matrix coordinate complex hermitian\n1 1 1\n"),
      ElementsAre("k.mtx:1: 'complex' is not read: the matrices of a structure are real; expected integer or real",
                  "k.mtx:1: 'hermitian' is not read: the matrices of a structure are real; expected symmetric "
                  "or general"));
  EXPECT_THAT(issues("%%MatrixMarket matrix coordinate pattern skew-symmetric\n1 1 1\n"),
              ElementsAre("k.mtx:1: 'pattern' is not read: it has places without values; expected integer or real",
                          "k.mtx:1: 'skew-symmetric' is not read: mass, damping and stiffness are symmetric; expected "
                          "symmetric or general"));
  EXPECT_THAT(issues("%%MatrixMarket matrix sparse real general\n1 1 1\n"),
              ElementsAre("k.mtx:1: 'sparse' is not read; expected coordinate or array"));
}

TEST(MatrixMarket, ReportsErrorsOfSizeLine) {
  const std::string banner = "%%MatrixMarket matrix coordinate real symmetric\n% comment\n";
  EXPECT_THAT(issues(banner), ElementsAre(HasSubstr("k.mtx:2: the file ends here")));
  EXPECT_THAT(issues(banner + "2 2\n"), ElementsAre(HasSubstr("k.mtx:3: found '2 2'; expected the numbers of rows")));
  EXPECT_THAT(issues(banner + "2 3 1\n"), ElementsAre(HasSubstr("as many columns as rows")));
  EXPECT_THAT(issues(banner + "2 2 4\n"), ElementsAre("k.mtx:3: '4' entries; expected an integer from 0 to 3"));
  EXPECT_THAT(issues(banner + "0 2000000 1\n"),
              ElementsAre("k.mtx:3: '0' rows; expected an integer from 1 to 100000",
                          "k.mtx:3: '2000000' columns; expected an integer from 1 to 100000"));
  EXPECT_THAT(issues(banner + "99999999999999999999 2 1\n"), ElementsAre(HasSubstr("rows")));
}

TEST(MatrixMarket, ListsEveryWrongEntryAtOnce) {
  EXPECT_THAT(
      issues("%%MatrixMarket matrix coordinate real symmetric\n"
             "3 3 6\n"
             "1 1 1e400\n"
             "1 2 5.0\n"
             "4 1 5.0\n"
             "2 2 inf\n"
             "3 3\n"
             "2 1 0x10\n"
             "2 2 1 oops\n"),
      ElementsAre(
          "k.mtx:3: '1e400'; expected a finite decimal number",
          "k.mtx:4: an entry above the diagonal of a symmetric matrix; expected the lower triangle alone",
          "k.mtx:5: '4' row; expected an integer from 1 to 3", "k.mtx:6: 'inf'; expected a finite decimal number",
          "k.mtx:7: found '3 3'; expected row, column and value", "k.mtx:8: '0x10'; expected a finite decimal number",
          "k.mtx:9: found '2 2 1 oops' after the last entry; expected the end of the file"));
}

TEST(MatrixMarket, RejectsDuplicateEntry) {
  EXPECT_THAT(issues("%%MatrixMarket matrix coordinate real general\n2 2 2\n1 2 5\n1 2 5\n"),
              ElementsAre("k.mtx:4: row and column were given in line 3 already; expected each entry once"));
}

TEST(MatrixMarket, ListsDuplicatesInTheOrderOfLines) {
  EXPECT_THAT(issues("%%MatrixMarket matrix coordinate real symmetric\n3 3 5\n3 2 5\n1 1 0\n2 1 x\n3 2 0\n1 1 1\n"),
              ElementsAre("k.mtx:5: 'x'; expected a finite decimal number",
                          "k.mtx:6: row and column were given in line 3 already; expected each entry once",
                          "k.mtx:7: row and column were given in line 4 already; expected each entry once"));
}

TEST(MatrixMarket, RejectsArraysOfTooManyEntries) {
  EXPECT_THAT(issues("%%MatrixMarket matrix array real general\n10000 10000\n1\n"),
              ElementsAre("k.mtx:2: an array of 100000000 entries; expected at most 50000000: write the matrix as "
                          "coordinate"));
}

TEST(MatrixMarket, ReadsAMillionEntriesInAnyOrder) {
  constexpr int kSize = 10'000;
  constexpr int kBand = 100;
  std::string text = "%%MatrixMarket matrix coordinate real symmetric\n10000 10000 995050\n";
  for (int row = kSize; row >= 1; --row) {
    for (int column = std::max(1, row - kBand + 1); column <= row; ++column) {
      text += std::to_string(row) + ' ' + std::to_string(column) + ' ' + std::to_string(row - column + 1) + ".5\n";
    }
  }
  const Eigen::SparseMatrix<double> matrix = parse_matrix_market(text, "k.mtx");
  EXPECT_EQ(matrix.rows(), kSize);
  EXPECT_EQ(matrix.nonZeros(), 2 * 995'050 - kSize);
  EXPECT_TRUE(matrix.isCompressed());
  EXPECT_EQ(matrix.coeff(4999, 4900), 100.5);
  EXPECT_EQ(matrix.coeff(4900, 4999), 100.5);
  EXPECT_EQ(matrix.coeff(4900, 5000), 0.0);
}

TEST(MatrixMarket, LeavesOutZeros) {
  EXPECT_EQ(parse_matrix_market("%%MatrixMarket matrix array real general\n2 2\n1\n0\n0\n2\n", "k.mtx").nonZeros(), 2);
}

TEST(MatrixMarket, RejectsMissingEntries) {
  EXPECT_THAT(issues("%%MatrixMarket matrix coordinate real general\n2 2 2\n1 2 5\n"),
              ElementsAre("k.mtx:3: the file ends after 1 entries; expected 2"));
  EXPECT_THAT(
      issues("%%MatrixMarket matrix array real general\n2 2\n1\n2\n3 4\n"),
      ElementsAre("k.mtx:5: found '3 4'; expected one value", "k.mtx:5: the file ends after 3 entries; expected 4"));
}

TEST(MatrixMarket, RejectsRealsInAnIntegerFile) {
  EXPECT_THAT(issues("%%MatrixMarket matrix array integer general\n1 1\n1.5\n"),
              ElementsAre("k.mtx:3: '1.5'; expected an integer"));
}

TEST(MatrixMarket, StopsListingAtTwenty) {
  std::string text = "%%MatrixMarket matrix array real general\n10 10\n";
  for (int i = 0; i < 100; ++i) text += "x\n";
  EXPECT_EQ(issues(text).size(), 20U);
}

TEST(MatrixMarket, RejectsFilesOfOtherFormats) {
  EXPECT_THROW(static_cast<void>(read_matrix_market("no_such_file.mtx")), ConfigError);
  EXPECT_THROW(static_cast<void>(read_matrix_market(".")), ConfigError);
}

/// Any text gives a matrix or a ConfigError, never anything else.
TEST(MatrixMarket, SurvivesDamagedText) {
  const std::vector<std::string> seeds = {
      kGeneral, "%%MatrixMarket matrix coordinate real symmetric\n2 2 3\n1 1 4.0e6\n2 1 -3e6\n2 2 3.0E+06\n",
      "%%MatrixMarket matrix array integer general\n2 3\n1\n2\n3\n4\n5\n-6\n"};
  const std::string alphabet = std::string{"0123456789-+.eE \t\n\r%x"} + '\0' + '\xff';
  Random random{1};
  int read = 0;
  for (int trial = 0; trial < 5000; ++trial) {
    std::string text = seeds[random.below(seeds.size())];
    for (std::uint64_t edits = 1 + random.below(4); edits > 0 && !text.empty(); --edits) {
      const std::size_t place = random.below(text.size());
      const char letter = alphabet[random.below(alphabet.size())];
      switch (random.below(4)) {
        case 0: text[place] = letter; break;
        case 1: text.insert(place, 1, letter); break;
        case 2: text.erase(place, 1); break;
        default: text.resize(place + 1); break;
      }
    }
    try {
      const Eigen::MatrixXd matrix = parse(text);
      ASSERT_TRUE(matrix.allFinite());
      ++read;
    } catch (const ConfigError& error) {
      ASSERT_THAT(error.issues(), testing::Not(IsEmpty()));
      ASSERT_GE(error.issues().front().line, 0);
    }
  }
  EXPECT_GT(read, 100);   // some damage is harmless
  EXPECT_LT(read, 4000);  // most is not
}

}  // namespace
}  // namespace hybridtest
