#include "plant/specimens/elastic_specimen.hpp"

#include <gtest/gtest.h>

#include "core/config_error.hpp"

namespace hybridtest {
namespace {

TEST(ElasticSpecimen, CouplesItsActuators) {
  ElasticSpecimen specimen{Eigen::MatrixXd{{2.0, -1.0}, {-1.0, 3.0}}};
  ASSERT_EQ(specimen.dofs(), 2);
  SiteVector force_n = SiteVector::Zero(2);
  specimen.impose(SiteVector{{0.5, -2.0}}, SiteVector::Zero(2), force_n);
  EXPECT_EQ(force_n, (SiteVector{{3.0, -6.5}}));
}

TEST(ElasticSpecimen, RejectsInvalidStiffness) {
  EXPECT_THROW((ElasticSpecimen{Eigen::MatrixXd{{1.0, 2.0}, {0.0, 1.0}}}), ConfigError);
}

}  // namespace
}  // namespace hybridtest
