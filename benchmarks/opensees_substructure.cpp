// A step of a substructure in OpenSees, over a step of the same model in the same analysis by OpenSees alone, which
// moves the same node through the same displacements from a list. Plane frames of beams, from a portal of yielding
// fibres to 30 000 degrees of freedom. Both run in this order for each size, in one run on one machine. Skips, with a
// message, where there is no OpenSees.

#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <fstream>
#include <string>
#include <vector>

#include "core/child_process.hpp"
#include "core/config_error.hpp"
#include "core/opensees_program.hpp"
#include "numerical_substructure/opensees/opensees_model.hpp"

namespace {

using namespace hybridtest;

constexpr double kAmplitude_m = 0.05;
constexpr Duration kPatience = std::chrono::minutes{10};

struct Frame {
  int bays;
  int storeys;
  int steps;
  bool is_fibre;

  [[nodiscard]] int dofs() const { return 3 * (bays + 1) * storeys; }
};

/// Node 1 is the top of the first column line.
std::string model_of(const Frame& frame) {
  std::string script = "model basic -ndm 2 -ndf 3\ngeomTransf Linear 1\n";
  script += "uniaxialMaterial Steel02 1 350.0e6 200.0e9 0.02 18 0.925 0.15\n";
  script += "section Fiber 1 {\n patch rect 1 8 1 -0.15 -0.15 0.15 0.15\n}\n";
  script += "set bays " + std::to_string(frame.bays) + "\nset storeys " + std::to_string(frame.storeys) + "\n";
  script += "set fibre " + std::to_string(static_cast<int>(frame.is_fibre)) + "\n";
  return script + R"tcl(
proc tag {bay level} {
  global storeys
  return [expr {1 + $bay * ($storeys + 1) + $storeys - $level}]
}
for {set bay 0} {$bay <= $bays} {incr bay} {
  for {set level 0} {$level <= $storeys} {incr level} {
    node [tag $bay $level] [expr {5.0 * $bay}] [expr {3.0 * $level}]
  }
  fix [tag $bay 0] 1 1 1
}
set element 0
proc beam {from to} {
  global element fibre
  incr element
  if {$fibre} {
    element forceBeamColumn $element $from $to 5 1 1
  } else {
    element elasticBeamColumn $element $from $to 0.09 200.0e9 6.75e-4 1
  }
}
for {set bay 0} {$bay <= $bays} {incr bay} {
  for {set level 1} {$level <= $storeys} {incr level} {
    beam [tag $bay [expr {$level - 1}]] [tag $bay $level]
    if {$bay > 0} { beam [tag [expr {$bay - 1}] $level] [tag $bay $level] }
  }
}
)tcl";
}

double displacement_m(int step) { return kAmplitude_m * std::sin(0.1 * step); }

/// The model with an analysis of its own, which writes the time of its steps to `time.txt`. [us]
std::string alone(const Frame& frame) {
  std::string script = "source model.tcl\ntimeSeries Path 1 -dt 1.0 -values {0.0";
  for (int i = 1; i <= frame.steps; ++i) script += " " + std::to_string(displacement_m(i));
  return script + " 0.0}\npattern Plain 1 1 { sp 1 1 1.0 }\n" +
         "constraints Transformation\nnumberer RCM\nsystem UmfPack\ntest NormDispIncr 1e-10 25\nalgorithm Newton\n" +
         "integrator LoadControl 1.0\nanalysis Static\nrecorder Node -file force.txt -node 1 -dof 1 reaction\n" +
         "integrator LoadControl 0.0\nanalyze 1\nintegrator LoadControl 1.0\n" +  // equations are numbered
         "set start [clock microseconds]\nset failed [analyze " + std::to_string(frame.steps) +
         "]\nset file [open time.txt w]\nputs $file [expr {[clock microseconds] - $start}]\nclose $file\nexit "
         "$failed\n";
}

double alone_us(const std::filesystem::path& folder, const Frame& frame) {
  std::ofstream{folder / "alone.tcl"} << alone(frame);
  ChildProcess process{"alone",
                       {.program = find_opensees(""),
                        .arguments = {"alone.tcl"},
                        .log_file = folder / "alone.log",
                        .directory = folder,
                        .is_killed_with_parent = true}};
  if (!process.wait_for_end(kPatience) || process.exit_code() != 0) {
    throw std::runtime_error{"OpenSees alone failed: " + process.last_words()};
  }
  double time_us = 0.0;
  std::ifstream{folder / "time.txt"} >> time_us;
  return time_us / frame.steps;
}

double substructure_us(const std::filesystem::path& folder, const Frame& frame) {
  OpenSeesSettings settings;
  settings.script = folder / "model.tcl";
  settings.interface = {{1, 1}};
  settings.answer_timeout = kPatience;
  OpenSeesModel model{settings};
  model.start({});
  InterfaceVector force_n = InterfaceVector::Zero(1);
  const auto start = std::chrono::steady_clock::now();
  for (int i = 1; i <= frame.steps; ++i) {
    const InterfaceVector target_m = InterfaceVector::Constant(1, displacement_m(i));
    if (model.begin_step(target_m, InterfaceVector::Zero(1), force_n, Instant{}) != ModelAnswer::ready) {
      throw std::runtime_error{model.failure_text()};
    }
  }
  const std::chrono::duration<double, std::micro> taken = std::chrono::steady_clock::now() - start;
  return taken.count() / frame.steps;
}

}  // namespace

int main() try {
  try {
    static_cast<void>(find_opensees(""));
  } catch (const ConfigError& error) {
    std::printf("skipped: %s\n", error.what());
    return 0;
  }
  limit_opensees_threads();
  std::printf("%10s %8s %18s %18s %8s\n", "dofs", "fibres", "substructure us", "alone us", "ratio");
  for (const Frame& frame :
       {Frame{1, 1, 500, true}, Frame{9, 10, 500, false}, Frame{30, 32, 100, false}, Frame{99, 100, 20, false}}) {
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("opensees_substructure_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder);
    std::ofstream{folder / "model.tcl"} << model_of(frame);
    const double alone = alone_us(folder, frame);
    const double substructure = substructure_us(folder, frame);
    std::printf("%10d %8s %18.1f %18.1f %8.2f\n", frame.dofs(), frame.is_fibre ? "yes" : "no", substructure, alone,
                substructure / alone);
    std::filesystem::remove_all(folder);
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
