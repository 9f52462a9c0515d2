#include "scenario/bridging_section.hpp"

namespace hybridtest {

BridgingSettings read_bridging(config::Section& root, double step_s) {
  constexpr double kDeadlineShare = 0.5;  // of a step: the other half is left to the way of the next command
  constexpr int kMostInARow = 100;
  BridgingSettings bridging;
  config::Section section = root.section_or_empty("bridging");
  bridging.type =
      static_cast<BridgeType>(section.choice("type", {"hold", "polynomial", "initial_stiffness"}, "polynomial"));
  if (bridging.type == BridgeType::polynomial) {
    bridging.order = static_cast<int>(section.integer("order", 1, 3, bridging.order));
  }
  bridging.deadline = from_seconds(section.number(
      "deadline_s", {.low = 0.0, .high = step_s, .low_open = true, .high_open = true}, kDeadlineShare * step_s));
  bridging.most_in_a_row = static_cast<int>(section.integer("most_in_a_row", 1, kMostInARow, bridging.most_in_a_row));
  bridging.start_anyway = section.boolean("start_anyway", false);
  section.finish();
  return bridging;
}

}  // namespace hybridtest
