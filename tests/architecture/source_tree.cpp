#include "tests/architecture/source_tree.hpp"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>
#include <regex>
#include <sstream>

namespace hybridtest::architecture {
namespace {

/// Where the comment or literal that begins at `begin` ends; `begin` itself when none does.
std::size_t end_of_blank(std::string_view text, std::size_t begin) {
  const auto end_after = [&](std::string_view mark, std::size_t from) {
    const std::size_t found = text.find(mark, from);
    return found == std::string_view::npos ? text.size() : found + mark.size();
  };
  const std::string_view rest = text.substr(begin);
  if (rest.starts_with("//")) return std::min(text.find('\n', begin), text.size());
  if (rest.starts_with("/*")) return end_after("*/", begin + 2);
  if (rest.starts_with("R\"")) {
    const std::size_t open = text.find('(', begin);
    if (open == std::string_view::npos) return text.size();
    return end_after(")" + std::string{text.substr(begin + 2, open - begin - 2)} + "\"", open);
  }
  // A quote between digits separates them.
  const bool is_separator = begin > 0 && std::isalnum(static_cast<unsigned char>(text[begin - 1])) != 0;
  if (rest.front() != '"' && (rest.front() != '\'' || is_separator)) return begin;
  std::size_t end = begin + 1;
  while (end < text.size() && text[end] != rest.front() && text[end] != '\n') end += text[end] == '\\' ? 2 : 1;
  return std::min(end + 1, text.size());
}

}  // namespace

bool is_output(const std::filesystem::path& directory, int depth) {
  const std::string name = directory.filename().string();
  return name.starts_with('.') || name == "__pycache__" || (depth == 0 && (name == "build" || name == "runs"));
}

std::vector<SourceFile> read_sources(const std::filesystem::path& root) {
  std::vector<SourceFile> files;
  for (auto entry = std::filesystem::recursive_directory_iterator{root};
       entry != std::filesystem::recursive_directory_iterator{}; ++entry) {
    if (entry->is_directory() && is_output(entry->path(), entry.depth())) entry.disable_recursion_pending();
    const std::filesystem::path extension = entry->path().extension();
    if (!entry->is_regular_file() || (extension != ".hpp" && extension != ".cpp")) continue;
    std::ifstream stream{entry->path()};
    std::ostringstream text;
    text << stream.rdbuf();
    files.push_back({entry->path().lexically_relative(root).generic_string(), text.str()});
  }
  std::ranges::sort(files, {}, &SourceFile::path);
  return files;
}

std::vector<std::string> included_by(std::string_view text) {
  static const std::regex kDirective{R"(^\s*#\s*include\b)"};
  std::vector<std::string> included;
  const std::string code = code_alone(text);
  for (std::size_t line = 0; line < text.size();) {
    const std::size_t end = std::min(text.find('\n', line), text.size());
    // The directive must be code; its target may be a string and is read from the text itself.
    std::smatch directive;
    const std::string code_line = code.substr(line, end - line);
    if (std::regex_search(code_line, directive, kDirective)) {
      const std::size_t open = text.find_first_of("<\"\n", line + static_cast<std::size_t>(directive.length()));
      const std::size_t close = open < end ? text.find_first_of(">\"\n", open + 1) : end;
      if (close < end) included.emplace_back(text.substr(open + 1, close - open - 1));
    }
    line = end + 1;
  }
  return included;
}

std::string code_alone(std::string_view text) {
  std::string code{text};
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t end = end_of_blank(text, i);
    if (end == i) {
      ++i;
      continue;
    }
    std::replace_if(
        code.begin() + static_cast<std::ptrdiff_t>(i), code.begin() + static_cast<std::ptrdiff_t>(end),
        [](char c) { return c != '\n'; }, ' ');
    i = end;
  }
  return code;
}

}  // namespace hybridtest::architecture
