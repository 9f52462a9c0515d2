#include "launch/commands.hpp"
namespace hybridtest { void add_study_command(CLI::App&, CommandAction&) {} }
