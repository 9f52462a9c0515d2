#include "scenario/catalogue/parameter_reader.hpp"

#include <cstdint>

#include "core/parameters/checked_parameter.hpp"

namespace hybridtest {
namespace {

constexpr std::int64_t kIntegerMax = 1'000'000;

}  // namespace

// The section's own message has no place for a reason.
void ParameterReader::judge(std::string_view key, double value, const ParameterRule& rule) {
  if (!contains(rule.range, value)) section_.error(key, out_of_range(key, value, rule.range, rule.reason));
}

void ParameterReader::number(std::string_view key, double& value, const ParameterRule& rule, bool is_required) {
  if (is_required) {
    value = section_.number(key, rule.range);
  } else if (rule.reason.empty()) {
    value = section_.number(key, rule.range, value);
  } else {
    value = section_.number(key, kAnyNumber, value);
    judge(key, value, rule);
  }
}

void ParameterReader::integer(std::string_view key, int& value, const ParameterRule& rule) {
  if (rule.reason.empty()) {
    value = static_cast<int>(section_.integer(key, static_cast<std::int64_t>(rule.range.low),
                                              static_cast<std::int64_t>(rule.range.high), value));
  } else {
    value = static_cast<int>(section_.integer(key, 0, kIntegerMax, value));
    judge(key, value, rule);
  }
}

void ParameterReader::boolean(std::string_view key, bool& value, const ParameterRule& /*rule*/) {
  value = section_.boolean(key, value);
}

void ParameterReader::nested(std::string_view key, std::string_view /*what*/, const Visit& visit) {
  config::Section section = section_.section(key);
  ParameterReader reader{section};
  visit(reader);
  section.finish();
}

void ParameterReader::either(const Alternative& first, const Alternative& second) {
  const Alternative& given = section_.has(first.key) ? first : second;
  number(given.key, given.value, given.rule, true);
}

}  // namespace hybridtest
