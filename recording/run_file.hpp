#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/messages.hpp"

/// The content of a run file besides its tables; shared by the writer and the reader.
namespace hybridtest {

/// The attribute `schema` of every run file.
inline constexpr std::string_view kRunFileSchema = "hybridtest/run/1";
inline constexpr std::string_view kRunFileExtension = ".h5";

/// What a table holds and how its rows follow each other: attributes of its dataset, for tools that read the file.
struct TableNote {
  std::string table;
  std::string description;         // one or two sentences
  std::string time_column;         // whose values grow by the same interval from row to row; empty without one
  double sample_interval_s = 0.0;  // [s] that interval; 0 without one
  bool operator==(const TableNote&) const = default;
};

/// Who wrote the file, and of which test: the attributes of a run file.
struct RunFileHeader {
  std::string participant;  // `coordinator` or the substructure's id
  Role role = Role::operator_tool;
  std::string test_name;
  ScenarioDigest scenario_digest{};
  Incarnation incarnation = 0;
  std::string start_time_utc;  // ISO 8601, given by the caller: nothing here reads a clock
  std::string software_version;
  std::vector<std::string> substructure_ids;  // in the scenario's order: index of `exchanges.substructure`
  std::vector<std::string> structure_dofs;    // of the structure, those in the record
  std::vector<std::string> interface_dofs;    // of this substructure; empty for the coordinator
  // When the participant's clock stood at zero, so that times of events are absolute. None in files of older versions.
  std::string t0_utc{};                  // ISO 8601
  double t0_unix_s = 0.0;                // [s] since 1970-01-01T00:00:00Z
  double model_time_step_s = 0.0;        // [s]
  std::vector<TableNote> table_notes{};  // in the order of the tables
  bool operator==(const RunFileHeader&) const = default;
};

/// One row of `/counters`.
struct TableCounter {
  std::string table;
  std::uint64_t rows = 0;          // safely in the file at the last flush
  std::uint64_t dropped_rows = 0;  // dropped; anything but 0 makes the data invalid
  bool operator==(const TableCounter&) const = default;
};

/// `/counters` and `/state`.
struct RunFileCounters {
  std::vector<TableCounter> tables;  // one per table, then `events`
  std::uint64_t flushes = 0;
  bool closed_cleanly = false;  // false while being written, and always after a kill
  bool write_failed = false;    // disk full or file error

  [[nodiscard]] std::uint64_t dropped_rows() const noexcept {
    std::uint64_t sum = 0;
    for (const TableCounter& counter : tables) sum += counter.dropped_rows;
    return sum;
  }
};

/// An event as recorded, with the sentence that was made of it.
struct RecordedEvent {
  Event event;
  std::string text;
};

[[nodiscard]] std::string_view name(Role role) noexcept;
/// @return operator_tool for a name that is not known.
[[nodiscard]] Role role_from_name(std::string_view text) noexcept;
/// 64 hexadecimal digits.
[[nodiscard]] std::string hex(const ScenarioDigest& digest);
/// @return all zero for a text that is not 64 hexadecimal digits.
[[nodiscard]] ScenarioDigest digest_from_hex(std::string_view text) noexcept;

}  // namespace hybridtest
