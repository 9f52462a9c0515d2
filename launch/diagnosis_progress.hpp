#pragma once

#include <cstddef>

/// Progress of a diagnosis: one line on standard error, rewritten in place; on a terminal only.
namespace hybridtest {

void show_fits(std::size_t done, std::size_t all);
/// @param done   0 to 1.
void show_rerun(double done);

}  // namespace hybridtest
