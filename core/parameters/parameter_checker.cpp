#include "core/parameters/parameter_checker.hpp"

namespace hybridtest {

void ParameterChecker::number(std::string_view key, double& value, const ParameterRule& rule, bool /*is_required*/) {
  expect_in_range(key, value, rule.range, rule.reason);
}

void ParameterChecker::integer(std::string_view key, int& value, const ParameterRule& rule) {
  expect_in_range(key, value, rule.range, rule.reason);
}

void ParameterChecker::boolean(std::string_view /*key*/, bool& /*value*/, const ParameterRule& /*rule*/) {}

void ParameterChecker::nested(std::string_view /*key*/, std::string_view /*what*/, const Visit& visit) { visit(*this); }

void ParameterChecker::either(const Alternative& first, const Alternative& second) {
  const Alternative& given = second.value == 0.0 ? first : second;
  number(given.key, given.value, given.rule, true);
}

}  // namespace hybridtest
