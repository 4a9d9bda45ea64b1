// Internal faults: what the program's own code must never do, and nobody can go on from. SIGSEGV, SIGBUS, SIGFPE,
// SIGILL, SIGABRT, an assertion that fails, an exception that nobody catches (one that leaves a thread, too) and a
// stack that overflows end the program with one line and exit code 70:
//   explain: internal fault: arithmetic that has no result, as a division by zero (SIGFPE); please report it with the
//   call that led to it
// Files that were being written are removed, as after SIGTERM; what stood in their places stays.
//
// Sanitizers report such faults themselves, with more detail: in their builds the signals stay theirs.
#pragma once

namespace gonio {

// For the whole process. The line begins with program_name() as it is now.
void install_fault_handlers();

// A stack that overflowed cannot hold the handler: every thread that computes needs a second one. The first call in a
// thread makes it, later ones return at once. install_fault_handlers() does it for its caller, parallel_for() for its
// workers.
void guard_stack_of_this_thread();

}  // namespace gonio
