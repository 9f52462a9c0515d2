#include "runtime/participant_process.hpp"

int main(int argc, char** argv) {
  return hybridtest::participant_main(argc, argv, hybridtest::Role::numerical_substructure);
}
