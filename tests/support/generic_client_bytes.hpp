#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <span>
#include <string>
#include <vector>

// What an element genericClient of OpenSees sends, for a client of our own. The shapes are those of OpenSees 3.8.0.
namespace hybridtest::generic_client {

using Bytes = std::vector<std::byte>;

/// Doubles in a message when the model gives no -dataSize.
inline constexpr int kDataSize = 256;

inline Bytes sizes(const std::array<std::int32_t, 11>& values) {
  Bytes bytes(sizeof values);
  std::memcpy(bytes.data(), values.data(), sizeof values);
  return bytes;
}
inline Bytes sizes(std::int32_t n, std::int32_t data_size = kDataSize) {
  return sizes({n, n, n, 0, 1, 0, 0, 0, n, 0, data_size});
}

/// A message that begins with these values; the rest is left over from an older one.
inline Bytes message(std::span<const double> begin, int data_size = kDataSize, double left_over = 0.0) {
  std::vector<double> values(static_cast<std::size_t>(data_size), left_over);
  std::ranges::copy(begin, values.begin());
  Bytes bytes(values.size() * sizeof(double));
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}
inline Bytes message(double action, int data_size = kDataSize, double left_over = 0.0) {
  return message(std::span{&action, 1}, data_size, left_over);
}

/// All displacements, velocities and accelerations of a trial are alike.
inline Bytes trial(int n, double displacement_m, double velocity_m_per_s = 0.0, double acceleration_m_per_s2 = 0.0,
                   double time_s = 0.0, int data_size = kDataSize) {
  std::vector<double> values{3.0};
  for (const double value : {displacement_m, velocity_m_per_s, acceleration_m_per_s2}) {
    values.insert(values.end(), static_cast<std::size_t>(n), value);
  }
  values.push_back(time_s);
  return message(values, data_size);
}

inline Bytes operator+(Bytes first, const Bytes& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

inline std::vector<double> doubles(std::span<const std::byte> bytes) {
  std::vector<double> values(bytes.size() / sizeof(double));
  std::memcpy(values.data(), bytes.data(), values.size() * sizeof(double));
  return values;
}

/// What OpenSees asks in one step of an analysis with one element.
struct StepSequence {
  std::string name;
  std::vector<int> actions;
};

/// docs/opensees.md shows them; a test compares both with a running OpenSees.
inline const std::vector<StepSequence>& step_sequences() {
  static const std::vector<StepSequence> sequences{
      {"Newmark with Linear", {3, 13, 14, 10, 14, 3, 5}},
      {"CentralDifference", {3, 14, 10, 14, 3, 5}},
      {"AlphaOS", {3, 13, 14, 10, 14, 3, 5}},
      {"Newmark with Newton", {3, 10, 14, 13, 14, 3, 10, 14, 5}},
      {"NewmarkHSFixedNumIter with Linear", {13, 14, 10, 14, 3, 13, 14, 5}},
  };
  return sequences;
}

}  // namespace hybridtest::generic_client
