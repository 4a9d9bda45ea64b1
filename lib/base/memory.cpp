// See memory.h.
#include "base/memory.h"

#include <malloc.h>

namespace gonio {

void keep_freed_memory() {
  constexpr int largest = 1 << 30;
  mallopt(M_MMAP_THRESHOLD, largest);
  mallopt(M_TRIM_THRESHOLD, largest);
  mallopt(M_ARENA_MAX, 2);  // threads' own arenas would map large blocks
}

}  // namespace gonio
