// The world of sealed boards, in this executable too.
#include "explain/board_world.cpp"  // NOLINT(bugprone-suspicious-include)
