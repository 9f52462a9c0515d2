#include "scenario/catalogue/part.hpp"

namespace hybridtest {

void expect_count(config::Section& section, std::string_view key, std::size_t found, int expected,
                  std::string_view advice) {
  if (std::cmp_equal(found, expected)) return;
  section.error(key, std::to_string(found) + " given; expected " + std::to_string(expected) +
                         ", one for each interface degree of freedom" + std::string{advice});
}

}  // namespace hybridtest
