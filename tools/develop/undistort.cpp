// See undistort.h.
#include "tools/develop/undistort.h"

#include <algorithm>
#include <optional>

#include "base/error.h"
#include "camera/undistort_document.h"
#include "manifest/document.h"

namespace gonio::tools::develop {
namespace {

using cli::Type;

// The photographs on the command line become images of the manifest; without any, all of its images are developed.
std::vector<std::size_t> chosen_images(cli::Invocation& call) {
  std::optional<std::string> named;
  if (call.given("camera")) named = call.text("camera");
  if (!call.given("PHOTOGRAPH")) return camera::images_with_pictures(call.document, named);
  const auto cameras = names_in(call.document, "cameras");
  if (!named && cameras.size() != 1)
    throw Error(Exit::usage, "--camera",
                "is missing, and the manifest has " + std::to_string(cameras.size()) + " cameras");
  const manifest::Value response = call.given("response") ? manifest::Value(call.text("response")) : manifest::Value();
  return camera::enter_photographs(call.texts("PHOTOGRAPH"), named ? *named : cameras.front(), response, call.document);
}

template <class Enum>
Enum chosen(const cli::Invocation& call, const char* option, const std::vector<std::string>& names) {
  return static_cast<Enum>(std::ranges::find(names, call.text(option)) - names.begin());
}

const std::vector<std::string> kernels(camera::kernel_names.begin(), camera::kernel_names.end());
const std::vector<std::string> keeps{"valid", "all", "same"};
const std::vector<std::string> formats{"same", "exr", "png8", "png16"};

camera::UndistortRequest request_of(cli::Invocation& call) {
  camera::UndistortRequest request;
  request.choice.keep = chosen<camera::Keep>(call, "keep", keeps);
  request.choice.kernel = chosen<camera::Kernel>(call, "kernel", kernels);
  request.choice.scale = call.number("scale");
  request.choice.largest_angle_rad = call.number("max-angle");
  request.limit_overshoot = call.text("overshoot") == "limit";
  request.format = chosen<camera::PictureFormat>(call, "format", formats);
  if (call.given("saturation")) request.saturation = call.number("saturation");
  request.images = chosen_images(call);
  request.output_path = [&call](const std::string& name) { return call.output_path(name); };
  request.note_input = [&call](const std::filesystem::path& path) { call.note_input(path); };
  return request;
}

}  // namespace

std::vector<cli::Option> undistort_options() {
  return {
      {.name = "undistort", .type = Type::flag, .help = "Take the lens distortion out."},
      {.name = "camera",
       .type = Type::text,
       .help = "Camera that took the photographs; needed where the manifest has several.",
       .metavar = "NAME"},
      {.name = "response",
       .type = Type::choice,
       .help = "How the codes of 8 and 16-bit photographs on the command line become linear.",
       .choices = {"linear", "srgb"}},
      {.name = "kernel",
       .type = Type::choice,
       .help = "Interpolation: bicubic after Keys (a = -1/2) or Mitchell (B = C = 1/3), or Lanczos of radius 3.",
       .preset = "keys",
       .choices = kernels},
      {.name = "keep",
       .type = Type::choice,
       .help = "The new picture: as large as it can be with valid pixels alone; so large that all source pixels are "
               "in it; or with the size, focal lengths and principal point of the old one.",
       .preset = "valid",
       .choices = keeps},
      {.name = "scale",
       .type = Type::number,
       .help = "Focal length of the new camera over that of the old one, in pixels.",
       .preset = "1",
       .lower = 0.1,
       .upper = 10},
      {.name = "max-angle",
       .type = Type::quantity,
       .help = "Largest angle from the optical axis that the new picture shows.",
       .preset = "80deg",
       .dimension = Dimension::angle,
       .lower = 0.01,
       .upper = 1.55},
      {.name = "overshoot",
       .type = Type::choice,
       .help = "Keep what the kernel makes of edges, or limit each value to those of its footprint.",
       .preset = "keep",
       .choices = {"keep", "limit"}},
      {.name = "saturation",
       .type = Type::number,
       .help = "Stored values from here on are saturated; 8 and 16-bit codes over full scale. Default: the highest "
               "code, and none in OpenEXR.",
       .lower = 0},
      {.name = "format",
       .type = Type::choice,
       .help = "What to write; same: OpenEXR from OpenEXR, else PNG with as many bits.",
       .preset = "same",
       .choices = formats}};
}

void check_undistort(cli::Invocation& call) {
  if (!call.has_document)
    throw Error(Exit::no_input, "develop", "has no manifest with a calibrated camera",
                "pipe one in, or name it with -i camera.json");
  if (call.out.empty()) throw Error(Exit::usage, "--out", "is missing", "name the folder for the pictures");
  if (call.given("response") && !call.given("PHOTOGRAPH"))
    throw Error(Exit::usage, "--response", "is for photographs on the command line",
                "images in a manifest state their own");
  if (call.given("PHOTOGRAPH")) call.document.allow_outside = true;  // what the user names may lie anywhere
  const manifest::Document before = call.document;
  check_undistortion(call.document, request_of(call));
  call.document = before;
}

Exit undistort(cli::Invocation& call) {
  const camera::UndistortRequest request = request_of(call);
  undistort_document(call.document, request);
  return Exit::done;
}

}  // namespace gonio::tools::develop
