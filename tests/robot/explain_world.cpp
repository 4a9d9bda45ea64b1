// The world of sealed robot cells, in this executable too.
#include "explain/robot_world.cpp"  // NOLINT(bugprone-suspicious-include)
