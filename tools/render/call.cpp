#include "tools/render/call.h"

#include <algorithm>
#include <cmath>

#include "base/atomic_file.h"
#include "base/progress.h"
#include "base/text.h"
#include "camera/intrinsics.h"
#include "io/picture.h"
#include "manifest/image_list.h"
#include "manifest/sections/image.h"
#include "manifest/sections/mechanism_use.h"
#include "render/entries.h"
#include "render/mosaic.h"
#include "render/preview.h"
#include "render/sensor_chain.h"
#include "render/session.h"
#include "render/share.h"
#include "render/spectral.h"
#include "scene/mechanisms.h"

namespace gonio::tools::render {

using namespace gonio::render;

namespace {

namespace fs = std::filesystem;

constexpr const char* polarizers = "polarizers";

bool behind_polarizers(const manifest::Document& document, std::size_t image) {
  return camera::mosaic_of(document, manifest::camera_of_image(document, image)) == polarizers;
}

// The document with what --with switches on.
manifest::Document seen_by(const cli::Invocation& call) {
  manifest::Document seen = call.document;
  for (const std::string& text : call.texts("with")) {
    const auto [mechanism, use] = scene::parse_mechanism(text, "--with");
    seen.mechanisms[mechanism->id] = use;
  }
  return seen;
}

bool records_polarization(const cli::Invocation& call) {
  if (!call.flag("record")) return false;
  return std::ranges::any_of(chosen_images(call.document, call.texts("image")),
                             [&](std::size_t i) { return behind_polarizers(call.document, i); });
}

SessionOptions options_of(const cli::Invocation& call) {
  SessionOptions options;
  options.transport.max_bounces = static_cast<int>(call.integer("max-bounces"));
  options.transport.per_light = call.flag("per-light");
  options.transport.stokes = call.flag("stokes") || records_polarization(call);
  options.seed = call.seed;
  options.geometry = call.text("aov") == "on" && !call.flag("record");
  const bool open = call.given("time") || call.given("noise");
  if (call.given("spp") || !open) options.spp = static_cast<int>(call.integer("spp"));
  if (call.given("time")) options.time_s = call.number("time");
  if (call.given("noise")) options.relative_error = call.number("noise");
  if (call.given("samples")) options.samples = call.text("samples");
  if (call.given("wavelengths")) options.wavelengths_m = parse_wavelengths(call.text("wavelengths"), "--wavelengths");
  options.allow_open = call.flag("allow-open");
  options.purpose = call.flag("record") ? "recording" : "";
  options.checkpoint_s = call.number("checkpoint");
  options.resume = call.resume;
  options.force = call.force;
  return options;
}

Session session_of(cli::Invocation& call, const std::string& image) {
  SessionOptions options = options_of(call);
  options.image = image;
  return Session(seen_by(call), options, [&](const fs::path& path) { call.note_input(path); });
}

std::string percent(double ratio) {
  return format("%.3g %%", 100 * ratio);
}

// Says what a person has to know of a picture; is its noise as small as was asked for?
bool judge(const cli::Invocation& call, const std::string& image, const Facts& facts) {
  if (facts.not_finite > 0)
    log(LogLevel::warning, image + ": " + std::to_string(facts.not_finite) +
                               " pixels are no numbers: paths brought back what is none, or more than 2^31");
  if (!call.given("noise") || facts.relative_error <= call.number("noise")) return true;
  log(LogLevel::warning, image + ": the relative error is " + percent(facts.relative_error) + " after " +
                             std::to_string(facts.samples()) + " samples per pixel, " + percent(call.number("noise")) +
                             " was asked for; raise --spp or --time");
  return false;
}

struct Place {                             // where the files of an image go
  fs::path picture, preview, layers;       // layers: stem of their previews
  std::map<std::string, fs::path> beside;  // that the manifest names, by kind
};

Place place_of(const cli::Invocation& call, const std::string& image, bool mosaic) {
  const std::string stem = file_stem(image);
  Place place;
  place.picture = call.output_path(stem + ".exr");
  if (call.flag("preview")) place.preview = call.output_path(stem + ".png");
  if (call.flag("preview-layers")) place.layers = call.output_path(stem);
  if (call.flag("sums") || call.given("samples")) place.beside["sums"] = call.output_path(stem + ".sums");
  if (mosaic) place.beside["mosaic"] = call.output_path(stem + "-mosaic.exr");
  return place;
}

bool is_whole(const Place& place) {
  return (place.preview.empty() || fs::exists(place.preview)) &&
         std::ranges::all_of(place.beside, [](const auto& file) { return fs::exists(file.second); });
}

void write(const Place& place, const Rendered& rendered) {
  if (const auto sums = place.beside.find("sums"); sums != place.beside.end())
    write_sums(sums->second, rendered.sums.value(), 0);
  if (const auto mosaic = place.beside.find("mosaic"); mosaic != place.beside.end())
    io::write_picture(mosaic->second, polarizer_mosaic(rendered.picture));
  if (!place.preview.empty()) io::write_picture(place.preview, preview(rendered.picture));
  const auto attributes = attributes_of(rendered.facts, rendered.picture);
  write_file(place.picture, io::encode_exr(rendered.picture, attributes));  // last: where it stands, the others do
}

// From the finished picture, so that a resumed call makes them, too.
void write_layers(const Place& place) {
  if (place.layers.empty()) return;
  for (const auto& [layer, picture] : layer_previews(io::read_picture(place.picture)))
    io::write_picture(place.layers.string() + "-" + layer + ".png", picture);
}

class Images {
 public:
  explicit Images(cli::Invocation& call) : call_(call), seen_(seen_by(call)) {}

