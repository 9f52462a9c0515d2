#include "diagnosis/replay.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "diagnosis/identification/continuation.hpp"
#include "diagnosis/identification/segment.hpp"
#include "diagnosis/identification/smoothing_choice.hpp"
#include "diagnosis/signals/signals.hpp"

namespace hybridtest {

namespace {

ReplayedChannel replayed(const SiteModel& model, const Segment& segment) {
  ReplayedChannel channel{.interface = name_of(segment.interface),
                          .from = segment.from,
                          .to = segment.to,
                          .predicted = predict(model, segment)};
  std::vector<double> residual(segment.measured.size());
  for (std::size_t i = 0; i < residual.size(); ++i) residual[i] = segment.measured[i] - channel.predicted[i];
  const double output = mean_square(segment.measured);
  if (output > 0.0) {
    channel.nrmse = std::sqrt(mean_square(residual) / output);
    channel.floor_nrmse = noise_floor(segment, input_errors(model, segment)) / std::sqrt(output);
  }
  return channel;
}

void share_out(std::vector<ReplayedChannel>& channels) {
  double sum = 0.0;
  for (ReplayedChannel& channel : channels) {
    channel.share = std::max(0.0, channel.nrmse * channel.nrmse - channel.floor_nrmse * channel.floor_nrmse);
    sum += channel.share;
  }
  for (ReplayedChannel& channel : channels) channel.share = sum > 0.0 ? channel.share / sum : 0.0;
}

void append(std::string& text, double value) {
  char digits[32];
  const auto result = std::to_chars(digits, digits + sizeof digits, value);
  text.append(digits, result.ptr);
}

/// A column of the file: its name and what it holds.
struct CsvColumn {
  std::string name;
  const std::vector<double>* values;
};

std::vector<CsvColumn> columns_of(const Recording& recording,
                                  const std::vector<std::vector<ReplayedChannel>>& replays) {
  std::vector<CsvColumn> columns;
  const auto suffix = [&](std::size_t dof) { return recording.dofs.size() > 1 ? "_" + std::to_string(dof + 1) : ""; };
  for (std::size_t dof = 0; dof < recording.dofs.size(); ++dof) {
    for (std::size_t i = 0; i < kChannels; ++i) {
      const auto channel = static_cast<Channel>(i);
      if (!recording.dofs[dof].has(channel)) continue;
      columns.push_back({std::string{column_name(channel)} + suffix(dof), &recording.dofs[dof].of(channel)});
    }
  }
  for (const RecordedChannel& input : recording.inputs) {
    columns.push_back({std::string{kInputPrefix} + input.name, &input.samples});
  }
  for (std::size_t dof = 0; dof < replays.size(); ++dof) {
    for (const ReplayedChannel& channel : replays[dof]) {
      columns.push_back({"predicted_" + std::string{column_name(channel.to)} + suffix(dof), &channel.predicted});
    }
  }
  return columns;
}

}  // namespace

std::vector<ReplayedChannel> replay(const SiteModel& model, const Recording& recording, std::size_t dof,
                                    const Recording* before) {
  std::vector<Segment> segments = modelled_segments(model, recording, dof, 0);
  if (before != nullptr) carry_history(model, *before, dof, segments);
  std::vector<ReplayedChannel> channels;
  for (const Segment& segment : segments) channels.push_back(replayed(model, segment));
  share_out(channels);
  return channels;
}

std::string replay_csv(const Recording& recording, const std::vector<std::vector<ReplayedChannel>>& replays) {
  const std::vector<CsvColumn> columns = columns_of(recording, replays);
  std::string text{recording.is_quasi_static ? "step" : "time_s"};
  for (const CsvColumn& column : columns) text += "," + column.name;
  for (std::size_t i = 0; i < recording.samples; ++i) {
    text += '\n';
    append(text, static_cast<double>(i) * (recording.is_quasi_static ? 1.0 : recording.sample_period_s));
    for (const CsvColumn& column : columns) {
      text += ',';
      append(text, (*column.values)[i]);
    }
  }
  return text + '\n';
}

}  // namespace hybridtest
