#include "launch/check_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string_view>

#include "core/config_error.hpp"

namespace hybridtest {
namespace {

std::string_view word(CheckVerdict verdict) {
  switch (verdict) {
    case CheckVerdict::pass: return "pass";
    case CheckVerdict::caution: return "caution";
    case CheckVerdict::fail: return "FAIL";
  }
  return "";
}

}  // namespace

void CheckReport::add(CheckVerdict verdict, std::string subject, std::string found, std::string change) {
  lines_.push_back({verdict, section_, std::move(subject), std::move(found), std::move(change)});
}

std::ptrdiff_t CheckReport::count(CheckVerdict verdict) const {
  return std::ranges::count(lines_, verdict, &CheckLine::verdict);
}

CheckVerdict CheckReport::worst() const {
  return lines_.empty() ? CheckVerdict::pass : std::ranges::max(lines_, {}, &CheckLine::verdict).verdict;
}

void CheckReport::print_section(std::FILE* out) const {
  for (const CheckLine& line : lines_) {
    if (line.section != section_) continue;
    fmt::print(out, "  {:<7}  {:<20} {}\n", word(line.verdict), line.subject, line.found);
    if (!line.change.empty()) fmt::print(out, "  {:<7}  {:<20}   -> {}\n", "", "", line.change);
  }
}

void CheckReport::print_verdict(std::FILE* out) const {
  const auto fails = count(CheckVerdict::fail);
  const auto cautions = count(CheckVerdict::caution);
  if (fails > 0) {
    fmt::print(out, "\nFAIL: {} line(s) fail, {} caution(s). Do not run this test with a specimen.\n", fails, cautions);
  } else if (cautions > 0) {
    fmt::print(out, "\ncaution: {} line(s) to look at before the test\n", cautions);
  } else {
    fmt::print(out, "\npass: {} lines\n", lines_.size());
  }
}

void CheckReport::write_json(const std::filesystem::path& file) const {
  using Json = nlohmann::ordered_json;
  Json lines = Json::array();
  for (const CheckLine& line : lines_) {
    lines.push_back({{"verdict", line.verdict == CheckVerdict::fail ? "fail" : word(line.verdict)},
                     {"section", line.section},
                     {"subject", line.subject},
                     {"found", line.found},
                     {"change", line.change}});
  }
  const Json document{{"schema", "hybridtest_check/1"},
                      {"test", test_},
                      {"verdict", worst() == CheckVerdict::fail ? "fail" : word(worst())},
                      {"lines", lines}};
  if (file == "-") {
    std::cout << document.dump(2) << '\n';
    return;
  }
  std::ofstream stream{file};
  stream << document.dump(2) << '\n';
  stream.close();
  if (!stream)
    throw ConfigError{"--json " + file.string() + ": cannot be written; expected a file in a folder that exists"};
}

}  // namespace hybridtest
