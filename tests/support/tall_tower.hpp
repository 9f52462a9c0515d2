#pragma once

#include <filesystem>
#include <fstream>
#include <string>

/// A tower of equal storeys with one degree of freedom on each floor, whose columns are a numerical substructure with
/// as wide an interface, or the elastic part in the coordinator.
namespace hybridtest::test::tall_tower {

inline constexpr double kMass_kg = 1.0e3;
inline constexpr double kStorey_n_per_m = 1.0e8;

/// Its mass, its stiffness and its degrees of freedom as files.
inline void write_structure(const std::filesystem::path& directory, int floors) {
  const std::string size = std::to_string(floors);
  std::ofstream mass{directory / "mass.mtx"};
  std::ofstream stiffness{directory / "stiffness.mtx"};
  std::ofstream nothing{directory / "nothing.mtx"};
  std::ofstream dofs{directory / "dofs.csv"};
  mass << "%%MatrixMarket matrix coordinate real symmetric\n" << size << " " << size << " " << size << "\n";
  stiffness << "%%MatrixMarket matrix coordinate real symmetric\n"
            << size << " " << size << " " << std::to_string(2 * floors - 1) << "\n";
  nothing << "%%MatrixMarket matrix coordinate real symmetric\n" << size << " " << size << " 1\n1 1 0\n";
  dofs << "node,direction,name\n";
  for (int floor = 1; floor <= floors; ++floor) {
    const std::string number = std::to_string(floor);
    mass << number << " " << number << " " << kMass_kg << "\n";
    stiffness << number << " " << number << " " << (floor < floors ? 2.0 : 1.0) * kStorey_n_per_m << "\n";
    if (floor > 1) stiffness << number << " " << floor - 1 << " " << -kStorey_n_per_m << "\n";
    dofs << number << ",x,floor_" << number << "\n";
  }
}

/// @param stiffness   name of the file of the elastic part.
/// @param storeys     of the numerical substructure, from the base up.
inline std::filesystem::path write_scenario(const std::filesystem::path& directory, const std::string& stiffness,
                                            int storeys) {
  std::string laws;
  for (int storey = 0; storey < storeys; ++storey) laws += storey == 0 ? "1.0e8" : ", 1.0e8";
  std::ofstream{directory / "motion.csv"} << "time_s,acceleration_m_per_s2\n0,0\n0.05,1\n0.1,0\n0.15,0\n";
  std::filesystem::path file = directory / (stiffness + ".yaml");
  std::ofstream{file} << "schema: hybridtest/1\nname: tower\n"
                         "time: {mode: lockstep, step_s: 0.002, duration_s: 1.0}\n"
                         "excitation: {ground_motion: motion.csv}\n"
                         "structure: {mass: mass.mtx, stiffness: "
                      << stiffness
                      << ".mtx, degrees_of_freedom: dofs.csv, damping: {type: none}}\n"
                         "integrator: {type: central_difference}\nsubstructures:\n"
                         "  - id: columns\n    kind: numerical\n    interface: [{dofs: \"floor_*\"}]\n"
                         "    model: {type: shear_building, storey_stiffness_n_per_m: ["
                      << laws << "]}\n";
  return file;
}

}  // namespace hybridtest::test::tall_tower
