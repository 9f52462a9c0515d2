#include <gtest/gtest.h>

#include "diagnosis/diagnose.hpp"
#include "diagnosis/page/diagnosis_json.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

// In a program of its own: the thread sanitizer then builds this test of the diagnosis alone.
namespace hybridtest {
namespace {

TEST(Diagnose, ResultIsIndependentOfThreadCount) {
  const Recording recording =
      made_recording(made_motion_m, [](double t) { return 1.2 * kMadeStiffness_n_per_m * made_motion_m(t); });
  DiagnoseSettings one_thread, three_threads;
  one_thread.threads = 1;
  three_threads.threads = 3;
  EXPECT_EQ(diagnosis_json(diagnose(made_model(), {&recording, 1}, one_thread)),
            diagnosis_json(diagnose(made_model(), {&recording, 1}, three_threads)));
}

}  // namespace
}  // namespace hybridtest
