// See pattern.h.
#include "tools/structured-light/pattern.h"

#include <charconv>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"
#include "io/codes.h"
#include "manifest/sections/projection.h"
#include "scan/sequence.h"

namespace gonio::tools::structured_light {
namespace {

using cli::Type;
using scan::Axis;

std::vector<double> numbers_of(const std::string& text, char separator, const char* option, const char* remedy) {
  std::vector<double> all;
  const char *at = text.data(), *const end = at + text.size();
  while (true) {
    double v = 0;
    const auto [next, problem] = std::from_chars(at, end, v);
    if (problem != std::errc() || !(v > 0) || (next != end && *next != separator))
      throw Error(Exit::usage, option, "\"" + text + "\" cannot be read", remedy);
    all.push_back(v);
    if (next == end) return all;
    at = next + 1;
  }
}

std::vector<Axis> axes_of(const cli::Invocation& call) {
  const std::string& axes = call.text("axes");
  if (axes == "columns") return {Axis::column};
  if (axes == "rows") return {Axis::row};
  return {Axis::column, Axis::row};
}

scan::Sequence sequence_of(const cli::Invocation& call) {
  const std::vector<double> size = numbers_of(call.text("size"), 'x', "--size", "WIDTHxHEIGHT in pixels: 1920x1080");
  if (size.size() != 2 || size[0] != std::floor(size[0]) || size[1] != std::floor(size[1]) || size[0] > 65536 ||
      size[1] > 65536)
    throw Error(Exit::usage, "--size", "\"" + call.text("size") + "\" is no size", "WIDTHxHEIGHT in pixels: 1920x1080");
  const int width = static_cast<int>(size[0]), height = static_cast<int>(size[1]);
  if (call.text("pattern") == "gray") return scan::gray_sequence(width, height, axes_of(call));
  if (call.text("pattern") == "line-shift")
    return scan::line_sequence(width, height, axes_of(call), static_cast<int>(call.integer("line-period")));
  const std::vector<double> periods = numbers_of(call.text("periods"), ',', "--periods", "numbers: 1,16");
  for (const Axis axis : axes_of(call))
    for (const double p : periods)
      if (2 * p > (axis == Axis::column ? width : height))
        throw Error(Exit::usage, "--periods", format("%g are finer than two pixels each", p), "give fewer");
  return scan::cosine_sequence(width, height, axes_of(call), periods, static_cast<int>(call.integer("shifts")));
}

}  // namespace

std::vector<cli::Option> pattern_options() {
  return {{.name = "pattern",
           .type = Type::choice,
           .help = "Write the pictures that a projector shows: bits of a Gray code with their inverses, white and "
                   "black; a coarse "
                   "one and lines that move on by a pixel; or cosines.",
           .choices = {"gray", "line-shift", "cosine"},
           .conflicts = {"camera", "projector"},
           .needs = {"size"}},
          {.name = "size",
           .type = Type::text,
           .help = "Of the projector.",
           .metavar = "WIDTHxHEIGHT",
           .needs = {"pattern"}},
          {.name = "axes",
           .type = Type::choice,
           .help = "What is told. Two cameras without a calibrated projector need both.",
           .preset = "both",
           .choices = {"both", "columns", "rows"},
           .needs = {"pattern"}},
          {.name = "periods",
           .type = Type::text,
           .help = "Of cosines, over the whole width or height; a pixel must be told by all together.",
           .metavar = "N,N,...",
           .preset = "1,8,64",
           .needs = {"pattern"}},
          {.name = "shifts",
           .type = Type::integer,
           .help = "Of cosines, for each number of periods.",
           .preset = "4",
           .lower = 3,
           .upper = 64,
           .needs = {"pattern"}},
          {.name = "line-period",
           .type = Type::integer,
           .help = "Pixels from line to line, and so pictures of lines for each axis.",
           .preset = "8",
           .lower = 6,
           .upper = 64,
           .needs = {"pattern"}}};
}

void check_pattern(cli::Invocation& call) {
  if (call.given("PICTURE"))
    throw Error(Exit::usage, "PICTURE", "stands beside --pattern, which writes pictures", "measure in a second call");
  if (call.out.empty()) throw Error(Exit::usage, "--out", "is missing", "say where the pictures go: --out patterns");
  if (call.document.projections.contains(call.text("name")) && !call.force)
    throw Error(Exit::data, call.document.name + "#/projections/" + call.text("name"), "is there already",
                "--name another one, or --force replaces it");
  (void)sequence_of(call);
}

Exit write_pattern(cli::Invocation& call) {
  const scan::Sequence sequence = sequence_of(call);
  const std::string& name = call.text("name");
  manifest::Projection projection = scan::projection_of(sequence);
  std::vector<std::filesystem::path> paths;
  for (std::size_t f = 0; f < sequence.frames.size(); ++f)
    paths.push_back(call.output_path(format("%s-%03zu.png", file_stem(name).c_str(), f)));
  parallel_for(0, paths.size(), [&](std::size_t f) { io::write_png(paths[f], scan::picture_of(sequence, f), 8); });
  for (std::size_t f = 0; f < paths.size(); ++f)
    projection.frames[f].file = manifest::add_file(call.document, paths[f], format("%s-%03zu", name.c_str(), f));
  call.document.projections[name] = std::move(projection);
  return Exit::done;
}

}  // namespace gonio::tools::structured_light
