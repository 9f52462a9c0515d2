#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/config_error.hpp"
#include "core/parameters/range.hpp"

namespace hybridtest::config {

class Document;
class SectionState;
struct DocumentState;

/// A mapping inside a configuration file, read key by key.
///
/// Every reader returns a usable value even after an error, so that one pass finds every error;
/// the errors are collected in the Document. Usable is the fallback or, without one, a small
/// value inside the range (1 where the range has it); lists keep the size asked for, matrices
/// are the identity; names() and sections() leave out what is wrong and may come back empty.
///
/// Reading a key marks it known and records its effective value; finish() reports keys that
/// nobody read, with the nearest known name. Asking twice for the same section gives the same
/// section. Sections are cheap handles on their Document and must not outlive it; moving the
/// Document keeps them valid.
class Section {
 public:
  [[nodiscard]] bool has(std::string_view key) const;
  /// The same for an optional key; messages about unknown keys then list it as known.
  [[nodiscard]] bool has_optional(std::string_view key);
  /// Whether the value of the key is a mapping, where a text or a number is allowed too.
  [[nodiscard]] bool has_mapping(std::string_view key) const;
  /// `substructures[0].rig`, for messages.
  [[nodiscard]] std::string path() const;

  /// Required without a fallback; NaN, infinities and text (a quoted number is text) are errors.
  /// A fallback that is not finite ("no limit") is returned and left out of effective().
  [[nodiscard]] double number(std::string_view key, Range range = kAnyNumber, std::optional<double> fallback = {});
  /// Whether the value of the key is the word `off`, which then is its effective value. Another value or none is
  /// left to the reader of the key.
  [[nodiscard]] bool reads_off(std::string_view key);
  [[nodiscard]] std::int64_t integer(std::string_view key, std::int64_t low, std::int64_t high,
                                     std::optional<std::int64_t> fallback = {});
  [[nodiscard]] bool boolean(std::string_view key, std::optional<bool> fallback = {});
  /// Without a fallback an empty text is an error: it would be a name or a path.
  [[nodiscard]] std::string text(std::string_view key, std::optional<std::string> fallback = {});
  /// One of `choices`, at least one; returns its position. The error lists them and the nearest.
  /// @param fallback   one of the choices.
  [[nodiscard]] std::size_t choice(std::string_view key, const std::vector<std::string>& choices,
                                   std::optional<std::string> fallback = {});
  /// A list of numbers; `size` 0 means any size but empty.
  [[nodiscard]] Eigen::VectorXd numbers(std::string_view key, std::size_t size = 0, Range range = kAnyNumber);
  [[nodiscard]] std::vector<std::int64_t> integers(std::string_view key, std::int64_t low, std::int64_t high);
  /// A list of names, at least one: each a non-empty text, no two alike.
  [[nodiscard]] std::vector<std::string> names(std::string_view key);
  /// A mapping from each of `names` to a number, such as `mass_kg: {floor_1: 20.0e3}`; missing
  /// and unknown names are errors. @return one entry per name, in the order of `names`.
  [[nodiscard]] Eigen::VectorXd numbers_by_name(std::string_view key, const std::vector<std::string>& names,
                                                Range range = kAnyNumber);
  /// A list of rows, all of the same length; `rows` or `columns` 0 means any but none.
  [[nodiscard]] Eigen::MatrixXd matrix(std::string_view key, std::size_t rows, std::size_t columns);
  /// Keys of the mapping in file order (for maps keyed by degree of freedom).
  [[nodiscard]] std::vector<std::string> keys() const;

  /// A required mapping; a missing one is reported and an empty section returned.
  [[nodiscard]] Section section(std::string_view key);
  /// An optional mapping whose keys all have fallbacks: when it is absent, an empty section, from
  /// which the fallbacks go into effective().
  [[nodiscard]] Section section_or_empty(std::string_view key);
  /// An optional mapping; nothing when it is absent or, which is an error, no mapping.
  [[nodiscard]] std::optional<Section> optional_section(std::string_view key);
  /// A required list of mappings, possibly empty; a single mapping is accepted as a list of one if `or_single`.
  [[nodiscard]] std::vector<Section> sections(std::string_view key, bool or_single = false);
  /// As sections(key, true), but when the key is absent a list of one empty section, from which the
  /// fallbacks go into effective() as a list of one.
  [[nodiscard]] std::vector<Section> sections_or_empty(std::string_view key);

  /// The effective values of this section, or of one of its keys, as a separate document; see
  /// Document::effective().
  [[nodiscard]] std::string effective(std::string_view key = {}) const;

  /// Reports at the key (or, with an empty or absent key, at the section itself).
  void error(std::string_view key, std::string what);
  /// Reports every key that was not read. Call once everything known has been asked for.
  void finish();

 private:
  friend class Document;
  explicit Section(std::shared_ptr<SectionState> state) : state_{std::move(state)} {}
  std::shared_ptr<SectionState> state_;
};

/// One configuration file with its overrides; owns the tree, collects the errors.
class Document {
 public:
  /// @param overrides   `key.path=value` or `substructures[0].rig.type=ideal`, `[id]` also
  ///                    selects a list element by its `id` key; value is YAML.
  ///                    A later override wins; the last key of a path may be new.
  /// Duplicate keys, anchors, aliases, tags and overrides that do not fit are collected with the
  /// other errors, so that all are listed at once.
  /// @throws ConfigError when the file cannot be read, is larger than 4 MiB, is not YAML in
  ///         UTF-8, is nested more than 64 deep, or is not one document with a mapping at the top.
  static Document load(const std::filesystem::path& file, const std::vector<std::string>& overrides = {});
  /// The same from text; `name` stands for the file in messages.
  static Document parse(std::string_view text, std::string name, const std::vector<std::string>& overrides = {});

  Document(Document&&) noexcept;
  Document& operator=(Document&&) noexcept;
  ~Document();

  [[nodiscard]] Section root();
  /// Of the file, for relative paths inside it.
  [[nodiscard]] std::filesystem::path directory() const;
  [[nodiscard]] bool has_errors() const;
  /// @throws ConfigError with every error so far, each once, if there is any: in the order of the
  ///         file, those of overrides behind.
  void throw_if_errors() const;
  /// The effective configuration as YAML: every key read, with defaults filled in, in the order
  /// first read. Reading it back gives the same text. Its SHA-256 is the scenario digest.
  [[nodiscard]] std::string effective() const;

 private:
  explicit Document(std::unique_ptr<DocumentState> state);
  std::unique_ptr<DocumentState> state_;
};

}  // namespace hybridtest::config
