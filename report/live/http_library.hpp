#pragma once

#include <httplib.h>

// A header of the system behind it makes a macro of a name that Eigen uses.
#undef _res
