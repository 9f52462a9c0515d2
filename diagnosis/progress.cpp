#include "diagnosis/progress.hpp"

namespace hybridtest {

PartProgress PartProgress::part(double from, double to) const {
  PartProgress inner{sink_};
  inner.from_ = from_ + from * (to_ - from_);
  inner.to_ = from_ + to * (to_ - from_);
  return inner;
}

PartProgress PartProgress::round(std::size_t index, std::size_t rounds) const {
  const double length = 1.0 / static_cast<double>(rounds);
  return part(length * static_cast<double>(index), length * static_cast<double>(index + 1));
}

void PartProgress::report(std::string_view stage, std::size_t done, std::size_t all) const {
  if (!sink_) return;
  const double share = all > 0 ? static_cast<double>(done) / static_cast<double>(all) : 1.0;
  sink_({.stage = stage, .done = done, .all = all, .share = from_ + share * (to_ - from_)});
}

}  // namespace hybridtest
