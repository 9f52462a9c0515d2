#pragma once

#include <algorithm>
#include <functional>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/config/section.hpp"
#include "scenario/catalogue/parameter_reader.hpp"
#include "scenario/catalogue/parameter_table.hpp"

namespace hybridtest {

/// Makes a part; called only when nothing was wrong in its section.
template <class Part>
using Maker = std::function<std::unique_ptr<Part>()>;

/// A line in the table of a kind of part: a name that a file can give in a `type` key, what reads the rest of the
/// section, and what the documentation says of its keys.
template <class Reading>
struct PartType {
  std::string name;
  std::function<Reading(config::Section&)> read;
  std::function<void(ParameterTable&)> describe{};  // empty: there are none
};

/// The rows of a part's parameters with their defaults.
template <class Part>
void describe(ParameterTable& table) {
  typename Part::Parameters parameters;
  parameters.serialize(table);
}

template <class Reading>
[[nodiscard]] std::vector<std::string> names_of(const std::vector<PartType<Reading>>& types) {
  std::vector<std::string> names;
  std::ranges::transform(types, std::back_inserter(names), &PartType<Reading>::name);
  return names;
}

/// Reads the `type` key and then, by it, the rest of the section.
/// @param fallback   the type when none is given; without one the key is required.
template <class Reading>
Reading read_type(config::Section& section, const std::vector<PartType<Reading>>& types,
                  std::optional<std::string> fallback = {}) {
  Reading reading = types[section.choice("type", names_of(types), std::move(fallback))].read(section);
  section.finish();
  return reading;
}

/// The table of the documentation: `| type | key | unit | what | values | default |`.
template <class Reading>
[[nodiscard]] std::string table_of(const std::vector<PartType<Reading>>& types) {
  std::string text = table_head("`type`");
  for (const PartType<Reading>& type : types) {
    ParameterTable table;
    if (type.describe) type.describe(table);
    text += table.lines("`" + type.name + "`");
  }
  return text;
}

/// Reports at `key` when not one was found for each interface degree of freedom.
/// @param advice   completes the message.
void expect_count(config::Section& section, std::string_view key, std::size_t found, int expected,
                  std::string_view advice = {});

}  // namespace hybridtest
