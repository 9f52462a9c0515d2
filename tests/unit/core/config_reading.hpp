#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/config/section.hpp"

namespace hybridtest::config {

/// Reads `yaml` as the file `test.yaml`; @return every error as it is shown.
inline std::vector<std::string> errors_of(const std::string& yaml, const std::function<void(Section)>& read,
                                          const std::vector<std::string>& overrides = {}) {
  std::vector<std::string> texts;
  try {
    Document document = Document::parse(yaml, "test.yaml", overrides);
    read(document.root());
    document.throw_if_errors();
  } catch (const ConfigError& error) {
    for (const ConfigIssue& issue : error.issues()) texts.push_back(issue.text());
  }
  return texts;
}

/// For what is refused before anything is read.
inline std::vector<std::string> errors_of(const std::string& yaml) {
  return errors_of(yaml, [](Section) {});
}

}  // namespace hybridtest::config
