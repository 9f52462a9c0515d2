// The tables of docs/scenario.md say which keys every compensator, force compensator and estimator has, and what an
// absent one means. What the program reads has to be the same.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "scenario/catalogue/compensators.hpp"
#include "scenario/catalogue/delay_estimators.hpp"
#include "scenario/catalogue/force_compensators.hpp"
#include "tests/unit/scenario/scenario_file.hpp"

namespace hybridtest {
namespace {

constexpr const char* kRequired = "—";

using Keys = std::map<std::string, std::string>;      // key -> documented default
using DocumentedTypes = std::map<std::string, Keys>;  // type -> its keys

std::string trimmed(const std::string& text) {
  const auto begin = text.find_first_not_of(' ');
  return begin == std::string::npos ? "" : text.substr(begin, text.find_last_not_of(' ') - begin + 1);
}

std::vector<std::string> pieces(const std::string& text, char separator) {
  std::vector<std::string> found;
  std::istringstream in{text};
  for (std::string piece; std::getline(in, piece, separator);) found.push_back(trimmed(piece));
  return found;
}

/// What the documentation says of every type, from which its tables are made.
template <class Reading>
DocumentedTypes documented(const std::vector<PartType<Reading>>& parts) {
  DocumentedTypes types;
  for (const PartType<Reading>& part : parts) {
    ParameterTable table;
    if (part.describe) part.describe(table);
    Keys& keys = types[part.name];
    for (const ParameterTable::Row& row : table.rows()) keys[row.key] = row.fallback;
  }
  return types;
}

std::set<std::string> names_of(const DocumentedTypes& types) {
  std::set<std::string> names;
  for (const auto& [name, keys] : types) names.insert(name);
  return names;
}

std::string required_value(const std::string& key) { return key == "plant" ? "{}" : "0.02"; }

std::string yaml_of(const std::string& type, const Keys& keys) {
  std::string text = "{type: " + type;
  for (const auto& [key, value] : keys) {
    if (value == kRequired) text += ", " + key + ": " + required_value(key);
  }
  return text + "}";
}

class DocumentedCompensation : public testing::Test {
 protected:
  /// The section of the effective scenario that a value in it becomes.
  [[nodiscard]] YAML::Node effective(const std::string& key, const std::string& value) const {
    const Scenario scenario = file_.read(kScenarioText, {"substructures[storey_1]." + key + "=" + value});
    const YAML::Node site = YAML::Load(scenario.effective)["substructures"][0];
    return site[key].IsSequence() ? site[key][0] : site[key];
  }

  /// Names that an unknown one is answered with.
  [[nodiscard]] std::set<std::string> known(const std::string& key, const std::string& before,
                                            const std::string& after) const {
    const auto errors =
        file_.errors(kScenarioText, {"substructures[storey_1]." + key + "=" + before + "nobody" + after});
    for (const std::string& error : errors) {
      const auto place = error.find("choices: ");
      if (place == std::string::npos) continue;
      const auto names = pieces(error.substr(place + 9), ',');
      return {names.begin(), names.end()};
    }
    return {};
  }

  static void expect_keys(const YAML::Node& section, const Keys& documented_keys, const std::string& type) {
    std::set<std::string> found;
    for (const auto& entry : section) {
      const auto key = entry.first.as<std::string>();
      if (key == "type" || key == "estimator") continue;
      found.insert(key);
      ASSERT_TRUE(documented_keys.contains(key)) << type << " takes " << key << ", which is not documented";
      const std::string& written = documented_keys.at(key);
      if (written == kRequired) continue;
      if (written == "true" || written == "false") {
        EXPECT_EQ(entry.second.as<bool>(), written == "true") << type << '.' << key;
      } else {
        EXPECT_EQ(entry.second.as<double>(), std::stod(written)) << type << '.' << key;
      }
    }
    for (const auto& [key, value] : documented_keys) {
      EXPECT_TRUE(found.contains(key)) << type << " is said to take " << key << ", and does not";
    }
  }

  ScenarioFile file_;
};

TEST_F(DocumentedCompensation, CompensatorsHaveDocumentedKeysAndDefaults) {
  const DocumentedTypes types = documented(compensators());
  EXPECT_EQ(names_of(types), known("compensator", "{type: ", "}"));
  EXPECT_EQ(types.size(), 12U);
  for (const auto& [type, keys] : types) expect_keys(effective("compensator", yaml_of(type, keys)), keys, type);
}

TEST_F(DocumentedCompensation, ForceCompensatorsHaveDocumentedKeysAndDefaults) {
  const DocumentedTypes types = documented(force_compensators());
  EXPECT_EQ(names_of(types), known("force_compensator", "{type: ", "}"));
  EXPECT_EQ(types.size(), 5U);
  for (const auto& [type, keys] : types) expect_keys(effective("force_compensator", yaml_of(type, keys)), keys, type);
}

TEST_F(DocumentedCompensation, EstimatorsHaveDocumentedKeysAndDefaults) {
  const DocumentedTypes types = documented(delay_estimators());
  const std::string compensator = "{type: newmark_kinematics, delay_s: 0.02, estimator: ";
  EXPECT_EQ(names_of(types), known("compensator", compensator + "{initial_delay_s: 0.02, type: ", "}}"));
  EXPECT_EQ(types.size(), 5U);
  for (const auto& [type, keys] : types) {
    const YAML::Node section = effective("compensator", compensator + yaml_of(type, keys) + "}");
    expect_keys(section["estimator"], keys, type);
  }
}

TEST_F(DocumentedCompensation, OnlyMethodsWithDelayAcceptEstimator) {
  const auto estimated = [](const std::string& type, const std::string& required) {
    return "{type: " + type + required + ", estimator: {type: fixed, initial_delay_s: 0.02}}";
  };
  for (const char* type :
       {"polynomial_displacement", "newmark_kinematics", "linear_acceleration", "inverse_compensation"}) {
    EXPECT_NO_THROW(effective("compensator", estimated(type, ", delay_s: 0.02"))) << type;
  }
  EXPECT_NO_THROW(effective("force_compensator", estimated("polynomial_force", ", delay_s: 0.02")));
  const auto errors =
      file_.errors(kScenarioText, {"substructures[storey_1].compensator=" + estimated("adaptive_time_series", "")});
  EXPECT_THAT(errors, testing::Contains(testing::HasSubstr("needs a compensator with a delay")));
}

TEST_F(DocumentedCompensation, RejectsParameterOutOfRangeWithReason) {
  const auto errors =
      file_.errors(kScenarioText, {"substructures[storey_1].compensator={type: adaptive_time_series, window_s: 20.0}"});
  EXPECT_THAT(errors,
              testing::Contains(testing::AllOf(testing::HasSubstr("window_s is 20"), testing::HasSubstr("0.1 to 10"),
                                               testing::HasSubstr("cycles of the structure"))));
}

}  // namespace
}  // namespace hybridtest
