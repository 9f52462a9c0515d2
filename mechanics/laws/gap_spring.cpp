#include "mechanics/laws/gap_spring.hpp"

#include "core/parameters/parameter_checker.hpp"

namespace hybridtest {

GapSpring::GapSpring(const Parameters& parameters) : parameters_{checked(parameters)} {}

}  // namespace hybridtest
