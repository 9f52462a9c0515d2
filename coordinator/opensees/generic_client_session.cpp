#include "coordinator/opensees/generic_client_session.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "core/assert.hpp"

namespace hybridtest {
namespace {

using Sizes = std::array<std::int32_t, 11>;

/// Of a message, in doubles (8 MiB): a full matrix of 1024 degrees of freedom.
constexpr std::int64_t kLargestMessage = std::int64_t{1} << 20;

/// Action of a message, in its first double.
enum class Action : std::uint8_t {
  trial = 3,
  commit = 5,
  force = 10,
  initial_stiffness = 12,
  tangent_stiffness = 13,
  damping = 14,
  mass = 15,
  die = 99,
};

[[nodiscard]] Action action_of(double value) noexcept {
  // A value outside the range of the enumeration, or no number, becomes an action that there is not.
  return value >= 0.0 && value <= 255.0 && value == std::floor(value) ? static_cast<Action>(value) : Action{};
}

}  // namespace

GenericClientSession::GenericClientSession(const ElementMatrices& matrices)
    : matrices_{matrices}, size_{matrices.stiffness_n_per_m.rows()}, message_(sizeof(Sizes)) {
  for (const Eigen::MatrixXd* matrix : {&matrices.stiffness_n_per_m, &matrices.damping_n_s_per_m, &matrices.mass_kg}) {
    HYBRIDTEST_ASSERT(matrix->rows() == size_ && matrix->cols() == size_);
  }
}

GenericClientSession::Outcome GenericClientSession::take(std::span<const std::byte>& bytes, ElementRequest& request) {
  if (fault_ != ClientFault::unknown) return Outcome::fault;
  if (has_ended_) {
    bytes = {};
    return Outcome::incomplete;
  }
  const std::size_t count = std::min(bytes.size(), message_.size() - filled_);
  std::ranges::copy(bytes.first(count), message_.begin() + static_cast<std::ptrdiff_t>(filled_));
  bytes = bytes.subspan(count);
  filled_ += count;
  if (filled_ < message_.size()) return Outcome::incomplete;
  filled_ = 0;
  return is_open_ ? read_message(request) : read_sizes(request);
}

GenericClientSession::Outcome GenericClientSession::read_sizes(ElementRequest& request) {
  Sizes sizes;
  std::memcpy(sizes.data(), message_.data(), sizeof sizes);
  const std::int32_t n = sizes[0];
  const std::int64_t values = sizes[10];
  const Sizes expected{n, n, n, 0, 1, 0, 0, 0, n, 0, sizes[10]};
  if (n < 1 || sizes != expected || values > kLargestMessage) return fail(ClientFault::other_protocol);
  if (n != size_) return fail(ClientFault::other_size, n);
  // OpenSees makes its messages at least as large as a trial and as a matrix.
  const auto fewest = std::max<std::int64_t>(2 + 3 * size_, size_ * size_);
  if (values < fewest) return fail(ClientFault::short_messages, sizes[10]);
  const auto count = static_cast<std::size_t>(values);
  values_.assign(count, 0.0);
  reply_.assign(count, 0.0);
  force_reply_.assign(count, 0.0);
  message_.resize(count * sizeof(double));
  is_open_ = true;
  request.kind = ElementRequest::Kind::connected;
  return Outcome::request;
}

GenericClientSession::Outcome GenericClientSession::read_message(ElementRequest& request) {
  std::memcpy(values_.data(), message_.data(), message_.size());
  const auto matrix = [&](const Eigen::MatrixXd& values) {
    std::copy_n(values.data(), values.size(), reply_.begin());  // both are column-major
    return Outcome::reply;
  };
  const auto plain = [&](ElementRequest::Kind kind) {
    request.kind = kind;
    return Outcome::request;
  };
  switch (action_of(values_[0])) {
    case Action::trial: return read_trial(request);
    case Action::commit: return plain(ElementRequest::Kind::commit);
    case Action::force: return plain(ElementRequest::Kind::force);
    case Action::initial_stiffness:
    case Action::tangent_stiffness: return matrix(matrices_.stiffness_n_per_m);
    case Action::damping: return matrix(matrices_.damping_n_s_per_m);
    case Action::mass: return matrix(matrices_.mass_kg);
    case Action::die: has_ended_ = true; return plain(ElementRequest::Kind::die);
  }
  return fail(ClientFault::other_message, values_[0]);
}

GenericClientSession::Outcome GenericClientSession::read_trial(ElementRequest& request) {
  const std::span<const double> used{values_.data(), static_cast<std::size_t>(2 + 3 * size_)};
  if (!std::ranges::all_of(used, [](double value) { return std::isfinite(value); })) {
    return fail(ClientFault::not_finite);
  }
  const Eigen::Map<const Eigen::VectorXd> values{values_.data() + 1, 3 * size_ + 1};
  request.kind = ElementRequest::Kind::trial;
  request.displacement_m = values.head(size_);
  request.velocity_m_per_s = values.segment(size_, size_);
  request.acceleration_m_per_s2 = values.segment(2 * size_, size_);
  request.time_s = values[3 * size_];
  return Outcome::request;
}

GenericClientSession::Outcome GenericClientSession::fail(ClientFault fault, double given) noexcept {
  fault_ = fault;
  given_ = given;
  return Outcome::fault;
}

std::span<const std::byte> GenericClientSession::force_reply(
    const Eigen::Ref<const Eigen::VectorXd>& force_n) noexcept {
  HYBRIDTEST_ASSERT(is_open_ && force_n.size() == size_);
  std::ranges::copy(force_n, force_reply_.begin());
  return std::as_bytes(std::span{force_reply_});
}

}  // namespace hybridtest
