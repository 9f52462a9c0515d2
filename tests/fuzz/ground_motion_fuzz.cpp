#include "tests/fuzz/ground_motion_fuzz.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <string_view>

#include "coordinator/excitation/force_history.hpp"
#include "coordinator/excitation/read_ground_motion.hpp"
#include "core/assert.hpp"
#include "core/config_error.hpp"

namespace hybridtest {
namespace {

std::string number_text(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

/// As one column, which keeps all digits of step and values.
std::string one_column(const GroundMotion& motion) {
  std::string text = "a_m_per_s2\n";
  for (const double value : motion.acceleration_m_per_s2) text += number_text(value) + "\n";
  return text;
}

void check(const GroundMotion& motion) {
  HYBRIDTEST_ASSERT(std::isfinite(motion.dt_s) && motion.dt_s > 0.0);
  HYBRIDTEST_ASSERT(std::isfinite(motion.start_s) && motion.start_s >= 0.0);
  HYBRIDTEST_ASSERT(!motion.acceleration_m_per_s2.empty());
  const auto& values = motion.acceleration_m_per_s2;
  HYBRIDTEST_ASSERT(std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); }));
  const double bound = motion.peak_m_per_s2() * (1.0 + 1e-12);
  for (int i = -1; i <= 40; ++i) {
    const double time_s = motion.start_s + 0.3 * i * motion.dt_s;
    HYBRIDTEST_ASSERT(std::abs(motion.at(time_s)) <= bound);
  }
  const GroundMotion again =
      parse_ground_motion(one_column(motion), "again", {.scale = 1.0, .unit = {}, .dt_s = motion.dt_s});
  HYBRIDTEST_ASSERT(again.acceleration_m_per_s2 == values);
  HYBRIDTEST_ASSERT(again.dt_s == motion.dt_s);
}

bool is_accepted(std::string_view text, const std::string& name, const GroundMotionOptions& options) {
  try {
    check(parse_ground_motion(text, name, options));
    return true;
  } catch (const ConfigError& error) {
    HYBRIDTEST_ASSERT(!error.issues().empty() && error.issues().front().file == name);
    return false;
  }
}

/// The same text as columns of forces.
void read_as_forces(std::string_view text) {
  try {
    for (const TimeHistory& force : parse_force_history(text, "fuzz").histories) {
      HYBRIDTEST_ASSERT(force.dt_s > 0.0 && force.start_s >= 0.0 && !force.values.empty());
      HYBRIDTEST_ASSERT(std::ranges::all_of(force.values, [](double value) { return std::isfinite(value); }));
    }
  } catch (const ConfigError& error) {
    HYBRIDTEST_ASSERT(!error.issues().empty() && error.issues().front().file == "fuzz");
  }
}

}  // namespace

bool fuzz_ground_motion(const std::uint8_t* bytes, std::size_t size) {
  const std::string_view text{reinterpret_cast<const char*>(bytes), size};
  bool accepted = is_accepted(text, "fuzz", {});
  accepted |= is_accepted(text, "fuzz.AT2", {});
  accepted |= is_accepted(text, "fuzz", {.scale = -2.0, .unit = AccelerationUnit::g, .dt_s = 0.01});
  accepted |= is_accepted(text, "fuzz", {.scale = 1.0, .unit = AccelerationUnit::g, .dt_s = {}});
  read_as_forces(text);
  return accepted;
}

}  // namespace hybridtest

#ifdef HYBRIDTEST_LIBFUZZER
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  (void)hybridtest::fuzz_ground_motion(bytes, size);
  return 0;
}
#endif
