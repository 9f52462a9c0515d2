#pragma once

#include <cstddef>

/// How far a diagnosis is: a line on standard error that is rewritten, on a terminal only.
namespace hybridtest {

void show_fits(std::size_t done, std::size_t all);
/// @param done   0 to 1.
void show_rerun(double done);

}  // namespace hybridtest
