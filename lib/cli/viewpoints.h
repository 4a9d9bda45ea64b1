// --viewpoint NAME=X,Y,Z, of programs that take measured clouds.
#pragma once
#include <map>
#include <string>

#include "cli/program.h"
#include "geom/vector.h"

namespace gonio::cli {

Option viewpoint_option();
std::map<std::string, Vec3> viewpoints_m(const Invocation& call);

}  // namespace gonio::cli
