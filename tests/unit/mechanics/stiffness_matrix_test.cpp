#include "mechanics/structure/stiffness_matrix.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/config_error.hpp"

namespace hybridtest {
namespace {

std::string refusal(const Eigen::MatrixXd& stiffness) {
  try {
    static_cast<void>(checked_stiffness(stiffness));
  } catch (const ConfigError& error) {
    return error.what();
  }
  return {};
}

TEST(StiffnessMatrix, SymmetrisesRoundingErrors) {
  Eigen::MatrixXd stiffness{{2.0e6, -1.0e6}, {-1.0e6 - 1.0e-4, 1.0e6}};
  const InterfaceMatrix checked = checked_stiffness(stiffness);
  EXPECT_EQ(checked(0, 1), checked(1, 0));
  EXPECT_DOUBLE_EQ(checked(0, 1), -1.0e6 - 0.5e-4);
  EXPECT_EQ(checked(0, 0), 2.0e6);
}

TEST(StiffnessMatrix, RejectsUnsymmetricMatrix) {
  EXPECT_EQ(refusal(Eigen::MatrixXd{{2.0, -1.0}, {-1.5, 1.0}}),
            "stiffness entry (2, 1) is -1.5 and entry (1, 2) is -1; expected a symmetric matrix");
}

TEST(StiffnessMatrix, RejectsOtherShapes) {
  EXPECT_THAT(refusal(Eigen::MatrixXd(2, 3)), testing::HasSubstr("2 rows and 3 columns"));
  EXPECT_THAT(refusal(Eigen::MatrixXd(0, 0)), testing::HasSubstr("1 to 2048"));
  const Eigen::Index most = kMaxInterfaceDofs;
  EXPECT_THAT(refusal(Eigen::MatrixXd::Identity(most + 1, most + 1)), testing::HasSubstr("1 to 2048"));
  EXPECT_EQ(refusal(Eigen::MatrixXd::Identity(most, most)), "");
}

TEST(StiffnessMatrix, RejectsNonFiniteEntries) {
  EXPECT_THAT(refusal(Eigen::MatrixXd{{1.0, 0.0}, {0.0, std::nan("")}}), testing::HasSubstr("(2, 2)"));
}

}  // namespace
}  // namespace hybridtest
