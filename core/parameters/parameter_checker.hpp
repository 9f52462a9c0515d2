#pragma once

#include "core/parameters/checked_parameter.hpp"
#include "core/parameters/parameter_archive.hpp"

namespace hybridtest {

/// Checks every parameter against its range.
class ParameterChecker final : public ParameterArchive {
 public:
  void either(const Alternative& first, const Alternative& second) override;

 protected:
  void number(std::string_view key, double& value, const ParameterRule& rule, bool is_required) override;
  void integer(std::string_view key, int& value, const ParameterRule& rule) override;
  void boolean(std::string_view key, bool& value, const ParameterRule& rule) override;
  void nested(std::string_view key, std::string_view what, const Visit& visit) override;
};

/// Hands the parameters of a part on once each lies in its range, for constructors.
/// @throws ConfigError naming the first that does not, its value and what was expected.
template <class Parameters>
[[nodiscard]] Parameters checked(Parameters parameters) {
  ParameterChecker checker;
  parameters.serialize(checker);
  return parameters;
}

}  // namespace hybridtest
