#pragma once

#include "core/config/section.hpp"
#include "core/parameters/parameter_archive.hpp"

namespace hybridtest {

/// Reads parameters from a section; what is wrong is reported at its key.
class ParameterReader final : public ParameterArchive {
 public:
  explicit ParameterReader(config::Section& section) : section_{section} {}

  void either(const Alternative& first, const Alternative& second) override;

 protected:
  void number(std::string_view key, double& value, const ParameterRule& rule, bool is_required) override;
  void integer(std::string_view key, int& value, const ParameterRule& rule) override;
  void boolean(std::string_view key, bool& value, const ParameterRule& rule) override;
  void nested(std::string_view key, std::string_view what, const Visit& visit) override;

 private:
  void judge(std::string_view key, double value, const ParameterRule& rule);

  config::Section& section_;
};

/// The parameters of a part, with its defaults for keys that the section does not have.
template <class Part>
[[nodiscard]] typename Part::Parameters read_parameters(config::Section& section) {
  typename Part::Parameters parameters;
  ParameterReader reader{section};
  parameters.serialize(reader);
  return parameters;
}

}  // namespace hybridtest
