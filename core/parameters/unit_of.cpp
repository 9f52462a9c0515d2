#include "core/parameters/unit_of.hpp"

#include <algorithm>
#include <map>
#include <span>
#include <vector>

namespace hybridtest {
namespace {

/// The words of a key that stand for a unit.
const std::map<std::string_view, std::string_view>& unit_words() {
  static const std::map<std::string_view, std::string_view> words{
      {"n", "N"},   {"m", "m"},   {"s", "s"},   {"kg", "kg"}, {"hz", "Hz"}, {"pa", "Pa"}, {"j", "J"},
      {"m2", "m²"}, {"m3", "m³"}, {"s2", "s²"}, {"s3", "s³"}, {"per", "/"}, {"min", ""},  {"max", ""}};
  return words;
}

std::string joined(std::span<const std::string> words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

}  // namespace

std::string unit_of(std::string_view name) {
  std::vector<std::string_view> words;
  for (std::size_t begin = 0; begin <= name.size();) {
    const std::size_t end = std::min(name.find('_', begin), name.size());
    words.push_back(name.substr(begin, end - begin));
    begin = end + 1;
  }
  // The name of the quantity is at least one word, so that the key `n` has no unit.
  auto first = words.end();
  while (first != words.begin() + 1 && unit_words().contains(*(first - 1))) --first;
  std::vector<std::string> above, below;
  bool is_below = false;
  for (; first != words.end(); ++first) {
    const std::string unit{unit_words().at(*first)};
    if (unit == "/") is_below = true;
    if (unit != "/" && !unit.empty()) (is_below ? below : above).push_back(unit);
  }
  if (below.empty()) return joined(above);
  const std::string divisor = below.size() == 1 ? below.front() : "(" + joined(below) + ")";
  return (above.empty() ? "1" : joined(above)) + "/" + divisor;
}

}  // namespace hybridtest
