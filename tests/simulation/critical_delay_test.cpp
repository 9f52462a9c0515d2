#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "core/random.hpp"
#include "mechanics/structure/vibration_modes.hpp"
#include "runtime/simulation.hpp"
#include "scenario/test_stability.hpp"
#include "tests/support/sanitizers.hpp"
#include "tests/unit/scenario/scenario_file.hpp"

/// The critical delays of the preflight against simulated tests: random structures, integrators, rigs and compensators,
/// a little below and a little above the delay at which the preflight says that they turn unstable.
namespace hybridtest {
namespace {

constexpr double kDrawnStep_s = 0.005;
constexpr int kDrawnSteps = 20'000;
/// Below and above the critical delay, of that delay in all. The method puts a further delay behind the rig, along
/// straight lines between control periods, where a delay in the rig acts on a smooth actuator: of a motion of frequency
/// w, up to (w T)^2 / 8 of the force lies between the two, half a percent here. The rest is growth too slow for the
/// steps simulated.
constexpr double kDrawnShare = 0.03;

template <class Value>
const Value& pick(Random& random, const std::vector<Value>& values) {
  return values[random.below(values.size())];
}

struct DrawnTest {
  std::string text;
  std::vector<std::string> sites;
  std::vector<double> delay_s;  // of their transfer systems, the pure part
  std::vector<double> whole_delay_s;
};

std::string compensator(Random& random, double delay_s) {
  std::ostringstream text;
  const double set_s = delay_s * random.uniform(0.7, 1.05);
  switch (random.below(7)) {
    case 0: text << "{type: none}"; break;
    case 1:
    case 2:
      text << "{type: polynomial_displacement, order: " << 1 + random.below(4) << ", delay_s: " << set_s
           << ", point_spacing_s: " << std::max(kDrawnStep_s, set_s * random.uniform(0.5, 1.5)) << "}";
      break;
    case 3: text << "{type: newmark_kinematics, delay_s: " << set_s << "}"; break;
    case 4: text << "{type: linear_acceleration, delay_s: " << set_s << "}"; break;
    case 5: text << "{type: inverse_compensation, delay_s: " << set_s << "}"; break;
    default:
      text << "{type: polynomial_displacement, order: 2, delay_s: " << set_s
           << ", point_spacing_s: " << 2.0 * kDrawnStep_s << ", estimator: {type: fixed, initial_delay_s: " << set_s
           << "}}";
  }
  return text.str();
}

/// A shear building of 1 to 4 storeys, of which one or two are specimens.
DrawnTest draw(Random& random) {
  const auto storeys = 1 + static_cast<int>(random.below(4));
  const double omega = random.uniform(0.15, 0.5) / kDrawnStep_s;  // of a storey with a floor
  std::vector<double> mass(static_cast<std::size_t>(storeys));
  std::vector<double> stiffness(mass.size());
  for (std::size_t i = 0; i < mass.size(); ++i) {
    mass[i] = 1.0e4 * random.uniform(0.5, 2.0);
    stiffness[i] = 1.0e4 * omega * omega * random.uniform(0.5, 1.5);
  }
  const double ratio = random.uniform(0.015, 0.06);
  const double mass_per_s = ratio * omega * random.uniform(0.2, 1.0);
  const double stiffness_s = ratio / omega;
  const bool has_dashpot = random.below(3) == 0;  // which couples the modes
  std::ostringstream text;
  text << "schema: hybridtest/1\nname: drawn\ntime: {mode: " << (random.below(2) == 0 ? "lockstep" : "paced")
       << ", step_s: " << kDrawnStep_s << ", duration_s: " << kDrawnSteps * kDrawnStep_s
       << "}\nexcitation: {ground_motion: motion.txt}\nstructure:\n  degrees_of_freedom: [";
  for (int i = 0; i < storeys; ++i) text << (i > 0 ? ", " : "") << "floor_" << i;
  text << "]\n  mass_kg: {";
  for (std::size_t i = 0; i < mass.size(); ++i) text << (i > 0 ? ", " : "") << "floor_" << i << ": " << mass[i];
  text << "}\n  damping: {type: matrix, matrix_n_s_per_m: [";
  for (std::size_t i = 0; i < mass.size(); ++i) {
    text << (i > 0 ? ", [" : "[");
    for (std::size_t j = 0; j < mass.size(); ++j) {
      const double above = i + 1 < mass.size() ? stiffness[i + 1] : 0.0;
      double entry = 0.0;
      if (i == j) entry = mass_per_s * mass[i] + stiffness_s * (stiffness[i] + above);
      if (i == 0 && j == 0 && has_dashpot) entry += 0.1 * omega * mass[0];
      if (j == i + 1) entry = -stiffness_s * stiffness[j];
      if (i == j + 1) entry = -stiffness_s * stiffness[i];
      text << (j > 0 ? ", " : "") << entry;
    }
    text << "]";
  }
  text << "]}\nintegrator: "
       << pick<std::string>(random, {"{type: central_difference}", "{type: explicit_newmark}", "{type: cr}",
                                     "{type: kr_alpha, rho_inf: 0.8}", "{type: alpha_operator_splitting, alpha: -0.1}",
                                     "{type: generalised_alpha, rho_inf: 0.8, iterations: 2}",
                                     "{type: generalised_alpha, rho_inf: 0.6, iterations: 3}", "{type: rosenbrock_w}"})
       << "\nsubstructures:\n";
  DrawnTest test;
  const std::size_t first = random.below(mass.size());
  const std::size_t second = random.below(3) == 0 ? random.below(mass.size()) : first;
  const auto periods = 4 + random.below(5);
  for (std::size_t i = 0; i < mass.size(); ++i) {
    text << "  - id: storey_" << i << "\n    interface: [{dof: floor_" << i;
    if (i > 0) text << ", relative_to: floor_" << i - 1;
    text << "}]\n";
    if (i != first && i != second) {
      text << "    kind: numerical\n    model: {type: elastic, stiffness_n_per_m: " << stiffness[i] << "}\n";
      continue;
    }
    const double delay_s = kDrawnStep_s * random.uniform(0.2, 2.0);
    const double frequency_hz = random.uniform(3.0, 8.0) * omega / (2.0 * std::numbers::pi);
    const bool is_pure = random.below(2) == 0;
    const double total_s = delay_s + (is_pure ? 0.0 : 0.8 / (std::numbers::pi * frequency_hz));
    text << "    kind: experimental\n    initial_stiffness_n_per_m: [[" << stiffness[i]
         << "]]\n    rig: {type: simulated, transfer_system: {type: ";
    if (is_pure) {
      text << "delay";
    } else {
      text << "second_order, natural_frequency_hz: " << frequency_hz << ", damping_ratio: 0.8";
    }
    text << ", delay_s: " << delay_s << "}, specimen: {type: elastic, stiffness_n_per_m: " << stiffness[i]
         << "}}\n    control_rate_hz: " << static_cast<double>(periods) / kDrawnStep_s
         << "\n    compensator: " << compensator(random, total_s) << "\n    force_compensator: "
         << (random.below(4) > 0 ? "{type: none}"
                                 : "{type: polynomial_force, order: 2, delay_s: 0.002, point_spacing_s: 0.01}")
         << "\n    limits: {displacement_m: 1.0e6, velocity_m_per_s: 1.0e9, force_n: 1.0e15}\n";
    test.sites.push_back("storey_" + std::to_string(i));
    test.delay_s.push_back(delay_s);
    test.whole_delay_s.push_back(total_s);
  }
  test.text = text.str();
  return test;
}

/// The largest displacement within each third of a simulated test.
class PeaksByThird final : public RowSink {
 public:
  void append(std::span<const double> row) noexcept override {
    double& peak = peaks[std::min<std::size_t>(2, static_cast<std::size_t>(row[0] * 3.0 / kDrawnSteps))];
    for (std::size_t i = 4; i < row.size(); i += 4) peak = std::max(peak, std::abs(row[i]));
  }
  std::array<double, 3> peaks{};
};

/// Peak of the last third over that of the second; infinite for a test that did not come to its end.
double simulated_growth(const Scenario& scenario) {
  PeaksByThird peaks;
  NoRecord no_record;
  SimulationObserver observer;
  observer.sink = [&](const std::string& participant, const TableLayout& table) -> RowSink& {
    if (participant == kCoordinatorId && table.name == "steps") return peaks;
    return no_record;
  };
  const SimulationResult result = simulate(scenario, SimulationSettings{}, observer);
  if (result.coordinator.reason != StopReason::completed) return std::numeric_limits<double>::infinity();
  // Far beyond the millimetres it began with, the site's own limits bound the motion.
  constexpr double kOutOfBounds_m = 100.0;
  return peaks.peaks[2] > kOutOfBounds_m ? std::numeric_limits<double>::infinity() : peaks.peaks[2] / peaks.peaks[1];
}

TEST(CriticalDelayOfATest, SeparatesBoundedFromGrowingTests) {
  constexpr int kWanted = 100 / kShortenedBy;
  const ScenarioFile file;
  Random random{2026};
  int separated = 0;
  int unstable = 0;
  int always_stable = 0;
  for (int drawn = 0; separated < kWanted; ++drawn) {
    const DrawnTest test = draw(random);
    const bool together = random.below(2) == 0;
    const Scenario scenario = file.read(test.text);
    const TestStability stability = test_stability(scenario, vibration_modes(scenario.structure));
    // One that grows but is learnt is taken as in time by the preflight, which this test could not tell from its
    // motion.
    if (std::ranges::any_of(stability.sites, [](const auto& site) { return site.grows && site.delay.is_learnt; })) {
      continue;
    }
    const CriticalDelay& further = together ? stability.further : stability.sites.front().further;
    const auto growth = [&](double later_s) {
      std::vector<std::string> overrides;
      for (std::size_t i = 0; i < (together ? test.sites.size() : 1); ++i) {
        std::ostringstream text;
        text.precision(12);
        text << "substructures[" << test.sites[i] << "].rig.transfer_system.delay_s=" << test.delay_s[i] + later_s;
        overrides.push_back(text.str());
      }
      return simulated_growth(file.read(test.text, overrides));
    };
    const double share_s = kDrawnShare * (test.whole_delay_s.front() + (stability.grows ? 0.0 : further.delay_s));
    const auto where = [&] { return "drawn " + std::to_string(drawn) + "\n" + test.text; };
    if (stability.grows) {
      EXPECT_GT(growth(share_s), 1.0) << where();
      ++unstable;
    } else if (std::isinf(further.delay_s)) {
      EXPECT_LT(growth(0.0), 1.0) << where();
      ++always_stable;
    } else if (further.delay_s - share_s + test.delay_s.front() >= 0.0) {
      EXPECT_LT(growth(further.delay_s - share_s), 1.0) << "critical: " << further.delay_s << " s later, " << where();
      EXPECT_GT(growth(further.delay_s + share_s), 1.0) << "critical: " << further.delay_s << " s later, " << where();
      ++separated;
    }
  }
  RecordProperty("unstable", unstable);
  RecordProperty("always_stable", always_stable);
}

}  // namespace
}  // namespace hybridtest
