#include "launch/diagnosis_progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

namespace hybridtest {

void show_fits(std::size_t done, std::size_t all) {
  if (isatty(STDERR_FILENO) == 0) return;
  fmt::print(stderr, "\r{} of {} effects fitted{}", done, all, done == all ? "\n" : "");
}

void show_rerun(double done) {
  if (isatty(STDERR_FILENO) == 0) return;
  fmt::print(stderr, "\rrunning the whole test again: {:3.0f} %{}", 100.0 * done, done >= 1.0 ? "\n" : "");
}

}  // namespace hybridtest
