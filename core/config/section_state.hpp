#pragma once

#include <cstddef>
#include <deque>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <variant>
#include <vector>

#include "core/config/node.hpp"
#include "core/config_error.hpp"

namespace hybridtest::config {

struct DocumentState;

/// Shared by all handles on one section: its node, the values read from it, and their
/// effective form.
class SectionState {
 public:
  /// @param node   a mapping, or null for a section that is not there.
  SectionState(DocumentState& document, const Node* node, std::string path, Place place);

  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  [[nodiscard]] std::string path_of(std::string_view key) const { return joined_path(path_, key); }
  [[nodiscard]] const Place& place() const noexcept { return place_; }
  [[nodiscard]] const Node* node() const noexcept { return node_; }

  /// @return the value of that key, or null.
  [[nodiscard]] const Node* find(std::string_view key) const;
  /// The same, and from now on the key is known.
  [[nodiscard]] const Node* read(std::string_view key);

  /// @return a section of the same document.
  [[nodiscard]] std::shared_ptr<SectionState> open(const Node* node, std::string path, Place place) const;

  using Shared = std::shared_ptr<const SectionState>;
  /// @param missing_section   whose required keys are to complete the report.
  void report(const Place& place, std::string_view path, std::string_view what, Shared missing_section = {});
  /// Reports a required key that is not there. In a section that is itself missing it becomes
  /// part of that report.
  void report_missing(std::string_view key, std::string_view expected, Shared missing_section = {});
  void report_unknown_keys();
  /// @return true when further reports would be dropped; then no name advice is needed.
  [[nodiscard]] bool is_full() const noexcept;

  /// Keeps the effective value, as YAML on one line. The first of a key stands.
  void record(std::string_view key, std::string yaml);
  using Children = std::vector<std::shared_ptr<SectionState>>;
  [[nodiscard]] std::shared_ptr<SectionState> recorded_section(std::string_view key) const;
  [[nodiscard]] const Children* recorded_sections(std::string_view key) const;
  void record_section(std::string_view key, std::shared_ptr<SectionState> section);
  void record_sections(std::string_view key, Children sections);

  /// Keys that were read although the section is missing.
  [[nodiscard]] const std::vector<std::string>& needed() const noexcept { return needed_; }
  /// Appends the effective configuration; nothing when it is empty.
  /// @param only   that key of it; all when empty.
  void write(std::string& out, std::size_t indentation, std::string_view only = {}) const;

 private:
  struct Nothing {};
  using Value = std::variant<Nothing, std::string, std::shared_ptr<SectionState>, Children>;
  struct Record {
    std::string key;
    Value value;
  };

  [[nodiscard]] const Value* recorded(std::string_view key) const;
  /// @return the record of a key that was read before.
  [[nodiscard]] Value& value_of(std::string_view key);
  void keep(std::string_view key, Value value);

  DocumentState& document_;
  const Node* node_;
  std::string path_;
  Place place_;
  std::unordered_map<std::string_view, const Node*> children_;
  std::vector<Record> records_;  // in the order first read
  std::unordered_map<std::string, std::size_t> position_of_key_;
  std::vector<std::string> needed_;
};

/// The tree, the errors and the root of one Document.
struct DocumentState {
  /// An error; for a missing section with the keys that were required later.
  struct Issue {
    Finding finding;
    std::shared_ptr<const SectionState> missing_section;
  };

  /// @return false when the error is known already or there are too many.
  bool report(Finding finding, std::shared_ptr<const SectionState> missing_section = {});
  [[nodiscard]] bool is_full() const noexcept;
  /// Every error, sorted.
  [[nodiscard]] std::vector<ConfigIssue> config_issues() const;

  std::deque<Source> sources;  // stable addresses
  Node root;
  std::vector<Issue> issues;
  std::unordered_set<std::string> known_issues;
  std::shared_ptr<SectionState> root_section;
  std::filesystem::path directory;
};

}  // namespace hybridtest::config
