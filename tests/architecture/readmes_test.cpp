#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "tests/architecture/source_tree.hpp"

// Every folder's README is true. The rule, which keeps them short:
// - Every folder at the top level that holds sources has a README.md. A README answers for its folder and for those
// below it
//   that have none of their own.
// - It names, in backticks, every source file of its folder (`step_ledger`, `step_ledger.hpp`, or by a pattern:
//   `*_command.cpp`). A named subfolder (`laws/`) covers the files below it; each subfolder is named or has a README.
// - What it names as a file or folder exists: a name with a slash at its end or with the ending of a source.
namespace hybridtest::architecture {
namespace {

using testing::ElementsAre;

constexpr std::string_view kReadme = "README.md";

struct Tree {
  std::set<std::string> files;                 // by their path from the root
  std::map<std::string, std::string> readmes;  // text by folder; "" is the root
};

std::string folder_of(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  return slash == std::string::npos ? "" : path.substr(0, slash);
}

std::string path_in(const std::string& folder, const std::string& name) {
  return folder.empty() ? name : folder + "/" + name;
}

Tree read_tree(const std::filesystem::path& root) {
  Tree tree;
  for (auto entry = std::filesystem::recursive_directory_iterator{root};
       entry != std::filesystem::recursive_directory_iterator{}; ++entry) {
    if (entry->is_directory() && is_output(entry->path(), entry.depth())) entry.disable_recursion_pending();
    if (!entry->is_regular_file()) continue;
    const std::string path = entry->path().lexically_relative(root).generic_string();
    tree.files.insert(path);
    if (entry->path().filename() != kReadme) continue;
    std::ifstream stream{entry->path()};
    tree.readmes[folder_of(path)] = {std::istreambuf_iterator<char>{stream}, {}};
  }
  return tree;
}

/// What stands in backticks or is linked to, code blocks left out.
std::vector<std::string> named_in(const std::string& text) {
  static const std::regex kBlock{"```[\\s\\S]*?```"};
  static const std::regex kSpan{R"(`([^`\n]+)`|\]\(([^)#:]+)[^)]*\))"};
  const std::string prose = std::regex_replace(text, kBlock, "");
  std::vector<std::string> names;
  for (auto span = std::sregex_iterator{prose.begin(), prose.end(), kSpan}; span != std::sregex_iterator{}; ++span) {
    names.push_back((*span)[1].matched ? (*span)[1] : (*span)[2]);
  }
  return names;
}

/// `*` stands for any characters but a slash.
bool matches(std::string_view pattern, std::string_view name) {
  if (pattern.empty()) return name.empty();
  if (pattern.front() == '*') {
    for (std::size_t taken = 0; taken <= name.size(); ++taken) {
      if (matches(pattern.substr(1), name.substr(taken))) return true;
      if (taken < name.size() && name[taken] == '/') return false;
    }
    return false;
  }
  return !name.empty() && pattern.front() == name.front() && matches(pattern.substr(1), name.substr(1));
}

bool has_ending(std::string_view name, std::initializer_list<std::string_view> endings) {
  return std::ranges::any_of(endings, [&](std::string_view ending) { return name.ends_with(ending); });
}

/// Files that a README has to name. Tests are called after what they test.
bool is_source(std::string_view path) {
  const bool is_test = path.ends_with("_test.cpp") || path.find("/test_") != std::string_view::npos;
  if (path.ends_with(kReadme) || is_test) return false;
  return has_ending(path, {".hpp", ".cpp", ".py", ".idl", ".tcl"}) ||
         (path.starts_with("docs/") && path.ends_with(".md"));
}

/// @param relative   path of a file from the folder of the README.
bool names(std::string name, const std::string& relative) {
  if (name.ends_with('/')) name.pop_back();
  const std::string without_ending = relative.substr(0, relative.rfind('.'));
  if (matches(name, relative) || matches(name, without_ending)) return true;
  // A folder above the file.
  for (std::string folder = folder_of(relative); !folder.empty(); folder = folder_of(folder)) {
    if (matches(name, folder)) return true;
  }
  return false;
}

bool claims_to_exist(const std::string& name) {
  static const std::regex kName{R"([A-Za-z0-9_*][A-Za-z0-9_.*/-]*)"};
  return std::regex_match(name, kName) &&
         has_ending(name, {"/", ".hpp", ".cpp", ".py", ".idl", ".tcl", ".md", ".AT2", ".cmake"});
}

/// From the README's folder, from the root, or anywhere below the README.
bool exists(const Tree& tree, const std::string& readme_folder, std::string name) {
  if (name.ends_with('/')) name.pop_back();
  const auto is_named = [&](const std::string& path) {
    if (matches(path_in(readme_folder, name), path) || matches(name, path)) return true;
    if (!readme_folder.empty() && !path.starts_with(readme_folder + "/")) return false;
    for (std::size_t slash = path.find('/'); slash != std::string::npos; slash = path.find('/', slash + 1)) {
      if (matches(name, path.substr(slash + 1))) return true;
    }
    return false;
  };
  return std::ranges::any_of(tree.files, [&](const std::string& file) {
    for (std::string path = file; !path.empty(); path = folder_of(path)) {
      if (is_named(path)) return true;
    }
    return false;
  });
}

std::string readme_for(const Tree& tree, std::string folder) {
  while (!folder.empty() && !tree.readmes.contains(folder)) folder = folder_of(folder);
  return folder;
}

std::vector<std::string> findings(const Tree& tree) {
  std::map<std::string, std::vector<std::string>> named;
  for (const auto& [folder, text] : tree.readmes) named[folder] = named_in(text);
  std::vector<std::string> found;
  for (const std::string& file : tree.files) {
    if (!is_source(file) || folder_of(file).empty()) continue;
    const std::string folder = readme_for(tree, folder_of(file));
    if (folder.empty()) {
      found.push_back(file + ": no README answers for it");
      continue;
    }
    const std::string relative = file.substr(folder.size() + 1);
    if (std::ranges::none_of(named[folder], [&](const std::string& name) { return names(name, relative); })) {
      found.push_back(path_in(folder, std::string{kReadme}) + " does not name " + relative);
    }
  }
  for (const auto& [folder, its_names] : named) {
    for (const std::string& name : its_names) {
      if (!claims_to_exist(name) || exists(tree, folder, name)) continue;
      found.push_back(path_in(folder, std::string{kReadme}) + " names " + name + ", which does not exist");
    }
  }
  return found;
}

TEST(Readmes, NameEveryFileAndOnlyFilesThatExist) {
  const Tree tree = read_tree(HYBRIDTEST_SOURCE_DIR);
  ASSERT_GT(tree.readmes.size(), 20U) << "the READMEs were not read";
  std::string lines;
  for (const std::string& finding : findings(tree)) lines += finding + "\n";
  EXPECT_EQ(lines, "");
}

TEST(Readmes, MissingAndStaleNamesAreReported) {
  Tree tree;
  tree.files = {"a/README.md",       "a/step.hpp",         "a/step.cpp", "a/left_out.cpp",
                "a/run_command.cpp", "a/laws/elastic.hpp", "a/x/y.hpp",  "b/thing.hpp",
                "a/own/README.md",   "a/own/inside.cpp",   "top.cpp"};
  tree.readmes["a"] =
      "`step`, `*_command.cpp`, `laws/`, `gone.hpp`, `gone/`, `a/step.hpp`, `summary.json`, `--flag`\n"
      "```\n`left_out`\n```\n";
  tree.readmes["a/own"] = "`inside.cpp` and left_out\n";
  EXPECT_THAT(findings(tree),
              ElementsAre("a/README.md does not name left_out.cpp", "a/README.md does not name x/y.hpp",
                          "b/thing.hpp: no README answers for it", "a/README.md names gone.hpp, which does not exist",
                          "a/README.md names gone/, which does not exist"));
}

}  // namespace
}  // namespace hybridtest::architecture
