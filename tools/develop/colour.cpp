// See colour.h.
#include "tools/develop/colour.h"

#include <optional>

#include "base/error.h"
#include "camera/undistort_document.h"
#include "colour/colour_document.h"
#include "manifest/document.h"
#include "manifest/sections/camera.h"

namespace gonio::tools::develop {
namespace {

// The photographs on the command line become images of the manifest; without any, all of its images are corrected.
colour::ColourRequest request_of(cli::Invocation& call) {
  colour::ColourRequest request;
  request.name = call.text("colour");
  request.keeps_level = call.text("white") == "green";
  std::optional<std::string> camera;
  if (call.given("camera")) camera = call.text("camera");
  if (call.given("PHOTOGRAPH")) {
    const auto cameras = call.document.cameras;  // colours need no lens, and none is made up
    request.images = camera::enter_photographs(call.texts("PHOTOGRAPH"), camera.value_or(""), {}, call.document);
    call.document.cameras = cameras;
  } else {
    request.images = camera::images_with_pictures(call.document, camera);
  }
  request.output_path = [&call](const std::string& name) { return call.output_path(name); };
  request.note_input = [&call](const std::filesystem::path& path) { call.note_input(path); };
  return request;
}

}  // namespace

std::vector<cli::Option> colour_options() {
  return {
      {.name = "colour",
       .type = cli::Type::text,
       .help = "Apply this correction of the manifest, as color-calib found it, to OpenEXR pictures.",
       .metavar = "NAME",
       .conflicts = {"merge", "undistort"}},
      {.name = "white",
       .type = cli::Type::choice,
       .help = "What a perfect white in the light of the chart's photograph becomes: 1, or as bright as the camera's "
               "green was, so that radiance stays radiance.",
       .preset = "1",
       .choices = {"1", "green"},
       .needs = {"colour"}}};
}

void check_colour(cli::Invocation& call) {
  if (!call.has_document)
    throw Error(Exit::no_input, "develop", "has no manifest with a correction of colours",
                "pipe one in, or name it with -i colour.json");
  if (call.out.empty()) throw Error(Exit::usage, "--out", "is missing", "name the folder for the pictures");
  if (call.given("PHOTOGRAPH")) call.document.allow_outside = true;  // what the user names may lie anywhere
  const manifest::Document before = call.document;
  check_colours(call.document, request_of(call));
  call.document = before;
}

Exit colour(cli::Invocation& call) {
  const colour::ColourRequest request = request_of(call);
  colour_document(call.document, request);
  return Exit::done;
}

}  // namespace gonio::tools::develop