  // False where the picture is noisier than was asked for.
  bool make(std::size_t image, const std::string& id, const Place& place) {
    session_for(image);
    std::optional<Facts> facts = session_->finished(image, place.picture);
    if (!facts || !is_whole(place)) facts = render_anew(image, id, place);
    write_layers(place);
    if (call_.flag("record"))
      enter_recording(call_.document, image, place.picture);
    else
      enter_rendering(call_.document, image, place.picture, *facts, wavelengths(), place.beside);
    return judge(call_, id, *facts);
  }

 private:
  Facts render_anew(std::size_t image, const std::string& id, const Place& place) {
    Rendered rendered = session_->render(image, place.picture);
    if (call_.flag("record")) rendered.picture = recorded(rendered.picture, sensor_of(seen_, image), id, call_.seed);
    write(place, rendered);
    Session::remove_checkpoint(place.picture);
    return rendered.facts;
  }
  std::vector<double> wavelengths() const { return options_of(call_).wavelengths_m; }

  // One session for images whose things have the same shapes.
  void session_for(std::size_t image) {
    const manifest::ImageEntry& entry = seen_.images[image];
    if (session_ && entry.shapes == shapes_) return;
    session_.emplace(session_of(call_, entry.id));
    shapes_ = entry.shapes;
  }

  cli::Invocation& call_;
  manifest::Document seen_;
  std::optional<Session> session_;
  std::map<std::string, double> shapes_;  // of the session's images
};

void check_merge(const cli::Invocation& call) {
  if (call.texts("FILE").empty())
    throw Error(Exit::usage, "--merge", "has nothing to join", "name shares: render --merge a.exr b.exr --out all");
}

}  // namespace

void check(cli::Invocation& call) {
  if (call.given("specimen")) return;
  if (call.flag("merge")) return check_merge(call);
  if (!call.texts("FILE").empty())
    throw Error(Exit::usage, call.texts("FILE")[0], "is no manifest by its name",
                "give a file that ends in .json, or use -i; shares of pictures need --merge");
  if (!call.has_document) throw Error(Exit::no_input, "render", "has no scene", "name one: render scene.json --out r");
  if (call.out.empty()) throw Error(Exit::usage, "--out", "is missing", "name the folder for the pictures");
  pass_range(options_of(call));
  for (const std::size_t i : chosen_images(call.document, call.texts("image")))
    if (call.flag("record")) check_recordable(call.document, i);
  if (call.flag("check")) {
    const auto chosen = chosen_images(call.document, call.texts("image"));
    session_of(call, chosen.empty() ? "" : call.document.images[chosen.front()].id);
  }
}

Exit render_images(cli::Invocation& call) {
  const auto images = chosen_images(call.document, call.texts("image"));
  const auto ids = names_in(call.document, "images");
  std::vector<Place> places;  // asked for before the work begins: an existing file is an error at once
  const bool stokes = call.flag("stokes") && !call.flag("record");
  for (const std::size_t i : images)
    places.push_back(place_of(call, ids[i], stokes && behind_polarizers(call.document, i)));
  Images work(call);
  bool good = true;
  for (std::size_t k = 0; k < images.size(); ++k) good = work.make(images[k], ids[images[k]], places[k]) && good;
  if (call.flag("record")) forget_free_values(call.document);
  return good ? Exit::done : Exit::quality;
}

Exit merge(cli::Invocation& call) {
  std::vector<fs::path> shares;
  for (const std::string& text : call.texts("FILE")) {
    shares.emplace_back(text);
    call.note_input(sums_path(text));
  }
  const auto by_image = shares_by_image(shares);
  std::map<std::string, Place> places;
  for (const auto& [image, paths] : by_image) {
    const auto entry = manifest::index_of_image(call.document, image);
    if (call.has_document && !entry)
      throw Error(Exit::data, image, "is an image of the shares that the manifest does not have",
                  "merge beside the manifest that was rendered");
    const auto planes = read_sums_header(paths[0]).identity.planes;
    const bool stokes = std::ranges::find(planes, "s1") != planes.end();
    places[image] = place_of(call, image, stokes && entry && behind_polarizers(call.document, *entry));
  }
  for (const auto& [image, paths] : by_image) {
    const Rendered rendered = merge_shares(paths);
    const Place& place = places[image];
    write(place, rendered);
    if (const auto entry = manifest::index_of_image(call.document, image))
      enter_rendering(call.document, *entry, place.picture, rendered.facts,
                      wavelengths_of(rendered.sums->identity().planes), place.beside);
    judge(call, image, rendered.facts);
  }
  call.writes_document = call.has_document;
  return Exit::done;
}

}  // namespace gonio::tools::render
