#include "core/config_error.hpp"

#include <utility>

namespace hybridtest {
namespace {

std::string joined(const std::vector<ConfigIssue>& issues) {
  std::string text;
  for (const ConfigIssue& issue : issues) {
    if (!text.empty()) text += '\n';
    text += issue.text();
  }
  return text;
}

}  // namespace

std::string ConfigIssue::text() const {
  std::string place = file;
  for (const int number : {line, column}) {
    if (number <= 0) break;
    if (!place.empty()) place += ':';
    place += std::to_string(number);
  }
  return place.empty() ? what : place + ": " + what;
}

ConfigError::ConfigError(std::string what)
    : std::runtime_error{what}, issues_{ConfigIssue{.file = {}, .line = 0, .column = 0, .what = std::move(what)}} {}

ConfigError::ConfigError(std::vector<ConfigIssue> issues)
    : std::runtime_error{joined(issues)}, issues_{std::move(issues)} {}

}  // namespace hybridtest
