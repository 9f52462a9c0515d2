#include "report/run_report/scenario_differences.hpp"

#include <algorithm>
#include <sstream>

namespace hybridtest::run_report {
namespace {

std::vector<std::string> lines_of(std::string_view text) {
  std::vector<std::string> lines;
  std::istringstream stream{std::string{text}};
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// Column in which the content of a line of YAML begins, behind the dashes of lists.
std::size_t depth_of(std::string_view line) {
  const std::size_t at = line.find_first_not_of(" -");
  return at == std::string_view::npos ? line.size() : at;
}

/// The keys above line `at`, from the outermost; of a list, the first line of its entry (`id: storey_1`).
std::string keys_above(const std::vector<DiffLine>& lines, std::size_t at) {
  std::string path;
  std::size_t depth = depth_of(lines[at].text);
  for (std::size_t i = at; i-- > 0 && depth > 0;) {
    const std::string& line = lines[i].text;
    if (depth_of(line) >= depth || line.find_first_not_of(' ') == std::string::npos) continue;
    // A list entry `  - id: x` stands above its other keys at the same depth.
    depth = depth_of(line);
    const std::string key = line.substr(depth, line.find(':', depth) - depth);
    path.insert(0, path.empty() ? key : key + " > ");
  }
  return path;
}

/// `id: storey_1` of the list entry that a line belongs to, if there is one.
std::string entry_of(const std::vector<DiffLine>& lines, std::size_t at) {
  for (std::size_t i = at + 1; i-- > 0;) {
    const std::size_t id = lines[i].text.find("- id: ");
    if (id != std::string::npos) return depth_of(lines[at].text) > id ? lines[i].text.substr(id + 6) : "";
  }
  return "";
}

}  // namespace

std::vector<DiffLine> line_differences(std::string_view before, std::string_view after) {
  const std::vector<std::string> old_lines = lines_of(before);
  const std::vector<std::string> new_lines = lines_of(after);
  const std::size_t columns = new_lines.size() + 1;
  // Length of the longest common subsequence of what follows.
  std::vector<std::size_t> common((old_lines.size() + 1) * columns, 0);
  const auto length = [&](std::size_t i, std::size_t j) -> std::size_t& { return common[i * columns + j]; };
  for (std::size_t i = old_lines.size(); i-- > 0;) {
    for (std::size_t j = new_lines.size(); j-- > 0;) {
      length(i, j) =
          old_lines[i] == new_lines[j] ? length(i + 1, j + 1) + 1 : std::max(length(i + 1, j), length(i, j + 1));
    }
  }
  std::vector<DiffLine> lines;
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < old_lines.size() || j < new_lines.size()) {
    if (i < old_lines.size() && j < new_lines.size() && old_lines[i] == new_lines[j]) {
      lines.push_back({DiffLine::Kind::same, new_lines[j++]});
      ++i;
    } else if (i < old_lines.size() && (j == new_lines.size() || length(i + 1, j) >= length(i, j + 1))) {
      lines.push_back({DiffLine::Kind::removed, old_lines[i++]});
    } else {
      lines.push_back({DiffLine::Kind::added, new_lines[j++]});
    }
  }
  return lines;
}

std::vector<DiffLine> scenario_differences(std::string_view before, std::string_view after) {
  const std::vector<DiffLine> lines = line_differences(before, after);
  std::vector<DiffLine> differences;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines[i].kind == DiffLine::Kind::same) continue;
    const std::string entry = entry_of(lines, i);
    const std::string keys = keys_above(lines, i);
    std::string text = lines[i].text.substr(depth_of(lines[i].text));
    if (!keys.empty()) text.insert(0, keys + " > ");
    if (!entry.empty()) text.insert(0, entry + ": ");
    differences.push_back({lines[i].kind, std::move(text)});
  }
  return differences;
}

}  // namespace hybridtest::run_report
