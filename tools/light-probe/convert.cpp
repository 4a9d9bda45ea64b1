// See convert.h.
#include "tools/light-probe/convert.h"

#include <algorithm>
#include <cmath>

#include "base/atomic_file.h"
#include "base/error.h"
#include "io/codes.h"
#include "io/picture.h"
#include "probe/remap.h"

namespace gonio::tools::light_probe {
namespace {

using cli::Type;
using probe::Projection;

const std::vector<std::string> projections(probe::projection_names.begin(), probe::projection_names.end());

Projection chosen(const cli::Invocation& call, const char* option) {
  return static_cast<Projection>(std::ranges::find(projections, call.text(option)) - projections.begin());
}

io::Image colours_of(const std::string& file) {
  if (io::code_bits(file) != 0)
    throw Error(Exit::data, file, "holds codes of 8 or 16 bits, and light is conserved in linear pictures alone",
                "give OpenEXR");
  io::Image picture = io::read_picture(file);
  for (const float v : picture.data)
    if (!std::isfinite(v)) throw Error(Exit::data, file, "holds values that are not finite", "mend the picture");
  return picture;
}

}  // namespace

std::vector<cli::Option> convert_options() {
  return {{.name = "convert",
           .type = Type::choice,
           .help = "Take the first PICTURE, which lies in this projection of the sphere, to the one of --to, and write "
                   "the second. Its light is conserved.",
           .metavar = "PROJECTION",
           .choices = projections,
           .conflicts = {"radius", "orthographic", "lights", "silhouette", "circle", "mask", "scale", "each"},
           .needs = {"to"}},
          {.name = "to",
           .type = Type::choice,
           .help = "Projection of the new picture.",
           .metavar = "PROJECTION",
           .choices = projections,
           .needs = {"convert"}},
          {.name = "height",
           .type = Type::integer,
           .help = "Rows of the new picture. Default: about as many pixels as the old one.",
           .lower = 4,
           .upper = 8192,
           .needs = {"convert"}}};
}

void check_convert(cli::Invocation& call) {
  if (!call.given("PICTURE") || call.texts("PICTURE").size() != 2)
    throw Error(Exit::usage, "PICTURE", "--convert takes two, the old and the new one",
                "light-probe --convert angular --to lat-long OLD.exr NEW.exr");
  const std::string& to = call.texts("PICTURE")[1];
  if (std::filesystem::path(to).extension() != ".exr")
    throw Error(Exit::usage, to, "is no name of an OpenEXR file", "let the new picture end in .exr");
  if (std::filesystem::exists(to) && !call.force) throw Error(Exit::cannot_create, to, "exists", "--force replaces it");
  check_writable(to);
}

Exit convert(cli::Invocation& call) {
  const std::string &old = call.texts("PICTURE")[0], &fresh = call.texts("PICTURE")[1];
  call.note_input(old);
  const io::Image picture = colours_of(old);
  const probe::SphereMap from{chosen(call, "convert"), picture.width, picture.height};
  check_shape(from, old.c_str());
  const Projection to = chosen(call, "to");
  const probe::SphereMap unit = probe::sized(to, 12);
  const double pixels = static_cast<double>(picture.pixels());
  const int height = call.given("height") ? static_cast<int>(call.integer("height"))
                                          : static_cast<int>(std::lround(std::sqrt(pixels * unit.height / unit.width)));
  io::write_picture(fresh, remapped(picture, from, probe::sized(to, height)));
  call.writes_document = false;
  return Exit::done;
}

}  // namespace gonio::tools::light_probe
