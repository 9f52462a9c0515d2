#pragma once

#include <functional>
#include <string_view>

#include "core/parameters/range.hpp"
#include "core/time.hpp"

namespace hybridtest {

/// What holds for a parameter besides its key, its type and its default.
struct ParameterRule {
  Range range{};
  std::string_view what{};    // what it is, in half a line, for the documentation
  std::string_view reason{};  // completes "…, because"; why the range is what it is
  std::string_view values{};  // for the documentation, where the range does not say everything
  std::string_view unit{};    // where the key does not end in the unit
};

/// Visits the parameters of a part, one by one, in the order of its `serialize(ParameterArchive&)`.
///
/// A part lists its parameters once:
///
///     struct Parameters {
///       double friction_force_n = 0.0;
///       double presliding_displacement_m = 1e-5;
///
///       void serialize(ParameterArchive& archive) {
///         archive.required("friction_force_n", friction_force_n, {kNotNegative, "while sliding"});
///         archive.optional("presliding_displacement_m", presliding_displacement_m, {kPositive, "until it slides"});
///       }
///     };
///
/// and the archives read them from a file, check them in the constructor (parameter_checker.hpp), document them and
/// write them. The keys of an effective scenario, and so its digest, have the order of serialize().
class ParameterArchive {
 public:
  /// One of two keys for the same thing; a value of zero means that it is not given.
  struct Alternative {
    std::string_view key;
    double& value;
    ParameterRule rule{};
  };

  virtual ~ParameterArchive() = default;

  /// A file has to have the key.
  void required(std::string_view key, double& value, const ParameterRule& rule) { number(key, value, rule, true); }
  /// A file may leave the key out: the default is the value that the member has.
  void optional(std::string_view key, double& value, const ParameterRule& rule) { number(key, value, rule, false); }
  void optional(std::string_view key, int& value, const ParameterRule& rule) { integer(key, value, rule); }
  void optional(std::string_view key, bool& value, const ParameterRule& rule) { boolean(key, value, rule); }
  void required(std::string_view key, Duration& value, const ParameterRule& rule) { duration(key, value, rule, true); }
  void optional(std::string_view key, Duration& value, const ParameterRule& rule) { duration(key, value, rule, false); }
  /// A required section with parameters of its own.
  template <class Parameters>
  void section(std::string_view key, Parameters& parameters, std::string_view what) {
    nested(key, what, [&parameters](ParameterArchive& archive) { parameters.serialize(archive); });
  }
  /// A file has to have one of the two keys.
  virtual void either(const Alternative& first, const Alternative& second) = 0;

 protected:
  using Visit = std::function<void(ParameterArchive&)>;
  virtual void number(std::string_view key, double& value, const ParameterRule& rule, bool is_required) = 0;
  virtual void integer(std::string_view key, int& value, const ParameterRule& rule) = 0;
  virtual void boolean(std::string_view key, bool& value, const ParameterRule& rule) = 0;
  virtual void nested(std::string_view key, std::string_view what, const Visit& visit) = 0;

 private:
  void duration(std::string_view key, Duration& value, const ParameterRule& rule, bool is_required) {
    const double before_s = to_seconds(value);
    double value_s = before_s;
    number(key, value_s, rule, is_required);
    if (value_s != before_s) value = from_seconds(value_s);
  }
};

}  // namespace hybridtest
