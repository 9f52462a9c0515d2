#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <string_view>
#include <vector>

// The pages of the tree: every code fence is closed, every relative link and anchor leads somewhere.
namespace hybridtest::architecture {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::IsEmpty;

/// Text by path from the root, `/` between folders.
using Pages = std::map<std::string, std::string>;

struct Line {
  int number = 0;
  std::string text;
};

/// A page without what stands in its code fences.
struct Prose {
  std::vector<Line> lines;
  int open_fence = 0;  // line of a fence that is never closed; 0: none
};

/// The number of equal fence characters that a line begins with, after at most three spaces; 0: no fence.
std::size_t fence_length(std::string_view line, char& character) {
  const std::size_t begin = line.find_first_not_of(' ');
  if (begin > 3) return 0;  // also where there is none
  character = line[begin];
  if (std::string_view{"`~"}.find(character) == std::string_view::npos) return 0;
  const std::size_t end = line.find_first_not_of(character, begin);
  const std::size_t length = (end == std::string_view::npos ? line.size() : end) - begin;
  return length >= 3 ? length : 0;
}

Prose prose_of(const std::string& text) {
  Prose prose;
  char fence = '`';
  std::size_t fence_size = 0;
  int number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string line = text.substr(begin, end - begin);
    begin = end + 1;
    ++number;
    char character = ' ';
    const std::size_t length = fence_length(line, character);
    if (prose.open_fence != 0) {
      const bool is_bare = line.find_last_not_of("`~ ") == std::string::npos;
      if (length >= fence_size && character == fence && is_bare) prose.open_fence = 0;
    } else if (length > 0) {
      prose.open_fence = number;
      fence = character;
      fence_size = length;
    } else {
      prose.lines.push_back({number, line});
    }
  }
  return prose;
}

/// What a heading is linked by: lower case, spaces to hyphens, other marks dropped, as GitHub does.
std::string anchor_of(std::string_view heading) {
  std::string anchor;
  for (const char character : heading) {
    const auto byte = static_cast<unsigned char>(character);
    if (std::isalnum(byte) != 0) {
      anchor += static_cast<char>(std::tolower(byte));
    } else if (character == ' ') {
      anchor += '-';
    } else if (character == '-' || character == '_' || byte >= 0x80) {
      anchor += character;
    }
  }
  return anchor;
}

std::set<std::string> anchors_of(const std::string& text) {
  static const std::regex heading{"^#{1,6} +(.*?) *$"};
  std::set<std::string> anchors;
  std::map<std::string, int> seen;
  for (const Line& line : prose_of(text).lines) {
    std::smatch match;
    if (!std::regex_match(line.text, match, heading)) continue;
    const std::string anchor = anchor_of(match[1].str());
    const int before = seen[anchor]++;
    anchors.insert(before == 0 ? anchor : anchor + "-" + std::to_string(before));
  }
  return anchors;
}

/// The targets of `[text](target)` and `![text](target)` in a line, without those in `code`.
std::vector<std::string> targets_in(const std::string& line) {
  static const std::regex code{"`[^`]*`"};
  static const std::regex link{R"(\]\(([^)\s]+)\))"};
  const std::string text = std::regex_replace(line, code, "`code`");
  std::vector<std::string> targets;
  for (std::sregex_iterator found{text.begin(), text.end(), link}, none; found != none; ++found) {
    targets.push_back((*found)[1].str());
  }
  return targets;
}

std::string place(const std::string& path, int line) { return path + ":" + std::to_string(line) + ": "; }

/// Everything wrong with the pages.
/// @param exists   whether a path from the root is a file or folder of the tree.
template <class Exists>
std::vector<std::string> faults_in(const Pages& pages, const Exists& exists) {
  std::vector<std::string> faults;
  for (const auto& [path, text] : pages) {
    const Prose prose = prose_of(text);
    if (prose.open_fence != 0) faults.push_back(place(path, prose.open_fence) + "this code fence is never closed");
    for (const Line& line : prose.lines) {
      if (std::regex_search(line.text, std::regex{"^#{1,6}[^# ]"})) {
        faults.push_back(place(path, line.number) + "a heading needs a space after #");
      }
      for (const std::string& target : targets_in(line.text)) {
        if (target.find(':') != std::string::npos) continue;  // another site
        const std::size_t hash = target.find('#');
        const std::string file = target.substr(0, hash);
        const std::string linked =
            file.empty() ? path : (fs::path{path}.parent_path() / file).lexically_normal().generic_string();
        if (!exists(linked)) {
          faults.push_back(place(path, line.number) + "no such file: " + target);
          continue;
        }
        if (hash == std::string::npos) continue;
        const auto page = pages.find(linked);
        if (page == pages.end() || !anchors_of(page->second).contains(target.substr(hash + 1))) {
          faults.push_back(place(path, line.number) + "no such heading: " + target);
        }
      }
    }
  }
  return faults;
}

