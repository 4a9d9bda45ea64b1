// What this process has used so far, for `--log-level debug` and benchmarks. Never part of a manifest: the same input
// gives the same bytes.
#pragma once
#include <string>

namespace gonio {

struct Usage {
  double seconds = 0;            // by the clock, since an arbitrary moment
  double processor_seconds = 0;  // of all threads
  double peak_mib = 0;           // of resident memory
};
Usage usage_so_far();

// "1.23 s, processor 2.31 s, peak 512 MiB": since `before`, but for the peak, which is the process's.
std::string usage_since(const Usage& before);

}  // namespace gonio
