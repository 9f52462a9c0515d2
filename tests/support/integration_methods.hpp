#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "coordinator/integrators/alpha_operator_splitting.hpp"
#include "coordinator/integrators/central_difference.hpp"
#include "coordinator/integrators/explicit_newmark.hpp"
#include "coordinator/integrators/generalised_alpha.hpp"
#include "coordinator/integrators/implicit_newmark.hpp"
#include "coordinator/integrators/kr_alpha.hpp"
#include "coordinator/integrators/rosenbrock_w.hpp"

namespace hybridtest::test {

/// An integrator under test, with the parameters that the tests look at.
struct IntegrationMethod {
  std::string name;
  IntegratorNeeds needs;
  std::function<std::unique_ptr<Integrator>(const LinearStructure& structure, double step_s,
                                            const InitialMotion& initial)>
      make;
};

inline void PrintTo(const IntegrationMethod& method, std::ostream* stream) { *stream << method.name; }

template <typename Method>
IntegrationMethod method(const std::string& name) {
  return {name, Method::kNeeds, [](const LinearStructure& structure, double step_s, const InitialMotion& initial) {
            return std::make_unique<Method>(structure, step_s, initial);
          }};
}

template <typename Method>
IntegrationMethod method(const std::string& name, const typename Method::Parameters& parameters) {
  return {name, Method::needs(parameters),
          [parameters](const LinearStructure& structure, double step_s, const InitialMotion& initial) {
            return std::make_unique<Method>(parameters, structure, step_s, initial);
          }};
}

inline IntegrationMethod cr() { return method<KrAlpha>("cr", {.rho_inf = 1.0}); }
inline IntegrationMethod kr_alpha(double rho_inf) {
  return method<KrAlpha>("kr_alpha_" + std::to_string(std::lround(100.0 * rho_inf)), {.rho_inf = rho_inf});
}
inline IntegrationMethod operator_splitting(double alpha) {
  return method<AlphaOperatorSplitting>("operator_splitting_" + std::to_string(std::lround(-100.0 * alpha)),
                                        {.alpha = alpha});
}
inline IntegrationMethod generalised_alpha(double rho_inf, int iterations) {
  return method<GeneralisedAlpha>(
      "generalised_alpha_" + std::to_string(std::lround(100.0 * rho_inf)) + "_" + std::to_string(iterations),
      {.rho_inf = rho_inf, .iterations = iterations});
}
inline IntegrationMethod implicit_newmark() { return method<ImplicitNewmark>("implicit_newmark", {}); }
inline IntegrationMethod rosenbrock_w() { return method<RosenbrockW>("rosenbrock_w"); }

inline std::vector<IntegrationMethod> explicit_methods() {
  return {method<CentralDifference>("central_difference"), method<ExplicitNewmark>("explicit_newmark")};
}
inline std::vector<IntegrationMethod> methods_with_initial_stiffness() {
  return {cr(),
          kr_alpha(0.8),
          kr_alpha(0.5),
          kr_alpha(0.0),
          operator_splitting(0.0),
          operator_splitting(-0.1),
          operator_splitting(-1.0 / 3.0),
          generalised_alpha(0.8, 2),
          generalised_alpha(0.5, 3),
          rosenbrock_w()};
}
inline std::vector<IntegrationMethod> all_methods() {
  std::vector<IntegrationMethod> all = explicit_methods();
  all.push_back(implicit_newmark());
  for (IntegrationMethod& one : methods_with_initial_stiffness()) all.push_back(std::move(one));
  return all;
}

}  // namespace hybridtest::test
