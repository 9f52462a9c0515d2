#pragma once

#include <Eigen/SparseCore>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

/// A shear frame of 10 000 degrees of freedom with two tested columns, as matrices of another program.
namespace hybridtest::test::shear_frame {

using SparseMatrix = Eigen::SparseMatrix<double>;

// A wall of frames side by side, with a mass at every floor of every frame. Columns connect the floors of a frame,
// and floor slabs connect neighbouring frames.
inline constexpr int kFloors = 100;
inline constexpr int kFrames = 100;
inline constexpr int kDofs = kFloors * kFrames;
inline constexpr double kMass_kg = 4.0e3;
inline constexpr double kStorey_n_per_m = 4.0e7;
inline constexpr double kSlab_n_per_m = 1.0e9;
inline constexpr double kYield_n = 2.0e4;
inline constexpr double kHardening = 0.1;
inline constexpr double kRatio = 0.02;
inline constexpr double kStep_s = 0.001;
inline constexpr int kSteps = 3000;

inline int dof_of(int floor, int frame) { return floor * kFrames + frame; }

/// A column that a site tests: between a floor and the one below or the ground.
struct TestedColumn {
  int upper;
  int lower;  // -1: the ground
};
inline constexpr TestedColumn kFirst{0, -1};              // of the first frame, on the ground
inline constexpr TestedColumn kSecond{kFrames + 50, 50};  // of the 51st frame, on its first floor

/// A spring of an elastic structure, and where.
using Entries = std::vector<Eigen::Triplet<double>>;
inline void add_spring(Entries& entries, int upper, int lower, double stiffness_n_per_m) {
  entries.emplace_back(upper, upper, stiffness_n_per_m);
  if (lower < 0) return;
  entries.emplace_back(lower, lower, stiffness_n_per_m);
  entries.emplace_back(upper, lower, -stiffness_n_per_m);
  entries.emplace_back(lower, upper, -stiffness_n_per_m);
}

inline bool is_tested(int upper, int lower) {
  const auto is = [&](const TestedColumn& column) { return upper == column.upper && lower == column.lower; };
  return is(kFirst) || is(kSecond);
}

inline SparseMatrix frame_stiffness(bool with_tested_columns) {
  Entries entries;
  for (int floor = 0; floor < kFloors; ++floor) {
    for (int frame = 0; frame < kFrames; ++frame) {
      const int upper = dof_of(floor, frame);
      const int lower = floor == 0 ? -1 : dof_of(floor - 1, frame);
      if (with_tested_columns || !is_tested(upper, lower)) add_spring(entries, upper, lower, kStorey_n_per_m);
      if (frame > 0) add_spring(entries, upper, upper - 1, kSlab_n_per_m);
    }
  }
  SparseMatrix stiffness(kDofs, kDofs);
  stiffness.setFromTriplets(entries.begin(), entries.end());
  return stiffness;
}

/// The lower triangle, as other programs write it.
inline void write_matrix_market(const std::filesystem::path& file, const SparseMatrix& matrix) {
  std::string text;
  int entries = 0;
  for (int column = 0; column < matrix.outerSize(); ++column) {
    for (SparseMatrix::InnerIterator entry{matrix, column}; entry; ++entry) {
      if (entry.row() < entry.col()) continue;
      text += std::to_string(entry.row() + 1) + " " + std::to_string(entry.col() + 1) + " " +
              std::to_string(entry.value()) + "\n";
      ++entries;
    }
  }
  const std::string size = std::to_string(matrix.rows());
  std::ofstream{file} << "%%MatrixMarket matrix coordinate real symmetric\n"
                      << size << " " << size << " " << entries << "\n"
                      << text;
}

inline std::string site(const std::string& id, const std::string& interface) {
  return "  - id: " + id + "\n    kind: experimental\n    interface: [" + interface +
         "]\n"
         "    initial_stiffness_n_per_m: [[4.0e7]]\n"
         "    rig:\n      type: simulated\n      transfer_system: {type: ideal}\n"
         "      specimen: {type: bilinear, stiffness_n_per_m: 4.0e7, yield_force_n: 2.0e4, hardening_ratio: 0.1}\n"
         "    control_rate_hz: 1000\n"
         "    limits: {displacement_m: 1.0, velocity_m_per_s: 10.0, force_n: 1.0e8}\n";
}

/// The frame as files, and its scenario.
inline std::filesystem::path write_files(const std::filesystem::path& directory) {
  SparseMatrix mass(kDofs, kDofs);
  mass.setIdentity();
  mass *= kMass_kg;
  write_matrix_market(directory / "mass.mtx", mass);
  write_matrix_market(directory / "stiffness.mtx", frame_stiffness(false));
  std::ofstream dofs{directory / "dofs.csv"};
  dofs << "node,direction\n";
  for (int dof = 0; dof < kDofs; ++dof) dofs << dof + 1 << ",x\n";
  std::ofstream{directory / "frame.yaml"}
      << "schema: hybridtest/1\nname: frame\n"
         "time: {mode: lockstep, step_s: 0.001, duration_s: 3.0}\n"
         "excitation: {ground_motion: " HYBRIDTEST_SOURCE_DIR
         "/launch/scenarios/ground_motions/design_ec8_c.AT2, scale: 2.0}\n"
         "structure: {mass: mass.mtx, stiffness: stiffness.mtx, degrees_of_freedom: dofs.csv, "
         "damping: {type: rayleigh, ratio: 0.02, modes: [1, 3]}}\n"
         "integrator: {type: central_difference}\nsubstructures:\n"
      << site("first", "{dof: node 1 dof 1}") << site("second", "{dof: 151.x, relative_to: 51.x}");
  return directory / "frame.yaml";
}

}  // namespace hybridtest::test::shear_frame
