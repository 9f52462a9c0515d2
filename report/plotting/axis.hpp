#pragma once

#include <optional>
#include <string>
#include <vector>

namespace hybridtest::plot {

/// The description of one axis of a drawing.
struct Axis {
  std::string label;
  bool is_logarithmic = false;
  std::optional<double> low{};  // from the values where absent
  std::optional<double> high{};
};

struct Tick {
  double value = 0.0;
  std::string label;
};

/// Maps values of an axis onto 0 to 1.
class Scale {
 public:
  /// @param least, most   of the values; limits given by the axis have priority. Positive on a logarithmic axis.
  Scale(const Axis& axis, double least, double most);

  /// 0 at the low end, 1 at the high end; not finite for a value that the axis cannot show.
  [[nodiscard]] double share(double value) const noexcept;
  [[nodiscard]] std::vector<Tick> ticks() const;
  /// The ends of the axis; their logarithms of base 10 on a logarithmic axis.
  [[nodiscard]] double low() const noexcept { return low_; }
  [[nodiscard]] double high() const noexcept { return high_; }

 private:
  bool is_logarithmic_;
  double low_;  // logarithms of base 10 on a logarithmic axis
  double high_;
};

}  // namespace hybridtest::plot
