#pragma once

#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

namespace hybridtest {

enum class CheckVerdict : unsigned char { pass, caution, fail };

/// One line of `hybridtest check`.
struct CheckLine {
  CheckVerdict verdict = CheckVerdict::pass;
  std::string section;  // `integrator`, `site storey_1`
  std::string subject;  // `delay margin`
  std::string found;
  std::string change;  // what to do; empty for a pass
};

/// What `hybridtest check` found, line by line.
class CheckReport {
 public:
  explicit CheckReport(std::string test) : test_{std::move(test)} {}

  /// A line in the section begun last.
  void add(CheckVerdict verdict, std::string subject, std::string found, std::string change = {});
  void begin(std::string section) { section_ = std::move(section); }

  [[nodiscard]] CheckVerdict worst() const;
  [[nodiscard]] const std::vector<CheckLine>& lines() const noexcept { return lines_; }

  /// The lines of the last section.
  void print_section(std::FILE* out) const;
  /// Last line of all: the verdict, and how many lines say so.
  void print_verdict(std::FILE* out) const;
  /// @param file   `-`: standard output. @throws ConfigError where it cannot be written.
  void write_json(const std::filesystem::path& file) const;

 private:
  [[nodiscard]] std::ptrdiff_t count(CheckVerdict verdict) const;

  std::string test_;
  std::string section_;
  std::vector<CheckLine> lines_;
};

}  // namespace hybridtest
