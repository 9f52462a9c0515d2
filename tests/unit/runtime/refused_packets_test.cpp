#include "runtime/refused_packets.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "tests/support/kept_rows.hpp"

namespace hybridtest {
namespace {

TEST(RefusedPackets, NothingIsSaidWhereNoneWasRefused) {
  EXPECT_EQ(refused_packets_text({.overflowed = 1, .malformed = 2, .unsent = 3, .deadlines_missed = 4}), "");
}

TEST(RefusedPackets, EachKindIsToldWithItsNumber) {
  TransportCounters counters;
  counters.refused_harmful = 3;
  EXPECT_EQ(refused_packets_text(counters),
            "packets refused by the packet filter: 3 that would hang or end the process (docs/security.md)");
  counters.refused_in_plain_text = 120;
  counters.refused_announcements = 1;
  EXPECT_EQ(
      refused_packets_text(counters),
      "packets refused by the packet filter: 120 in plain text, 1 that announce falsely or in the name of another, "
      "3 that would hang or end the process (docs/security.md)");
}

TEST(RefusedPackets, NoticesOfLeavingAreToldAsUsual) {
  EXPECT_EQ(refused_packets_text({.refused_departures = 2}),
            "packets refused by the packet filter: 2 that say that a participant has left (each sends some when it "
            "leaves) (docs/security.md)");
}

TEST(RefusedPackets, RowHasEachKindInItsColumn) {
  TransportCounters counters;
  counters.refused_harmful = 3;
  counters.refused_in_plain_text = 120;
  counters.refused_announcements = 1;
  counters.refused_departures = 2;
  KeptRows rows{refused_packets_table()};
  record_refused_packets(counters, rows);
  EXPECT_EQ(rows.column_values("harmful"), std::vector{3.0});
  EXPECT_EQ(rows.column_values("in_plain_text"), std::vector{120.0});
  EXPECT_EQ(rows.column_values("announcements"), std::vector{1.0});
  EXPECT_EQ(rows.column_values("departures"), std::vector{2.0});
}

}  // namespace
}  // namespace hybridtest
