#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/time.hpp"

namespace hybridtest {

/// What the driver answers, see driver.tcl. In the units of the script.
struct DriverReply {
  enum class Kind : char { ready = 'r', forces = 'f', not_converged = 'n', failed = 'x' };
  Kind kind = Kind::failed;
  double residual = 0.0;   // last norm of the convergence test
  double tolerance = 0.0;  // of that test
  std::vector<double> forces;
  std::string text;
};

/// The two requests to the driver.
enum class DriverRequest : char { trial = 't', step = 's' };

enum class DriverArrival : std::uint8_t { none, reply, ended };

/// A conversation with a driver: one request, then one reply.
class DriverChannel {
 public:
  virtual ~DriverChannel() = default;

  /// @return whether it was sent; otherwise the driver has ended.
  virtual bool send(DriverRequest request, std::span<const double> displacements) noexcept = 0;
  /// @param limit   waits so long at most; zero does not wait.
  [[nodiscard]] virtual DriverArrival take(DriverReply& reply, Duration limit) noexcept = 0;
  /// How its process ended: 128 + signal, or its exit code.
  [[nodiscard]] virtual int exit_code() noexcept = 0;
  /// The end of what it has written, for errors.
  [[nodiscard]] virtual std::string last_words() const = 0;
};

}  // namespace hybridtest
