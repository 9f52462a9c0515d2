#pragma once

#include <algorithm>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/config/section.hpp"

namespace hybridtest {

/// A name that a scenario can give in a `type` key, and what reads the rest of the section.
template <class Reading>
struct NamedType {
  std::string name;
  Reading (*read)(config::Section& section);
};

/// Reads the `type` key and then, by it, the rest of the section.
/// @param fallback   the type when none is given; without one the key is required.
template <class Reading>
Reading read_type(config::Section& section, const std::vector<NamedType<Reading>>& types,
                  std::optional<std::string> fallback = {}) {
  std::vector<std::string> names;
  std::ranges::transform(types, std::back_inserter(names), &NamedType<Reading>::name);
  Reading reading = types[section.choice("type", names, std::move(fallback))].read(section);
  section.finish();
  return reading;
}

}  // namespace hybridtest
