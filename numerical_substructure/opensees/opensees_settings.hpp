#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "numerical_substructure/opensees/tuning.hpp"

namespace hybridtest {

/// A degree of freedom of an OpenSees model, numbered as there: from 1.
struct OpenSeesDof {
  int node = 0;
  int dof = 1;
  bool is_rotation = false;  // [rad] and moments, which units of length enter in another way
};

/// A substructure whose model is a Tcl script of OpenSees.
struct OpenSeesSettings {
  std::string program;           // see find_opensees()
  std::filesystem::path script;  // it runs in the folder of the script
  std::vector<OpenSeesDof> interface;
  double length_unit_m = 1.0;  // a unit of length of the script, in metres
  double force_unit_n = 1.0;   // likewise, in newtons
  double tolerance_m = kOpenSeesTolerance_m;
  double step_s = 0.0;  // of the test: the time of the domain, and so of recorders, advances by it
  Duration answer_timeout = from_seconds(kOpenSeesAnswer_s);
  std::optional<Eigen::MatrixXd> initial_stiffness_n_per_m = {};  // empty: asked from the model
};

}  // namespace hybridtest
