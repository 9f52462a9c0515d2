// Every field on the wire says its unit, and every struct its extensibility (grammar: top of
// idl/hybridtest.idl).

#include <gtest/gtest.h>

#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace hybridtest {
namespace {

struct IdlSurvey {
  int fields = 0;
  std::set<std::string> structs;
  std::set<std::string> final_structs;
  std::vector<std::string> complaints;
};

bool is_blank_or_comment(const std::string& line) {
  static const std::regex kPattern{R"(\s*(//.*)?)"};
  return std::regex_match(line, kPattern);
}

void survey_field(const std::string& line, const std::string& where, bool in_final, IdlSurvey& survey) {
  static const std::regex kField{R"(\s+(@key )?[a-zA-Z][\w<>, ]* (\w+)(\[\d+\])?;\s*(//.*)?)"};
  static const std::regex kComment{
      R"(// \[(m|m/s|m/s2|N|s|ns|unit|-)\]( @range (\*|-?[\d.]+), (\*|-?[\d.]+))?( @invalid (NaN|-?[\d.]+))?( +[^@]*)?)"};
  // A name that ends in a unit says the same as its comment.
  static const std::vector<std::pair<std::regex, std::string>> kUnitOfName{
      {std::regex{R"(.*_m)"}, "[m]"}, {std::regex{R"(.*_m_per_s)"}, "[m/s]"}, {std::regex{R"(.*_m_per_s2)"}, "[m/s2]"},
      {std::regex{R"(.*_n)"}, "[N]"}, {std::regex{R"(.*[^r]_s)"}, "[s]"},     {std::regex{R"(.*_ns)"}, "[ns]"}};
  std::smatch field;
  if (!std::regex_match(line, field, kField)) {
    survey.complaints.push_back(where + "is no field with one name on one line");
    return;
  }
  ++survey.fields;
  const std::string name = field[2];
  const std::string comment = field[4];
  if (!std::regex_match(comment, kComment))
    survey.complaints.push_back(where + name + " has no comment of unit and range");
  for (const auto& [pattern, unit] : kUnitOfName) {
    if (std::regex_match(name, pattern) && comment.find(unit) == std::string::npos) {
      survey.complaints.push_back(where + name + " does not have the unit of its name");
    }
  }
  static const std::regex kBoundless{R"(\s+(string |sequence<([^,<>]|<[^<>]*>)*>).*)"};
  if (in_final && std::regex_match(line, kBoundless)) {
    survey.complaints.push_back(where + name + " has no limit of its length in a @final struct");
  }
}

IdlSurvey survey_idl(std::istream& idl) {
  static const std::regex kStruct{R"(struct (\w+) \{)"};
  IdlSurvey survey;
  std::string line;
  std::string before;
  bool in_struct = false;
  bool in_final = false;
  for (int number = 1; std::getline(idl, line); ++number) {
    const std::string where = "line " + std::to_string(number) + ": ";
    std::smatch opening;
    if (std::regex_match(line, opening, kStruct)) {
      in_struct = true;
      in_final = before == "@final";
      survey.structs.insert(opening[1]);
      if (in_final) survey.final_structs.insert(opening[1]);
      if (!in_final && before != "@appendable") {
        survey.complaints.push_back(where + opening[1].str() + " does not state its extensibility");
      }
    } else if (in_struct && line == "};") {
      in_struct = false;
    } else if (in_struct && !is_blank_or_comment(line)) {
      survey_field(line, where, in_final, survey);
    }
    before = line;
  }
  return survey;
}

IdlSurvey survey_text(const std::string& text) {
  std::istringstream stream{text};
  return survey_idl(stream);
}

TEST(IdlComments, FieldsHaveUnitsAndStructsExtensibility) {
  std::ifstream idl{std::string{HYBRIDTEST_SOURCE_DIR} + "/idl/hybridtest.idl"};
  ASSERT_TRUE(idl);
  const IdlSurvey survey = survey_idl(idl);
  for (const std::string& complaint : survey.complaints) ADD_FAILURE() << complaint;
  EXPECT_EQ(survey.structs.size(), 9U);
  EXPECT_GE(survey.fields, 60) << "the survey must have seen the file";
  for (const char* hot : {"CommandPoint", "DisplacementCommand", "ForceMeasurement", "SignalBlock"}) {
    EXPECT_TRUE(survey.final_structs.contains(hot)) << hot;
  }
}

// The guard can fail: each of these has one fault.

TEST(IdlComments, ReportsFieldWithoutUnit) {
  EXPECT_EQ(survey_text("@final\nstruct A {\n  double x;\n};\n").complaints.size(), 1U);
  EXPECT_EQ(survey_text("@final\nstruct A {\n  double x;  // metres\n};\n").complaints.size(), 1U);
  EXPECT_EQ(survey_text("@final\nstruct A {\n  double x;  // [furlong]\n};\n").complaints.size(), 1U);
  EXPECT_TRUE(survey_text("@final\nstruct A {\n  double x;  // [m]\n};\n").complaints.empty());
}

TEST(IdlComments, ReportsBrokenTag) {
  EXPECT_EQ(survey_text("@final\nstruct A {\n  double x;  // [m] @range 0\n};\n").complaints.size(), 1U);
  EXPECT_EQ(survey_text("@final\nstruct A {\n  double x;  // [m] @invalid\n};\n").complaints.size(), 1U);
  EXPECT_EQ(survey_text("@final\nstruct A {\n  double x;  // [m] @unknown 1\n};\n").complaints.size(), 1U);
}

TEST(IdlComments, ReportsUnitThatContradictsName) {
  EXPECT_EQ(survey_text("@final\nstruct A {\n  double force_n;  // [m]\n};\n").complaints.size(), 1U);
  EXPECT_EQ(survey_text("@final\nstruct A {\n  double velocity_m_per_s;  // [s]\n};\n").complaints.size(), 1U);
}

TEST(IdlComments, ReportsStructWithoutExtensibility) {
  EXPECT_EQ(survey_text("struct A {\n  double x;  // [m]\n};\n").complaints.size(), 1U);
}

TEST(IdlComments, ReportsLengthWithoutLimitInFinalStruct) {
  EXPECT_EQ(survey_text("@final\nstruct A {\n  sequence<double> x;  // [m]\n};\n").complaints.size(), 1U);
  EXPECT_EQ(survey_text("@final\nstruct A {\n  string x;  // [-]\n};\n").complaints.size(), 1U);
  EXPECT_TRUE(survey_text("@final\nstruct A {\n  sequence<double, 3> x;  // [m]\n};\n").complaints.empty());
  EXPECT_TRUE(survey_text("@appendable\nstruct A {\n  sequence<double> x;  // [m]\n};\n").complaints.empty());
}

}  // namespace
}  // namespace hybridtest