Pages read_pages(const fs::path& root) {
  static constexpr std::array kNotOurs{"build", "runs", ".git", ".cache"};
  Pages pages;
  for (auto entry = fs::recursive_directory_iterator{root}; entry != fs::recursive_directory_iterator{}; ++entry) {
    if (entry.depth() == 0 && std::ranges::find(kNotOurs, entry->path().filename()) != kNotOurs.end()) {
      entry.disable_recursion_pending();
    } else if (entry->path().extension() == ".md") {
      std::ifstream file{entry->path()};
      pages[entry->path().lexically_relative(root).generic_string()] = {std::istreambuf_iterator<char>{file}, {}};
    }
  }
  return pages;
}

TEST(Markdown, FencesAreClosedAndLinksResolve) {
  const fs::path root{HYBRIDTEST_SOURCE_DIR};
  const Pages pages = read_pages(root);
  EXPECT_TRUE(pages.contains("README.md") && pages.contains("docs/scenario.md")) << "the pages were not read";
  const auto exists = [&](const std::string& path) { return fs::exists(root / path); };
  EXPECT_THAT(faults_in(pages, exists), IsEmpty());
}

TEST(Markdown, OpenFencesAndDeadLinksAreFound) {
  const Pages pages{{"README.md",
                     "# One\n\n[good](docs/guide.md#two-words), [bad](docs/gone.md), [bad](docs/guide.md#three)\n"
                     "`[code](nowhere.md)` [elsewhere](https://example.org/x.md) [here](#one)\n"},
                    {"docs/guide.md",
                     "#Squeezed\n## Two words\n```sh\n# [no link](gone.md)\n```\n[up](../README.md) [folder](figures)\n"
                     "~~~\n```\n~~~\n"},
                    {"docs/open.md", "text\n```yaml\nkey: 1\n#### Heading in code\n"}};
  const std::set<std::string> files{"README.md", "docs/guide.md", "docs/open.md"};
  EXPECT_THAT(
      faults_in(pages, [&](const std::string& path) { return files.contains(path); }),
      ElementsAre("README.md:3: no such file: docs/gone.md", "README.md:3: no such heading: docs/guide.md#three",
                  "docs/guide.md:1: a heading needs a space after #", "docs/guide.md:6: no such file: figures",
                  "docs/open.md:2: this code fence is never closed"));
}

TEST(Markdown, RepeatedHeadingsGetANumber) {
  EXPECT_THAT(anchors_of("# `A` title, here\n## Same\n## Same\n"), ElementsAre("a-title-here", "same", "same-1"));
}

/// The terms of the glossary, in their order, in lower case.
std::vector<std::string> terms_of(const std::string& glossary) {
  static const std::regex term{R"(^\*\*([^*]+)\*\*.*)"};
  std::vector<std::string> terms;
  for (const Line& line : prose_of(glossary).lines) {
    std::smatch match;
    if (!std::regex_match(line.text, match, term)) continue;
    std::string lower = match[1].str();
    std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    terms.push_back(lower);
  }
  return terms;
}

TEST(Markdown, GlossaryIsAlphabetical) {
  const std::vector<std::string> terms = terms_of(read_pages(HYBRIDTEST_SOURCE_DIR).at("docs/glossary.md"));
  EXPECT_GE(terms.size(), 50U) << "the glossary was not read";
  EXPECT_TRUE(std::ranges::is_sorted(terms));
  EXPECT_THAT(terms_of("**Step** — one\n\n**delay** — two\n"), ElementsAre("step", "delay"));
}

}  // namespace
}  // namespace hybridtest::architecture
