#include "core/text/indented.hpp"

#include <sstream>

namespace hybridtest {

std::string indented(std::string_view lines, std::string_view first, std::string_view others) {
  std::string text;
  std::istringstream stream{std::string{lines}};
  for (std::string line; std::getline(stream, line);) {
    if (!line.empty()) text.append(text.empty() ? first : others).append(line) += '\n';
  }
  return text;
}

}  // namespace hybridtest
