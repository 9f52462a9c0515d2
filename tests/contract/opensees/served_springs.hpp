#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "coordinator/opensees/generic_client_server.hpp"

namespace hybridtest {

/// A server whose elements are linear springs, and the thread that answers for them.
class ServedSprings {
 public:
  explicit ServedSprings(std::vector<Eigen::MatrixXd> stiffness_n_per_m, std::vector<Eigen::MatrixXd> mass_kg = {})
      : stiffness_{std::move(stiffness_n_per_m)},
        trial_(stiffness_.size()),
        server_{"127.0.0.1", "127.0.0.1", elements(mass_kg), [this] {
                  const std::lock_guard lock{mutex_};
                  is_called_ = true;
                  called_.notify_one();
                }} {
    for (std::size_t i = 0; i < trial_.size(); ++i) trial_[i] = Eigen::VectorXd::Zero(stiffness_[i].rows());
  }

  [[nodiscard]] GenericClientServer& server() noexcept { return server_; }
  [[nodiscard]] std::uint16_t port(std::size_t element = 0) const { return server_.port(element); }
  /// The displacements of the trials of an element so far.
  [[nodiscard]] const std::vector<Eigen::VectorXd>& trials() const noexcept { return trials_; }

  /// @return nothing when none comes within 10 s.
  [[nodiscard]] std::optional<ElementRequest> next() {
    ElementRequest request;
    for (;;) {
      if (server_.take(request)) return request;
      std::unique_lock lock{mutex_};
      if (!called_.wait_for(lock, std::chrono::seconds{10}, [this] { return is_called_; })) return {};
      is_called_ = false;
    }
  }
  /// Answers as springs until a request of this kind of `count` elements. @return it, or nothing when none comes.
  [[nodiscard]] std::optional<ElementRequest> answer_until(ElementRequest::Kind kind, int count = 1) {
    while (auto request = next()) {
      const auto element = static_cast<std::size_t>(request->element);
      if (request->kind == ElementRequest::Kind::trial) {
        trial_[element] = request->displacement_m;
        trials_.push_back(request->displacement_m);
      } else if (request->kind == ElementRequest::Kind::force) {
        server_.answer_force(request->element, stiffness_[element] * trial_[element]);
      }
      if (request->kind == kind && --count == 0) return request;
    }
    return {};
  }

 private:
  [[nodiscard]] std::vector<ServedElement> elements(const std::vector<Eigen::MatrixXd>& mass_kg) const {
    std::vector<ServedElement> elements;
    for (std::size_t i = 0; i < stiffness_.size(); ++i) {
      const Eigen::MatrixXd zero = Eigen::MatrixXd::Zero(stiffness_[i].rows(), stiffness_[i].rows());
      elements.push_back({0, {stiffness_[i], zero, mass_kg.empty() ? zero : mass_kg[i]}});
    }
    return elements;
  }

  std::vector<Eigen::MatrixXd> stiffness_;
  std::vector<Eigen::VectorXd> trial_;
  std::vector<Eigen::VectorXd> trials_;
  std::mutex mutex_;
  std::condition_variable called_;
  bool is_called_ = false;
  GenericClientServer server_;
};

}  // namespace hybridtest
