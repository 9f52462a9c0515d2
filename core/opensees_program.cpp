#include "core/opensees_program.hpp"

#include <cstdlib>
#include <optional>

#include "core/child_process.hpp"
#include "core/config_error.hpp"

namespace hybridtest {

std::filesystem::path find_opensees(const std::string& program) {
  const char* variable = std::getenv("HYBRIDTEST_OPENSEES");
  const std::string named = !program.empty() ? program : variable != nullptr ? variable : "";
  if (const auto found = find_program(named.empty() ? "OpenSees" : named)) return std::filesystem::absolute(*found);
  if (named.empty()) {
    throw ConfigError{
        "no OpenSees in PATH, which this scenario needs; install it, or name the program with "
        "`program: /path/to/OpenSees` or with the environment variable HYBRIDTEST_OPENSEES"};
  }
  throw ConfigError{"there is no program " + named + " (" +
                    (program.empty() ? "environment variable HYBRIDTEST_OPENSEES" : "key `program`") +
                    "); expected the path of OpenSees, or its name in PATH"};
}

void limit_opensees_threads() { setenv("OPENBLAS_NUM_THREADS", "1", 0); }

}  // namespace hybridtest
