#pragma once

#include <Eigen/Core>

namespace hybridtest {

/// Most interface degrees of freedom of one substructure. Fixed so that commands and
/// measurements are plain fixed-size data on the wire and the control path never allocates;
/// at 12 a command with its history still fits one Ethernet frame.
inline constexpr int kMaxInterfaceDofs = 12;

/// One value per interface degree of freedom of a substructure; no heap.
using InterfaceVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxInterfaceDofs, 1>;

/// Interface by interface, for stiffness and geometry; no heap.
using InterfaceMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxInterfaceDofs, kMaxInterfaceDofs>;

}  // namespace hybridtest
