#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "core/records.hpp"
#include "recording/run_file.hpp"

namespace hybridtest {

inline RunFileHeader example_header() {
  RunFileHeader header;
  header.participant = "storey_1";
  header.role = Role::experimental_site;
  header.test_name = "two_storey";
  for (std::size_t i = 0; i < header.scenario_digest.size(); ++i) {
    header.scenario_digest[i] = static_cast<std::uint8_t>(7 * i + 200);
  }
  header.incarnation = 0xFFFF'FFFF'FFFF'FFFEULL;
  header.start_time_utc = "2024-03-01T12:00:00Z";
  header.software_version = "0.1.0";
  header.substructure_ids = {"storey_1", "s2"};
  header.structure_dofs = {"floor_1", "floor_2"};
  header.interface_dofs = {"floor_1"};
  header.t0_utc = "2024-03-01T11:59:58.250000Z";
  header.t0_unix_s = 1709294398.25;
  header.model_time_step_s = 0.001;
  return header;
}

inline TableLayout example_layout() {
  return {"steps", {{"step", "-"}, {"model_time_s", "s"}, {"measured_force_n", "N"}}};
}

/// Row `i` of the example table; the values tell the row and the column.
inline std::array<double, 3> example_row(std::size_t i) {
  const auto step = static_cast<double>(i);
  return {step, 0.001 * step, -3.0 * step + 0.1};
}

/// How many leading rows are not what example_row() says; 0 for a faithful recording.
inline std::size_t wrong_rows(std::span<const double> rows) {
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < rows.size() / 3; ++i) {
    const auto expected = example_row(i);
    for (std::size_t k = 0; k < 3; ++k) {
      if (rows[3 * i + k] != expected[k]) {
        ++wrong;
        break;
      }
    }
  }
  return wrong;
}

inline Event example_event() {
  Event event;
  event.source = "storey_1";
  event.incarnation = 12345678901234567890ULL;
  event.severity = Severity::fault;
  event.code = EventCode::interlock_tripped;
  event.step = 4711;
  event.model_time_s = 4.711;
  event.subject = "displacement_limit";
  event.values = {0.1234, 0.12};
  event.clock = Duration{1'234'567'890'123'457};
  return event;
}

}  // namespace hybridtest
