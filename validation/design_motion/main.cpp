#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <fstream>
#include <string>

#include "validation/design_motion/design_motion.hpp"

namespace {

/// EN 1998-1:2004, 3.2.3.1.2(4)c.
constexpr double kSpectrumRatioMin = 0.9;

}  // namespace

/// Makes the ground motion of the shipped scenarios, or another one with other settings.
int main(int argc, char** argv) {
  hybridtest::design_motion::DesignMotionSettings settings;
  std::string file;
  CLI::App app{
      "Generates an artificial ground motion fitted to the Eurocode 8 type 1 elastic spectrum, ground C, 5 % damping, "
      "as a PEER AT2 file in g. The same options give the same file."};
  app.add_option("--seed", settings.seed, "Seed of the noise that the motion is made from")->capture_default_str();
  app.add_option("--out", file, "File to write, such as design_ec8_c.AT2")->required();
  app.add_option("--ground-acceleration", settings.ground_acceleration_g,
                 "Ground acceleration a_g on rock, in g, above 0 to 2")
      ->capture_default_str();
  app.add_option("--step", settings.dt_s, "Step in seconds, 0.001 to 0.02")->capture_default_str();
  app.add_option("--duration", settings.duration_s, "Duration in seconds, 25 to 120")->capture_default_str();
  app.add_option("--iterations", settings.iterations, "Rounds of spectral matching, 0 to 1000")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    const auto motion = hybridtest::design_motion::design_motion(settings);
    if (motion.fit.lowest < kSpectrumRatioMin) {
      std::fprintf(stderr,
                   "design_motion: the spectrum falls to %.3f of the target between 0.05 and 4 s, below the 0.9 that "
                   "Eurocode 8 allows; try another seed or more iterations\n",
                   motion.fit.lowest);
      return 1;
    }
    std::ofstream stream{file, std::ios::binary};
    stream << hybridtest::design_motion::at2_text(motion.acceleration_m_per_s2, settings);
    stream.close();
    if (!stream) {
      std::fprintf(stderr,
                   "design_motion: %s cannot be written; check that the folder exists and the disk is not full\n",
                   file.c_str());
      return 1;
    }
    std::printf("%s: %zu values every %g s; spectrum %.3f to %.3f of the target between 0.05 and 4 s\n", file.c_str(),
                motion.acceleration_m_per_s2.size(), settings.dt_s, motion.fit.lowest, motion.fit.highest);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "design_motion: %s\n", error.what());
    return 2;
  }
}
