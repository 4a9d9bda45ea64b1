// The files that atomic_file.cpp is about to put in place.
#pragma once

namespace gonio {

// Removes those that have a name. Safe in a signal handler: no allocation, no lock.
void remove_temporaries() noexcept;

}  // namespace gonio
