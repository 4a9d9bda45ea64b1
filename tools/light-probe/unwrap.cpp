// See unwrap.h.
#include "tools/light-probe/unwrap.h"

#include <algorithm>
#include <charconv>
#include <set>

#include "base/error.h"
#include "camera/undistort_document.h"
#include "io/codes.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/image.h"
#include "probe/metals.h"
#include "probe/probe_document.h"

namespace gonio::tools::light_probe {
namespace {

using cli::Type;
using probe::ProbeRequest;

probe::Circle circle_of(const std::string& text) {
  std::array<double, 3> v{};
  const char* at = text.data();
  const char* const end = at + text.size();
  bool good = true;
  for (std::size_t k = 0; k < 3 && good; ++k) {
    const auto [next, problem] = std::from_chars(at, end, v[k]);
    good = problem == std::errc() && (k == 2 ? next == end : next != end && *next == ',');
    at = next + (k < 2 && good ? 1 : 0);
  }
  if (!good || !(v[2] > 0))
    throw Error(Exit::usage, "--circle", "\"" + text + "\" is not X,Y,RADIUS",
                "three numbers in pixels: 253.5,148,119");
  return {{v[0], v[1]}, v[2]};
}

std::string only_camera(const cli::Invocation& call) {
  const auto cameras = names_in(call.document, "cameras");
  if (cameras.size() == 1) return cameras.front();
  throw Error(Exit::data, call.document.name + "#/cameras",
              "has " + std::to_string(cameras.size()) + " cameras, and photographs on the command line are by one",
              "list the photographs as images of the manifest");
}

std::vector<std::size_t> without_camera(const std::vector<std::string>& paths, const manifest::Value& response,
                                        manifest::Document& document) {
  std::vector<std::size_t> entered;
  for (const std::string& path : paths) {
    manifest::ImageEntry image;
    image.id = image.file = add_file(document, path, std::filesystem::path(path).stem().string());
    image.response = response;
    entered.push_back(document.images.size());
    document.images.push_back(std::move(image));
  }
  return entered;
}

std::size_t image_named(const cli::Invocation& call, const char* option, const std::string& id) {
  const auto index = manifest::index_of_image(call.document, id);
  if (!index)
    throw Error(Exit::usage, option, "\"" + id + "\" is no image of " + call.document.name, "name one of its images");
  return *index;
}

// The photographs on the command line become images of the manifest; without any, all of its images are looked at.
std::vector<std::size_t> chosen_images(cli::Invocation& call) {
  std::vector<std::size_t> images;
  if (call.given("PICTURE")) {
    if (!call.has_document && !call.flag("orthographic"))
      throw Error(Exit::no_input, "light-probe", "has no manifest with a calibrated camera",
                  "name it with -i camera.json, or say --orthographic");
    const manifest::Value response =
        call.given("response") ? manifest::Value(call.text("response")) : manifest::Value();
    for (const std::string& path : call.texts("PICTURE"))
      if (io::code_bits(path) != 0 && response.is_null())
        throw Error(Exit::data, path, "is an 8 or 16-bit picture whose response is not stated", "--response says it");
    images = call.flag("orthographic")
                 ? without_camera(call.texts("PICTURE"), response, call.document)
                 : camera::enter_photographs(call.texts("PICTURE"), only_camera(call), response, call.document);
    call.document.allow_outside = true;  // what the user names may lie anywhere
  } else {
    images = camera::images_with_pictures(call.document, {});
    if (call.given("scale")) std::erase(images, image_named(call, "--scale", call.text("scale")));
  }
  if (!call.given("image")) return images;
  std::vector<std::size_t> wanted;
  for (const std::string& id : call.texts("image")) wanted.push_back(image_named(call, "--image", id));
  return wanted;
}

void check_count(const char* option, std::size_t files, std::size_t photographs) {
  if (files > 1 && files != photographs)
    throw Error(Exit::usage, option,
                std::to_string(files) + " of them for " + std::to_string(photographs) + " photographs",
                "give one for all, or one for each");
}

// What is not surroundings is no more so for the programs that read the photographs next: masks become those of the
// images.
void enter_masks(const std::vector<std::string>& paths, const std::vector<std::size_t>& images,
                 manifest::Document& document) {
  check_count("--mask", paths.size(), images.size());
  std::vector<std::string> files;
  for (const std::string& path : paths)
    files.push_back(add_file(document, path, std::filesystem::path(path).stem().string()));
  for (std::size_t k = 0; k < images.size(); ++k) {
    manifest::ImageEntry& image = document.images[images[k]];
    if (!image.mask.empty())
      throw Error(Exit::usage, "--mask", "image \"" + image.id + "\" has a mask in the manifest",
                  "leave one of them out");
    image.mask = files[files.size() == 1 ? 0 : k];
  }
  document.allow_outside = true;  // what the user names may lie anywhere
}

ProbeRequest request_of(cli::Invocation& call) {
  ProbeRequest request;
  request.parallel = call.flag("orthographic");
  if (call.given("radius")) request.radius_m = call.number("radius");
  request.balls = static_cast<std::size_t>(call.integer("balls"));
  if (call.given("circle")) request.circle = circle_of(call.text("circle"));
  if (call.given("silhouette"))
    for (const std::string& path : call.texts("silhouette")) request.silhouettes.emplace_back(path);
  request.unwrap.columns = static_cast<int>(call.integer("columns"));
  if (call.given("distance")) request.unwrap.distance_m = call.number("distance");
  request.unwrap.steepest_rad = call.number("steepest");
  request.unwrap.camera_radius_m = call.number("camera-radius");
  request.unwrap.fill = call.text("fill") == "neighbours";
  request.unwrap.metal = probe::metal_of(call.text("metal"), "--metal");
  request.each = call.flag("each");
  if (call.flag("lights") || request.each)
    request.lights =
        probe::LightWish{call.number("light-ratio"), call.number("largest-light"), call.number("least-light"), 5};
  request.name = call.text("name");
  request.images = chosen_images(call);
  check_count("--silhouette", request.silhouettes.size(), request.images.size());
  if (call.given("scale"))
    request.scale = probe::ScaleWish{image_named(call, "--scale", call.text("scale")),
                                     call.given("tile") ? call.text("tile") : std::string()};
  if (call.given("mask")) enter_masks(call.texts("mask"), request.images, call.document);
  request.output_path = [&call](const std::string& name) { return call.output_path(name); };
  request.note_input = [&call](const std::filesystem::path& path) { call.note_input(path); };
  return request;
}

std::vector<cli::Option> ball_options() {
  return {
      {.name = "radius",
       .type = Type::quantity,
       .help = "Radius of the balls.",
       .dimension = Dimension::length,
       .lower = 1e-4,
       .upper = 10},
      {.name = "balls",
       .type = Type::integer,
       .help = "Balls in each photograph.",
       .preset = "1",
       .lower = 1,
       .upper = 16},
      {.name = "circle",
       .type = Type::text,
       .help = "Where the ball is: centre and radius in pixels, within a tenth of the radius; the outline is found "
               "near it.",
       .metavar = "X,Y,RADIUS"},
      {.name = "silhouette",
       .type = Type::input_file,
       .help = "A picture that is white where the balls are: its outlines are theirs. One for all photographs, or "
               "one for each in their order.",
       .repeat = true,
       .conflicts = {"circle"}},
      {.name = "mask",
       .type = Type::input_file,
       .help = "A picture that is white where the photograph shows surroundings, and black over the camera, its "
               "tripod or a hand as the ball mirrors them: it becomes the image's mask. One for all photographs, or "
               "one for each in their order.",
       .repeat = true},
      {.name = "orthographic",
       .type = Type::flag,
       .help = "Photographs without a camera: take them as seen from infinitely far, along the world's +x, z up."},
      {.name = "metal",
       .type = Type::text,
       .help = "What the ball is made of, to divide its reflectance out: chromium, nickel, iron, silver, aluminium, "
               "none (reflects all), or a file of refractiveindex.info.",
       .metavar = "NAME|FILE",
       .preset = "chromium"},
      {.name = "steepest",
       .type = Type::quantity,
       .help = "Largest angle of incidence that is used; what only the rim shows counts as not seen.",
       .preset = "84deg",
       .dimension = Dimension::angle,
       .lower = 0.2,
       .upper = 1.57},
      {.name = "camera-radius",
       .type = Type::quantity,
       .help = "Radius about the camera within which the ball shows the camera instead of the surroundings.",
       .preset = "5cm",
       .dimension = Dimension::length,
       .lower = 0,
       .upper = 10}};
}

std::vector<cli::Option> result_options() {
  return {
      {.name = "distance",
       .type = Type::quantity,
       .help = "Distance of the surroundings from the ball. Default: infinitely far.",
       .dimension = Dimension::length,
       .lower = 1e-3,
       .upper = 1e6},
      {.name = "columns",
       .type = Type::integer,
       .help = "Columns of the latitude-longitude picture, an even number.",
       .preset = "1024",
       .lower = 8,
       .upper = 16384},
      {.name = "fill",
       .type = Type::choice,
       .help = "What no photograph shows: from its neighbours, or black.",
       .preset = "neighbours",
       .choices = {"neighbours", "black"}},
      {.name = "scale",
       .type = Type::text,
       .help = "Scale the light to this image of the manifest, taken under it with another exposure or by another "
               "camera: by the ball in it, or by a white tile (--tile). The factor and its standard error are stated.",
       .metavar = "IMAGE",
       .conflicts = {"orthographic", "each"}},
      {.name = "tile",
       .type = Type::text,
       .help = "White tile that the image of --scale shows: a name in the manifest's goniometer, with reflectance, "
               "place and outline; near where the ball was.",
       .metavar = "NAME",
       .needs = {"scale"}},
      {.name = "lights",
       .type = Type::flag,
       .help = "Take bright small regions out of the picture and enter them as lights: with a position where several "
               "balls or views tell it, else as directions."},
      {.name = "each",
       .type = Type::flag,
       .help = "Every photograph has lights of its own, as in photometric stereo: enter them, and no picture."},
      {.name = "light-ratio",
       .type = Type::number,
       .help = "A light is brighter than this many times the mean radiance.",
       .preset = "10",
       .lower = 1.5},
      {.name = "least-light",
       .type = Type::quantity,
       .help = "A light brings at least this share of the light of all directions together.",
       .preset = "1%",
       .dimension = Dimension::ratio,
       .lower = 0,
       .upper = 1},
      {.name = "largest-light",
       .type = Type::quantity,
       .help = "Half angle of the largest region that is a light.",
       .preset = "20deg",
       .dimension = Dimension::angle,
       .lower = 1e-3,
       .upper = 1.57},
      {.name = "name",
       .type = Type::text,
       .help = "Name of the light and of the files.",
       .metavar = "NAME",
       .preset = "probe"},
      {.name = "image", .type = Type::text, .help = "Use this image only.", .metavar = "ID", .repeat = true},
      {.name = "response",
       .type = Type::choice,
       .help = "How the codes of 8 and 16-bit photographs on the command line become linear.",
       .choices = {"linear", "srgb"}}};
}

}  // namespace

std::vector<cli::Option> unwrap_options() {
  std::vector<cli::Option> all = ball_options(), more = result_options();
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

void check_unwrap(cli::Invocation& call) {
  if (call.out.empty()) throw Error(Exit::usage, "--out", "is missing", "name the folder for the pictures");
  if (!call.flag("orthographic") && !call.given("radius"))
    throw Error(Exit::usage, "--radius", "is missing", "measure the ball; --orthographic does without");
  if (call.integer("columns") % 2 != 0)
    throw Error(Exit::usage, "--columns", call.text("columns") + " is odd", "the picture is twice as wide as high");
  if (call.given("circle") && call.integer("balls") != 1)
    throw Error(Exit::usage, "--circle", "is one ball, and --balls says " + std::to_string(call.integer("balls")),
                "draw silhouettes of several: --silhouette");
  const manifest::Document before = call.document;
  const ProbeRequest request = request_of(call);
  check_probe(call.document, request);
  if (request.parallel && request.images.size() > 1 && !request.each)
    throw Error(Exit::usage, "--orthographic", "has no poses that would put several photographs together",
                "use --each, or a calibrated camera");
  call.document = before;
}

Exit unwrap(cli::Invocation& call) {
  const ProbeRequest request = request_of(call);
  probe_document(call.document, request);
  return Exit::done;
}

}  // namespace gonio::tools::light_probe
