#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace hybridtest {

/// One thing wrong with a configuration.
struct ConfigIssue {
  std::string file;
  int line = 0;      // 1-based; 0 when the issue belongs to no line
  int column = 0;    // 1-based; 0 likewise
  std::string what;  // the value, what was expected, the nearest known name

  /// `file:line:column: what`, leaving out what is unknown.
  [[nodiscard]] std::string text() const;
};

/// Everything wrong with a configuration, found before anything moves.
/// Also thrown, without a place, by constructors that are handed parameters out of range.
class ConfigError : public std::runtime_error {
 public:
  explicit ConfigError(std::string what);
  explicit ConfigError(std::vector<ConfigIssue> issues);

  [[nodiscard]] const std::vector<ConfigIssue>& issues() const noexcept { return issues_; }

 private:
  std::vector<ConfigIssue> issues_;
};

}  // namespace hybridtest
