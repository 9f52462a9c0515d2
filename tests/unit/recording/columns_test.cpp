#include "recording/summary/columns.hpp"

#include <gtest/gtest.h>

#include "recording/run_file_writer.hpp"
#include "tests/unit/recording/run_file_fixture.hpp"
#include "tests/unit/recording/temporary_directory.hpp"

namespace hybridtest {
namespace {

TEST(Columns, FoundByQuantityUnitAndDof) {
  const TemporaryDirectory directory;
  RunFileHeader header = example_header();
  header.interface_dofs = {"floor_1", "floor_2"};
  std::vector<Column> columns;
  for (const char* name :
       {"force_n", "force_1_n", "force_2_n", "force_3_n", "force_roof_left_n", "forces_n", "force__n",
        "force_1_n_per_m", "force_n_2", "force_n_", "force_n_x", "measured_force_1_n", "force", "n"}) {
    columns.push_back({name, ""});
  }
  RunFileWriter{directory / "a.h5", header, {{"steps", columns}}}.close();
  const RunFileReader file{directory / "a.h5"};
  std::string found;
  for (const DofColumn& column : dof_columns(file, "steps", "force", "n")) {
    found += column.name + "=" + column.dof + "(" + column.rest + ") ";
  }
  EXPECT_EQ(found,
            "force_n=floor_1(_n) force_1_n=floor_1(_1_n) force_2_n=floor_2(_2_n) force_3_n=dof_3(_3_n) "
            "force_roof_left_n=roof_left(_roof_left_n) force_n_2=floor_2(_n_2) ");
  EXPECT_TRUE(dof_columns(file, "nothing", "force", "n").empty());
}

}  // namespace
}  // namespace hybridtest
