#pragma once

#include <functional>
#include <vector>

namespace hybridtest {

/// Response of a linear system at rest to a command that is zero up to one interval before the
/// first sample and runs straight from sample to sample: a sum of ramps, one for each corner.
/// @param ramp_response   closed form of the answer to u = t from time 0 on; asked for t >= 0.
/// @return one value per sample, taken `delay_s` late.
inline std::vector<double> piecewise_linear_response(const std::vector<double>& command, double interval_s,
                                                     double delay_s,
                                                     const std::function<double(double)>& ramp_response) {
  const auto at = [&](int sample) {
    return sample < 0 || sample >= static_cast<int>(command.size()) ? 0.0 : command[static_cast<std::size_t>(sample)];
  };
  std::vector<double> response;
  for (int i = 0; i < static_cast<int>(command.size()); ++i) {
    double sum = 0.0;
    for (int corner = -1; corner < i; ++corner) {
      const double since_s = (i - corner) * interval_s - delay_s;
      const double bend = (at(corner + 1) - 2.0 * at(corner) + at(corner - 1)) / interval_s;
      if (since_s > 0.0) sum += bend * ramp_response(since_s);
    }
    response.push_back(sum);
  }
  return response;
}

}  // namespace hybridtest
