#pragma once

#include <Eigen/SparseCore>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace hybridtest {

/// Largest side of a matrix that is read, so that a wrong size line cannot take the memory.
inline constexpr int kMaxMatrixMarketSize = 100'000;
/// Most entries of a file, an array's zeros among them; one takes 24 bytes while it is read.
inline constexpr std::int64_t kMaxMatrixMarketEntries = 50'000'000;

/// Reads a Matrix Market file (Boisvert, Pozo and Remington, NISTIR 5935, 1996): `coordinate` or
/// `array`, `real` or `integer`, `general` or `symmetric`. The format stores the lower triangle
/// of a symmetric matrix; the upper one is filled in. Entries that are zero are left out.
///
/// Stricter than the format where a slip would change the stiffness unnoticed: entries given
/// twice, entries above the diagonal of a symmetric matrix, numbers that are not finite, and
/// anything after the last entry are errors.
///
/// @throws ConfigError listing up to 20 lines that are wrong, each with what was expected; also
///         when the file cannot be read.
[[nodiscard]] Eigen::SparseMatrix<double> read_matrix_market(const std::filesystem::path& file);

/// The same from text; `name` stands for the file in messages.
[[nodiscard]] Eigen::SparseMatrix<double> parse_matrix_market(std::string_view text, const std::string& name);

}  // namespace hybridtest
