#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/system_fixture.hpp"

/// The commands of the pages work as they are written. A shell block is run when its fence says so: "```sh run", or
/// "```sh run exit=3" where that exit code is the expected one. The blocks of a page are one session: they share
/// variables and a scratch directory, into which the folders of the checkout are linked.
namespace hybridtest {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

struct Block {
  int line = 0;  // of its first command
  std::string exit_code = "0";
  std::string commands;
};

std::vector<Block> runnable_blocks(const std::string& page) {
  static const std::regex kBegin{"```sh run(?: exit=([0-9]+))?"};
  std::vector<Block> blocks;
  std::istringstream lines{page};
  bool is_inside = false;
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    std::smatch begin;
    if (is_inside) {
      is_inside = line != "```";
      if (is_inside) blocks.back().commands += line + "\n";
    } else if (std::regex_match(line, begin, kBegin)) {
      is_inside = true;
      blocks.push_back({number + 1, begin[1].matched ? begin[1].str() : "0", {}});
    }
  }
  return blocks;
}

/// A block that must succeed runs in the session itself, so that the next blocks see its variables.
std::string script_of(const std::vector<Block>& blocks) {
  std::string script = std::string{"set -euo pipefail\nexport PATH='"} + HYBRIDTEST_PROGRAM_DIR + "':\"$PATH\"\n";
  for (const Block& block : blocks) {
    script += "echo " + std::to_string(block.line) + " >.line\n";
    if (block.exit_code == "0") {
      script += block.commands;
    } else {
      script += "set +e\n(\nset -e\n" + block.commands + ")\ncode=$?\nset -e\n[ $code -eq " + block.exit_code +
                " ] || { echo \"exit code $code, expected " + block.exit_code + "\" >&2; exit 1; }\n";
    }
  }
  return script;
}

class DocumentedCommands : public SystemTest {
 protected:
  /// Runs the marked blocks of a page. @return `page:line: what the shell said` of the first block that fails.
  [[nodiscard]] std::vector<std::string> failures(const std::string& page, const std::string& text) const {
    const std::vector<Block> blocks = runnable_blocks(text);
    if (blocks.empty()) return {};
    std::string name = page;
    std::ranges::replace(name, '/', '_');
    const std::filesystem::path scratch = directory() / name;
    std::filesystem::create_directory(scratch);
    for (const auto& entry : std::filesystem::directory_iterator{HYBRIDTEST_SOURCE_DIR}) {
      if (entry.is_directory()) std::filesystem::create_symlink(entry.path(), scratch / entry.path().filename());
    }
    const std::filesystem::path script = directory() / (name + ".sh");
    std::ofstream{script} << script_of(blocks);
    StartedProgram shell{"/bin/bash", {script.string()}, directory() / name, {.working_directory = scratch}};
    const auto exit_code = shell.wait(kPatience * static_cast<int>(blocks.size()));
    if (exit_code == 0) return {};
    std::string line = text_of(scratch / ".line");
    if (!line.empty()) line.pop_back();
    return {page + ":" + line + ": " + (exit_code ? shell.standard_error() : "still runs")};
  }
};

TEST_F(DocumentedCommands, WorkAsWritten) {
  std::size_t run = 0;
  const std::filesystem::path root = HYBRIDTEST_SOURCE_DIR;
  for (std::filesystem::recursive_directory_iterator entry{root}, end; entry != end; ++entry) {
    const std::string name = entry->path().filename().string();
    if (entry->is_directory() && (name.starts_with('.') || name == "build")) entry.disable_recursion_pending();
    if (entry->path().extension() != ".md") continue;
    const std::string page = entry->path().lexically_relative(root).string();
    const std::string text = text_of(entry->path());
    run += runnable_blocks(text).size();
    EXPECT_THAT(failures(page, text), IsEmpty());
  }
  EXPECT_GE(run, 3U) << "the first steps of README.md are marked";
}

// Control: a command that does not work is reported with its place.
TEST_F(DocumentedCommands, ControlFailingBlockIsReported) {
  const std::string first = "```sh run\nname=a\n```\ntext\n```sh\nexit 1\n```\n";
  EXPECT_THAT(failures("good.md",
                       first + "```sh run\ntest $name = a\n```\n```sh run exit=2\nhybridtest check gone.yaml\n```\n"),
              IsEmpty());
  EXPECT_THAT(failures("bad.md", first + "```sh run\nhybridtest check gone.yaml\n```\n"),
              ElementsAre(AllOf(HasSubstr("bad.md:9: "), HasSubstr("gone.yaml"))));
  EXPECT_THAT(failures("code.md", first + "```sh run exit=3\nhybridtest check gone.yaml\n```\n"),
              ElementsAre(AllOf(HasSubstr("code.md:9: "), HasSubstr("exit code 2, expected 3"))));
}

}  // namespace
}  // namespace hybridtest
