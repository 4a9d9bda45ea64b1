// The program's memory, as the system gives it.
#pragma once

namespace gonio {

// From here on memory that was freed is kept for what comes next: of a program that reads one large picture after the
// other the system would clear every page of each anew, a third of the reading. Peaks grow by what lies between.
void keep_freed_memory();

}  // namespace gonio
