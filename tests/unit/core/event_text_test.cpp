#include "core/event_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "core/rig_fault.hpp"

namespace hybridtest {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

std::string interlock(const char* fault, double observed, double limit) {
  Event event;
  event.code = EventCode::interlock_tripped;
  event.subject = fault;
  event.values = {observed, limit};
  return describe(event);
}

TEST(EventText, InterlockNamesValueLimitAndUnit) {
  EXPECT_EQ(interlock("force_limit", 1200.0, 1000.0), "interlock: force_limit (observed 1200 N, limit 1000 N)");
  EXPECT_EQ(interlock("emergency_stop", 0.0, 0.0), "interlock: emergency_stop");
}

TEST(EventText, EnergyErrorSaysAddedOrRemoved) {
  EXPECT_THAT(interlock("energy_error", -2.1, 2.0),
              AllOf(HasSubstr("added energy to the structure"),
                    HasSubstr("(2.1 of its largest strain energy, limit 2)"), Not(HasSubstr("removed"))));
  EXPECT_THAT(interlock("energy_error", 2.1, 2.0),
              AllOf(HasSubstr("removed energy from the structure"), Not(HasSubstr("added"))));
}

TEST(EventText, RigFaultNamesItsReason) {
  EXPECT_THAT(interlock("rig_fault", static_cast<double>(RigFault::no_answer), 0.0),
              HasSubstr("rig_fault: the controller has not answered"));
  EXPECT_THAT(interlock("rig_fault", 0.0, 0.0), HasSubstr("the rig gives no reason"));
  for (const double foreign : {-1.0, 200.0, 1e300, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THAT(interlock("rig_fault", foreign, 0.0), HasSubstr("the rig gives no reason")) << foreign;
  }
}

TEST(EventText, NotFiniteNamesSignalAndDegreeOfFreedom) {
  EXPECT_EQ(interlock("not_finite", static_cast<double>(SiteSignal::measured_force), 2.0),
            "interlock: not_finite: the measured force of interface degree of freedom 2 is not a finite number");
  EXPECT_EQ(interlock("not_finite", 77.0, 0.0), "interlock: not_finite: a signal is not a finite number");
}

}  // namespace
}  // namespace hybridtest
