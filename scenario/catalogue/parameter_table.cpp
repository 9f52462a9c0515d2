#include "scenario/catalogue/parameter_table.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/parameters/unit_of.hpp"
#include "core/text/scalar.hpp"

namespace hybridtest {
namespace {

constexpr const char* kRequired = "—";

}  // namespace

std::string cell(std::string_view words) {
  std::string escaped;
  for (const char letter : words) {
    if (letter == '|') escaped += '\\';
    escaped += letter;
  }
  return escaped;
}

std::string table_head(std::string_view first) {
  return "| " + std::string{first} +
         " | key | unit | what | values | default |\n| --- | --- | --- | --- | --- | --- |\n";
}

std::string ParameterTable::lines(std::string first) const {
  if (rows_.empty()) return "| " + first + " | | | | | |\n";
  std::string text;
  for (const Row& row : rows_) {
    text += "| " + first + " | `" + row.key + "` | " + row.unit + " | " + cell(row.what) + " | " + cell(row.values) +
            " | " + row.fallback + " |\n";
    first.clear();
  }
  return text;
}

void ParameterTable::add(std::string_view key, const ParameterRule& rule, std::string fallback) {
  rows_.push_back({.key = std::string{key},
                   .unit = rule.unit.empty() ? unit_of(key) : std::string{rule.unit},
                   .what = std::string{rule.what},
                   .values = rule.values.empty() ? values_in(rule.range) : std::string{rule.values},
                   .fallback = std::move(fallback)});
}

void ParameterTable::number(std::string_view key, double& value, const ParameterRule& rule, bool is_required) {
  add(key, rule, is_required ? kRequired : written_number(value));
}

void ParameterTable::integer(std::string_view key, int& value, const ParameterRule& rule) {
  add(key, rule, written_integer(value));
}

void ParameterTable::boolean(std::string_view key, bool& value, const ParameterRule& rule) {
  ParameterRule of_two = rule;
  if (rule.values.empty()) of_two.values = "true, false";
  add(key, of_two, written_boolean(value));
}

void ParameterTable::nested(std::string_view key, std::string_view what, const Visit& /*visit*/) {
  rows_.push_back({.key = std::string{key}, .what = std::string{what}, .values = "section", .fallback = kRequired});
}

void ParameterTable::either(const Alternative& first, const Alternative& second) {
  add(first.key, first.rule, "or `" + std::string{second.key} + "`");
  add(second.key, second.rule, "or `" + std::string{first.key} + "`");
}

}  // namespace hybridtest
