// See merge.h.
#include "tools/develop/merge.h"

#include <algorithm>

#include "base/error.h"
#include "manifest/document.h"
#include "photograph/raw_document.h"
#include "photograph/raw_views.h"

namespace gonio::tools::develop {
namespace {

using cli::Type;
using photograph::RawRequest;

const std::vector<std::string> mosaics{"Mono", "RGGB", "GRBG", "GBRG", "BGGR", "polarizers"},
    demosaicings(photograph::demosaicing_names.begin(), photograph::demosaicing_names.end());
const std::vector<std::string> groupings(photograph::grouping_names.begin(), photograph::grouping_names.end());

}  // namespace

std::vector<std::filesystem::path> paths(const cli::Invocation& call, const std::string& option) {
  std::vector<std::filesystem::path> all;
  if (call.given(option))
    for (const std::string& text : call.texts(option)) all.emplace_back(text);
  return all;
}

photograph::RawStated stated(const cli::Invocation& call) {
  photograph::RawStated s;
  if (call.given("mosaic")) s.mosaic = call.text("mosaic");
  if (call.given("black")) s.black = call.number("black");
  if (call.given("full-scale")) s.white = call.number("full-scale");
  return s;
}

namespace {

photograph::Grouping grouping(const cli::Invocation& call, const std::vector<std::filesystem::path>& frames) {
  if (call.given("views"))
    return static_cast<photograph::Grouping>(std::ranges::find(groupings, call.text("views")) - groupings.begin());
  return photograph::usual_grouping(frames);
}

RawRequest request_of(cli::Invocation& call) {
  RawRequest request;
  request.recipe.stated = stated(call);
  if (call.given("linearity")) {
    const std::filesystem::path table = call.text("linearity");
    request.recipe.stated.linearity = std::make_shared<photograph::Linearity>(photograph::read_linearity(table));
    call.note_input(table);
  }
  if (call.given("camera")) request.camera = call.text("camera");
  std::vector<std::filesystem::path> dark = paths(call, "dark");
  if (call.given("PHOTOGRAPH")) {
    const std::vector<std::filesystem::path> frames = paths(call, "PHOTOGRAPH");
    request.views = photograph::raw_views(frames, {}, grouping(call, frames), request.recipe.stated);
  } else {
    photograph::views_of_images(call.document, request.camera, request, dark);
    request.camera.clear();
  }
  if (request.views.empty())
    throw Error(Exit::no_input, "develop", "has no raw frames",
                "name them, or pipe in a manifest whose images have files");
  for (const auto& path : dark) call.note_input(path);
  if (!dark.empty()) request.recipe.dark = photograph::dark_field(dark, request.recipe.stated);
  const std::vector<std::filesystem::path> flat = paths(call, "flat");
  for (const auto& path : flat) call.note_input(path);
  if (!flat.empty()) request.recipe.flat = photograph::flat_field(flat, request.recipe.stated, request.recipe.dark);
  if (call.given("noise-gain"))
    request.recipe.noise = manifest::Noise{call.number("noise-gain"), call.number("read-noise")};
  request.recipe.demosaicing = static_cast<photograph::Demosaicing>(
      std::ranges::find(demosaicings, call.text("demosaic")) - demosaicings.begin());
  request.recipe.refine_exposures = !call.flag("keep-exposures");
  request.recipe.blooming_px = static_cast<int>(call.number("blooming"));
  request.resume = call.resume;
  request.memory_bytes = static_cast<std::size_t>(1e9 * call.number("memory"));
  request.output_path = [&call](const std::string& name) { return call.output_path(name); };
  request.note_input = [&call](const std::filesystem::path& path) { call.note_input(path); };
  return request;
}

}  // namespace

std::vector<cli::Option> merge_options() {
  return {
      {.name = "merge",
       .type = Type::flag,
       .help = "Make radiance, in codes per second, out of raw frames: all exposures of a view in one picture.",
       .conflicts = {"undistort"}},
      {.name = "views",
       .type = Type::choice,
       .help = "Which frames on the command line are exposures of one view: those with the same name before the "
               "exposure (scene_20ms.png); in sequence, until an exposure comes again; all; or each alone. Default: "
               "by names where all have an exposure, else in sequence.",
       .choices = groupings,
       .needs = {"merge"}},
      {.name = "mosaic",
       .type = Type::choice,
       .help =
           "Filters over the samples, row by row from the upper left corner. Default: as the file or the camera says.",
       .choices = mosaics,
       .conflicts = {"undistort", "colour"}},
      {.name = "black",
       .type = Type::number,
       .help = "Code without light. Default: as the file says, else 0.",
       .lower = 0,
       .conflicts = {"undistort", "colour"}},
      {.name = "full-scale",
       .type = Type::number,
       .help = "Code at which the sensor is full. Default: as the file says, else its highest code.",
       .lower = 1e-6,
       .conflicts = {"undistort", "colour"}},
      {.name = "linearity",
       .type = Type::input_file,
       .help =
           "A table (CSV, columns code and linear) from codes above black to linear codes, as --characterize writes "
           "it. Default: codes are linear.",
       .needs = {"merge"}},
      {.name = "dark",
       .type = Type::input_file,
       .help = "A frame without light, of any exposure; may be given several times. Dark current, what is left of "
               "black, and hot samples are found in them.",
       .repeat = true,
       .conflicts = {"undistort", "colour"}},
      {.name = "flat",
       .type = Type::input_file,
       .help =
           "A frame of an even light; may be given several times. Shading is divided out, dead samples are left out.",
       .repeat = true,
       .needs = {"merge"}},
      {.name = "noise-gain",
       .type = Type::number,
       .help = "Electrons per code. Default: as all images of the manifest state it, else what the exposures say where "
               "they "
               "overlap.",
       .lower = 1e-6,
       .needs = {"merge"}},
      {.name = "read-noise",
       .type = Type::number,
       .help = "Noise without light, one standard deviation, in codes.",
       .preset = "0.5",
       .lower = 0,
       .needs = {"noise-gain"}},
      {.name = "demosaic",
       .type = Type::choice,
       .help = "Interpolation behind filters: the nearest samples of a colour or polarizer, or those corrected by the "
               "gradient "
               "of the one that was measured.",
       .preset = "gradient",
       .choices = demosaicings},
      {.name = "keep-exposures",
       .type = Type::flag,
       .help = "Take exposure times as they are stated instead of finding them from the frames.",
       .needs = {"merge"}},
      {.name = "memory",
       .type = Type::number,
       .help = "What the views in work may take together, GB: the more, the more views are made side by side, and the "
               "fewer frames are decoded again. The pictures are the same.",
       .metavar = "GB",
       .preset = "4",
       .lower = 0.001,
       .upper = 1e6},
      {.name = "blooming",
       .type = Type::integer,
       .help = "Samples so near to a saturated one are not used, px.",
       .preset = "1",
       .lower = 0,
       .upper = 64}};
}

void check_merge(cli::Invocation& call) {
  if (call.out.empty()) throw Error(Exit::usage, "--out", "is missing", "name the folder for the pictures");
  if (!call.given("PHOTOGRAPH") && !call.has_document)
    throw Error(Exit::no_input, "develop", "has no raw frames",
                "name them, or pipe in a manifest whose images have files");
  if (call.given("PHOTOGRAPH") || call.given("dark") || call.given("flat")) call.document.allow_outside = true;
}

Exit merge(cli::Invocation& call) {
  photograph::develop_raw(call.document, request_of(call));
  return Exit::done;
}

}  // namespace gonio::tools::develop
