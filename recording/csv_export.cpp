#include "recording/csv_export.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <span>
#include <string>

#include "core/faults.hpp"
#include "recording/error.hpp"
#include "recording/read_rows.hpp"
#include "recording/run_file_reader.hpp"
#include "recording/summary/clock_relation.hpp"

namespace hybridtest {
namespace {

void append_number(std::string& text, double value) {
  if (std::isnan(value)) {
    text += "nan";  // to_chars() writes the sign of a NaN, which means nothing here
    return;
  }
  std::array<char, 32> digits{};
  const auto result = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  text.append(digits.data(), result.ptr);
}

/// A file that throws an error when it cannot be written completely.
class CsvFile {
 public:
  explicit CsvFile(std::filesystem::path path) : path_{std::move(path)}, stream_{path_, std::ios::binary} {
    if (!stream_) throw RecordingError{path_.string() + ": cannot be created; check that the directory is writable"};
  }
  void write(const std::string& text) { stream_ << text; }
  void close() {
    stream_.close();
    if (!stream_)
      throw RecordingError{path_.string() + ": could not be written completely; check the free space of the disk"};
  }
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

 private:
  std::filesystem::path path_;
  std::ofstream stream_;
};

void export_table(const RunFileReader& file, const TableLayout& layout, CsvFile& csv) {
  std::string text;
  for (const Column& column : layout.columns) text += (text.empty() ? "" : ",") + column.name;
  csv.write(text + "\n");
  read_rows(file, layout.name, [&](std::span<const double> row) {
    text.clear();
    for (const double value : row) {
      append_number(text, value);
      text += ',';
    }
    text.back() = '\n';
    csv.write(text);
    return true;
  });
}

void export_events(const RunFileReader& file, CsvFile& csv) {
  csv.write("time_s,severity,code,code_name,step,model_time_s,source,subject,value_1,value_2,text\n");
  for (const RecordedEvent& recorded : file.events()) {
    const Event& event = recorded.event;
    std::string text;
    append_number(text, to_seconds(event.clock));
    text += "," + std::to_string(static_cast<int>(event.severity));
    text += "," + std::to_string(static_cast<int>(event.code)) + "," + std::string{name(event.code)};
    text += "," + std::to_string(event.step) + ",";
    append_number(text, event.model_time_s);
    for (const std::string_view word : {event.source.view(), event.subject.view()}) {
      text += ',';
      append_quoted(text, word);
    }
    for (const double value : event.values) {
      text += ',';
      append_number(text, value);
    }
    text += ',';
    append_quoted(text, recorded.text);
    csv.write(text + "\n");
  }
}

void export_file(const std::filesystem::path& run_file, const std::filesystem::path& out_directory,
                 std::vector<std::filesystem::path>& written) {
  const RunFileReader file{run_file};
  const std::string stem = run_file.stem().string();
  for (const TableLayout& layout : file.tables()) {
    CsvFile csv{out_directory / (stem + "." + layout.name + ".csv")};
    export_table(file, layout, csv);
    csv.close();
    written.push_back(csv.path());
  }
  CsvFile csv{out_directory / (stem + ".events.csv")};
  export_events(file, csv);
  csv.close();
  written.push_back(csv.path());
}

/// How the clocks of the participants stand to the coordinator's.
void export_clocks(const std::filesystem::path& coordinator_file, const std::filesystem::path& out_directory,
                   std::vector<std::filesystem::path>& written) {
  const std::vector<ParticipantClock> clocks = participant_clocks(RunFileReader{coordinator_file});
  if (clocks.empty()) return;
  CsvFile csv{out_directory / "clocks.csv"};
  csv.write("participant,begin_s,end_s,at_s,offset_s,offset_uncertainty_s,drift,drift_uncertainty\n");
  for (const ParticipantClock& clock : clocks) {
    for (const ClockRelation& part : clock.parts) {
      std::string text = clock.participant;
      for (const double value : {part.begin_s, part.end_s, part.at_s, part.offset_s, part.offset_uncertainty_s,
                                 part.drift, part.drift_uncertainty}) {
        text += ',';
        append_number(text, value);
      }
      csv.write(text + "\n");
    }
  }
  csv.close();
  written.push_back(csv.path());
}

}  // namespace

void append_quoted(std::string& text, std::string_view value) {
  text += '"';
  for (const char character : value) {
    if (character == '"') text += '"';
    text += character;
  }
  text += '"';
}

std::vector<std::filesystem::path> export_csv(const std::filesystem::path& run_directory,
                                              const std::filesystem::path& out_directory) {
  std::error_code error;
  std::vector<std::filesystem::path> run_files;
  for (const auto& entry : std::filesystem::directory_iterator{run_directory, error}) {
    if (entry.path().extension() == kRunFileExtension) run_files.push_back(entry.path());
  }
  if (run_files.empty()) throw RecordingError{run_directory.string() + ": no run file (*.h5) in this directory"};
  std::filesystem::create_directories(out_directory, error);
  std::vector<std::filesystem::path> written;
  for (const auto& run_file : run_files) {
    export_file(run_file, out_directory, written);
    if (run_file.stem() == kCoordinatorId) export_clocks(run_file, out_directory, written);
  }
  std::sort(written.begin(), written.end());
  return written;
}

}  // namespace hybridtest
