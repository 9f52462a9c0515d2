#include "scenario/dof_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config_error.hpp"

namespace hybridtest {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> table_issues(const std::string& text) {
  std::vector<std::string> texts;
  try {
    static_cast<void>(DofTable::parse(text, "dofs.csv"));
  } catch (const ConfigError& error) {
    for (const ConfigIssue& issue : error.issues()) texts.push_back(issue.text());
  }
  return texts;
}

const std::string kTable =
    "node,direction,name\n"
    "# two floors\n"
    "114,1,\r\n"
    "114,rz,torsion\n"
    "\n"
    " roof , x , top\n";

TEST(DofTable, ReadsNodesDirectionsAndNames) {
  const DofTable table = DofTable::parse(kTable, "dofs.csv");
  EXPECT_THAT(table.names(), ElementsAre("114.x", "torsion", "top"));
  EXPECT_THAT(table.in_direction(0), ElementsAre(0, 2));
  EXPECT_THAT(table.in_direction(5), ElementsAre(1));
  EXPECT_THAT(table.in_direction(1), IsEmpty());
}

TEST(DofTable, AnswersToEveryWayOfNamingADof) {
  const DofTable table = DofTable::parse(kTable, "dofs.csv");
  for (const char* address : {"114.x", "114.1", "node 114 dof 1", " node  114 dof x"}) {
    EXPECT_EQ(table.find(address), 0) << address;
  }
  for (const char* address : {"torsion", "114.rz", "114.6", "node 114 dof 6"}) EXPECT_EQ(table.find(address), 1);
  for (const char* address : {"top", "roof.x", "node roof dof 1"}) EXPECT_EQ(table.find(address), 2) << address;
  for (const char* address : {"", "114", "114.7", "115.x", "node 114 dof 7", "node 114 1", ".x"}) {
    EXPECT_EQ(table.find(address), std::nullopt) << address;
  }
}

TEST(DofTable, NamesOfTheScenarioHaveNoDirections) {
  const DofTable table{{"floor_1", "114.x"}};
  EXPECT_FALSE(table.has_directions());
  EXPECT_EQ(table.find("114.x"), 1);
  EXPECT_EQ(table.find("114.1"), std::nullopt);
}

TEST(DofTable, PatternsMatchNamesAndPlaces) {
  const DofTable table = DofTable::parse(kTable, "dofs.csv");
  EXPECT_THAT(table.matching("*"), ElementsAre(0, 1, 2));
  EXPECT_THAT(table.matching("114.*"), ElementsAre(0, 1));
  EXPECT_THAT(table.matching("*.x"), ElementsAre(0, 2));
  EXPECT_THAT(table.matching("to*"), ElementsAre(1, 2));
  EXPECT_THAT(table.matching("t?p"), ElementsAre(2));
  EXPECT_THAT(table.matching("node roof dof 1"), ElementsAre(2));
  EXPECT_THAT(table.matching("floor*"), IsEmpty());
}

TEST(DofTable, ListsEveryWrongLine) {
  EXPECT_THAT(table_issues("node,direction,name\n"
                           "1,x,a\n"
                           "1,u,b\n"
                           "1,y\n"
                           "1,1,c\n"
                           "2,x,a\n"
                           "3.1,x,d\n"
                           "4,x,e f\n"
                           ",x,g\n"),
              ElementsAre("dofs.csv:3: 'u' is no direction; expected x, y, z, rx, ry, rz or a number from 1 to 6",
                          "dofs.csv:4: found 2 columns; expected 3 as in the header",
                          "dofs.csv:5: node and direction '1.x' was given in line 2 already; expected each degree of "
                          "freedom once",
                          "dofs.csv:6: the name 'a' was given in line 2 already; expected each degree of freedom once",
                          HasSubstr("dofs.csv:7: the node '3.1' has a '.'"),
                          HasSubstr("dofs.csv:8: 'e f' does not serve as a name"),
                          HasSubstr("dofs.csv:9: '' does not serve as a node")));
}

TEST(DofTable, RejectsFilesWithoutHeaderOrRows) {
  EXPECT_THAT(table_issues(""), ElementsAre(HasSubstr("expected the header node,direction")));
  EXPECT_THAT(table_issues("1,x,a\n"), ElementsAre(HasSubstr("dofs.csv:1: found '1,x,a'; expected the header")));
  EXPECT_THAT(table_issues("node,direction\n"), ElementsAre(HasSubstr("expected a row for each degree of freedom")));
}

}  // namespace
}  // namespace hybridtest
