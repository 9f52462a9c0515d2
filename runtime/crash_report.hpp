#pragma once

namespace hybridtest {

/// From now on a process that a fault ends (SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT) first writes to its standard
/// error which calls led there, so that a crash which cannot be repeated can still be found. It ends by the signal all
/// the same. Does nothing where something else, such as a sanitizer, already does that.
void report_crashes() noexcept;

}  // namespace hybridtest
