#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace hybridtest::architecture {

/// A source or header, by its path from the root of the repository.
struct SourceFile {
  std::string path;
  std::string text;
};

/// What is built or recorded in the tree, and hidden folders. @param depth   0 for a folder of the root.
[[nodiscard]] bool is_output(const std::filesystem::path& directory, int depth);

/// Every .hpp and .cpp below the folders of the root; not what is built or recorded there.
[[nodiscard]] std::vector<SourceFile> read_sources(const std::filesystem::path& root);

/// What the file includes: `<…>` and `"…"` without their brackets, in order. Commented-out ones
/// do not count.
[[nodiscard]] std::vector<std::string> included_by(std::string_view text);

/// The text with comments, strings and characters blanked out; lines keep their numbers.
[[nodiscard]] std::string code_alone(std::string_view text);

}  // namespace hybridtest::architecture
