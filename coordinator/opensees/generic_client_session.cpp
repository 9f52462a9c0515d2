#include "coordinator/opensees/generic_client_session.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <utility>

#include "core/assert.hpp"

namespace hybridtest {
namespace {

constexpr std::size_t kSizes = 11;

enum class Action {
  trial = 3,
  commit = 5,
  force = 10,
  initial_stiffness = 12,
  tangent_stiffness = 13,
  damping = 14,
  mass = 15,
  die = 99,
};

}  // namespace

GenericClientSession::GenericClientSession(ElementMatrices matrices)
    : matrices_{std::move(matrices)}, dofs_{matrices_.stiffness_n_per_m.rows()} {
  HYBRIDTEST_ASSERT(dofs_ > 0);
  for (const Eigen::MatrixXd* matrix :
       {&matrices_.stiffness_n_per_m, &matrices_.damping_n_s_per_m, &matrices_.mass_kg}) {
    HYBRIDTEST_ASSERT(matrix->rows() == dofs_ && matrix->cols() == dofs_);
  }
}

void GenericClientSession::receive(std::span<const std::byte> bytes, std::vector<ElementRequest>& requests) {
  while (!bytes.empty() && !fault_ && !is_over_) {
    const std::size_t taken = std::min(wanted_bytes() - arrived_.size(), bytes.size());
    arrived_.insert(arrived_.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(taken));
    bytes = bytes.subspan(taken);
    if (arrived_.size() < wanted_bytes()) return;
    if (is_connected()) {
      read_message(requests);
    } else {
      read_sizes(requests);
    }
    arrived_.clear();
  }
}

std::size_t GenericClientSession::wanted_bytes() const noexcept {
  return is_connected() ? static_cast<std::size_t>(data_size_) * sizeof(double) : kSizes * sizeof(std::int32_t);
}

void GenericClientSession::read_sizes(std::vector<ElementRequest>& requests) {
  std::array<std::int32_t, kSizes> sizes{};
  std::memcpy(sizes.data(), arrived_.data(), arrived_.size());
  const std::int32_t n = sizes[0];
  const std::array<std::int32_t, 10> expected{n, n, n, 0, 1, 0, 0, 0, n, 0};
  const std::int32_t data_size = sizes.back();
  if (n < 1 || n > kDataSizeMax || !std::equal(expected.begin(), expected.end(), sizes.begin()) ||
      data_size > kDataSizeMax) {
    fault_ = ClientFault::other_protocol;
  } else if (n != dofs_) {
    fault_ = ClientFault::other_size;
  } else if (data_size < 3 * n + 2 || data_size < n * n) {
    fault_ = ClientFault::short_messages;
  } else {
    data_size_ = data_size;
    message_.resize(static_cast<std::size_t>(data_size));
    requests.emplace_back().kind = ElementRequest::Kind::connected;
  }
}

void GenericClientSession::read_message(std::vector<ElementRequest>& requests) {
  std::memcpy(message_.data(), arrived_.data(), arrived_.size());
  using Kind = ElementRequest::Kind;
  const double number = message_[0];
  // Not a number compares with nothing.
  const bool is_action = number >= 0.0 && number < 256.0 && number == std::floor(number);
  switch (is_action ? static_cast<Action>(static_cast<int>(number)) : Action{}) {
    case Action::trial: {
      ElementRequest& request = requests.emplace_back();
      request.kind = Kind::trial;
      const Eigen::Map<const Eigen::VectorXd> values{message_.data() + 1, 3 * dofs_ + 1};
      request.displacement_m = values.segment(0, dofs_);
      request.velocity_m_per_s = values.segment(dofs_, dofs_);
      request.acceleration_m_per_s2 = values.segment(2 * dofs_, dofs_);
      request.time_s = values[3 * dofs_];
      return;
    }
    case Action::commit: requests.emplace_back().kind = Kind::commit; return;
    case Action::force:
      is_asked_ = true;
      requests.emplace_back().kind = Kind::force;
      return;
    case Action::initial_stiffness:
    case Action::tangent_stiffness: answer(matrices_.stiffness_n_per_m.reshaped()); return;
    case Action::damping: answer(matrices_.damping_n_s_per_m.reshaped()); return;
    case Action::mass: answer(matrices_.mass_kg.reshaped()); return;
    case Action::die:
      is_over_ = true;
      requests.emplace_back().kind = Kind::die;
      return;
  }
  fault_ = ClientFault::other_message;
}

bool GenericClientSession::answer_force(const Eigen::Ref<const Eigen::VectorXd>& force_n) {
  if (!std::exchange(is_asked_, false) || force_n.size() != dofs_) return false;
  answer(force_n);
  return true;
}

void GenericClientSession::answer(const Eigen::Ref<const Eigen::VectorXd>& values) {
  const std::size_t begin = output_.size();
  output_.resize(begin + static_cast<std::size_t>(data_size_) * sizeof(double));
  std::memcpy(output_.data() + begin, values.data(), static_cast<std::size_t>(values.size()) * sizeof(double));
}

std::vector<std::byte> GenericClientSession::take_output() { return std::exchange(output_, {}); }

}  // namespace hybridtest
