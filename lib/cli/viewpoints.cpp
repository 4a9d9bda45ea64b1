#include "cli/viewpoints.h"

#include <array>
#include <charconv>
#include <cmath>

#include "base/error.h"

namespace gonio::cli {
namespace {

// "front=0.1,0,-0.6"
std::pair<std::string, Vec3> viewpoint_of(const std::string& text) {
  const std::size_t equals = text.rfind('=');
  std::array<double, 3> at{};
  bool good = equals != std::string::npos && equals > 0;
  const char *next = text.data() + (good ? equals + 1 : text.size()), *const end = text.data() + text.size();
  for (std::size_t k = 0; k < at.size() && good; ++k) {
    const auto [after, problem] = std::from_chars(next, end, at[k]);
    good = problem == std::errc() && std::isfinite(at[k]) && (k == 2 ? after == end : after != end && *after == ',');
    next = after + 1;
  }
  if (!good)
    throw Error(Exit::usage, "--viewpoint", "\"" + text + "\" is no viewpoint", "VIEW=X,Y,Z in metres: front=0,0,-0.6");
  return {text.substr(0, equals), {at[0], at[1], at[2]}};
}

}  // namespace

Option viewpoint_option() {
  return {.name = "viewpoint",
          .type = Type::text,
          .help =
              "Where the camera of a cloud stood, in the frame of its points, in metres; instead of what images "
              "and rigs say.",
          .metavar = "NAME=X,Y,Z",
          .repeat = true};
}

std::map<std::string, Vec3> viewpoints_m(const Invocation& call) {
  std::map<std::string, Vec3> all;
  for (const std::string& text : call.texts("viewpoint"))
    if (!all.insert(viewpoint_of(text)).second)
      throw Error(Exit::usage, "--viewpoint", "\"" + text + "\" is the second one of its view", "state one");
  return all;
}

}  // namespace gonio::cli
