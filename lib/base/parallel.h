// Parallel loops. Results must not depend on the number of threads: a loop body writes only what its own index owns.
#pragma once
#include <cstddef>
#include <functional>

namespace gonio {

void set_threads(int count);  // 0: all that the machine (or its affinity mask) grants
int threads();

// body(i) for first <= i < last, in chunks of `grain`; the first exception is rethrown after the loop has drained.
// Between chunks an interrupt (see atomic_file.h: interrupted()) ends the loop with Error(try_again).
void parallel_for(std::size_t first, std::size_t last, const std::function<void(std::size_t)>& body,
                  std::size_t grain = 1);

}  // namespace gonio
