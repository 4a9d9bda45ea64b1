// The files that atomic_file.cpp is about to put in place, and what they are called until then.
#pragma once
#include <filesystem>

namespace gonio {

// Removes those that have a name. Safe in a signal handler: no allocation, no lock.
void remove_temporaries() noexcept;

// ".stem.pid-n.ext" beside the target; a long stem is cut to keep within the 255 bytes of a file name.
std::filesystem::path temporary_for(const std::filesystem::path& target);

}  // namespace gonio
