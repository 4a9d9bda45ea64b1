// See response.h.
#include "tools/develop/response.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/progress.h"
#include "base/text.h"
#include "io/codes.h"
#include "io/exif.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/image.h"
#include "photograph/raw_document.h"
#include "photograph/raw_views.h"
#include "photograph/response_patches.h"
#include "tools/develop/merge.h"

namespace gonio::tools::develop {
namespace {

using cli::Type;
using photograph::FoundResponse;
using photograph::ResponseView;

// By the exposures in the names, or by those that the camera wrote into the files.
std::vector<ResponseView> views_of_photographs(const cli::Invocation& call) {
  std::vector<ResponseView> views;
  const std::vector<std::filesystem::path> all = paths(call, "PHOTOGRAPH");
  for (const photograph::RawView& view : photograph::raw_views(all, {}, photograph::usual_grouping(all), {})) {
    views.push_back({view.name, view.frames, {}});
    for (const auto& exposure_s : view.exposures_s) views.back().exposures_s.push_back(*exposure_s);
  }
  return views;
}

// Exposure times say how much light there was where aperture and sensitivity stayed.
void check_settings(const ResponseView& view) {
  const auto same = [&](std::optional<double> io::Exif::*setting, const char* words) {
    std::optional<double> first;
    for (const std::filesystem::path& picture : view.pictures) {
      const std::optional<double> own = io::exif_of(picture).*setting;
      if (!own) continue;
      if (first && std::abs(*own - *first) > 0.01 * *first)
        throw Error(Exit::data, picture.string(),
                    format("was taken at %s%g, and others of its view at %g: exposure times alone do not say how much "
                           "light that is",
                           words, *own, *first),
                    "leave it out, or take a view at one aperture and one sensitivity");
      first = own;
    }
  };
  same(&io::Exif::f_number, "f/"), same(&io::Exif::iso, "ISO ");
}

// Photographs of the command line as images.
std::vector<std::size_t> enter_photographs(cli::Invocation& call, const std::vector<ResponseView>& views) {
  std::vector<std::size_t> places;
  auto& images = call.document.images;
  for (const ResponseView& view : views)
    for (std::size_t k = 0; k < view.pictures.size(); ++k) {
      const std::string stem = view.pictures[k].stem().string();
      manifest::ImageEntry image;
      image.id = stem;
      for (int n = 2; std::ranges::find(images, image.id, &manifest::ImageEntry::id) != images.end(); ++n)
        image.id = stem + "-" + std::to_string(n);
      image.file = manifest::add_file(call.document, view.pictures[k], image.id);
      if (call.given("camera")) image.camera = call.text("camera");
      image.exposure_s = view.exposures_s[k], image.group = view.name;
      places.push_back(images.size());
      images.push_back(std::move(image));
    }
  return places;
}

// Images with a file, of one camera; those of one group are exposures of one view.
std::vector<std::size_t> images_of_camera(cli::Invocation& call, std::vector<ResponseView>& views) {
  std::vector<std::size_t> images;
  std::set<std::string> cameras;
  std::map<std::string, std::size_t> first_of;  // image of each view
  auto& all = call.document.images;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].file.empty() || all[i].dark == true || (call.given("camera") && all[i].camera != call.text("camera")))
      continue;
    const auto path = manifest::picture_path(call.document, i);
    if (io::code_bits(path) == 0) continue;
    images.push_back(i), cameras.insert(all[i].camera);
    if (all[i].group.empty()) continue;
    if (!all[i].exposure_s) all[i].exposure_s = io::exif_of(path).exposure_s;
    if (!all[i].exposure_s)
      throw Error(Exit::data, manifest::place(call.document, "/images/" + std::to_string(i)),
                  "does not say how long it was exposed", "state exposure_s");
    auto view = std::ranges::find(views, all[i].group, &ResponseView::name);
    if (view == views.end())
      view = views.insert(views.end(), {all[i].group, {}, {}}), first_of[all[i].group] = i;
    else
      photograph::refuse_other_aperture(call.document, first_of[all[i].group], i);
    view->pictures.push_back(path), view->exposures_s.push_back(*all[i].exposure_s);
  }
  if (cameras.size() > 1)
    throw Error(Exit::usage, "--camera", format("is missing, and images are of %zu cameras", cameras.size()),
                "a response belongs to one");
  return images;
}

manifest::Value value_of(const FoundResponse& found) {
  manifest::Value channels = manifest::Value::object();
  for (const photograph::ResponseCurve& curve : found.curves) {
    manifest::Value table = manifest::Value::array();
    for (const photograph::ResponseRow& row : curve.rows)
      table.push_back(manifest::Value(std::vector<double>{row.code, row.linear}));
    if (found.curves.size() == 1) return table;
    channels[curve.channel] = std::move(table);
  }
  return channels;
}

std::string csv_of(const FoundResponse& found) {
  std::string text = "channel,code,linear,sigma,seen\n";
  for (const photograph::ResponseCurve& curve : found.curves)
    for (const photograph::ResponseRow& row : curve.rows) {
      text += curve.channel;
      for (const double v : {row.code, row.linear, row.sigma}) text += "," + shortest_text(v);
      text += row.code >= curve.lowest && row.code <= curve.highest ? ",1\n" : ",0\n";
    }
  return text;
}

std::string times_of(const FoundResponse& found, const std::vector<double>& stated_s) {
  std::string text = "stated_s,found_s,sigma_s\n";
  for (std::size_t k = 0; k < stated_s.size(); ++k)
    text += shortest_text(stated_s[k]) + "," + shortest_text(found.times_s[k]) + "," +
            shortest_text(found.times_sigma[k]) + "\n";
  return text;
}

std::string words_of(const FoundResponse& found) {
  std::string text;
  for (const photograph::ResponseCurve& c : found.curves) {
    const auto halfway = std::ranges::min_element(c.rows, {}, [](const auto& r) { return std::abs(r.code - 0.25); });
    text += format("%s%s: codes %.2g to %.2g of %zu places, noise %.2g codes of 255, linear %.3g(%.0g) %% at code 1/4",
                   text.empty() ? "" : "; ", c.channel.c_str(), c.lowest, c.highest, c.patches, c.noise,
                   100 * halfway->linear, 100 * halfway->sigma);
    if (c.dropped > 0) text += format(", %zu places moved", c.dropped);
  }
  return text + format("; exponent uncertain by %.2g %%; chi-square per degree of freedom %.2f",
                       100 * found.exponent_sigma, found.chi_square_per_freedom);
}

}  // namespace

std::vector<cli::Option> response_options() {
  return {{.name = "find-response",
           .type = Type::flag,
           .help = "Find how codes of a camera that is not linear depend on light, from photographs of 8 or 16 bits of "
                   "one view at several exposures, and state it as the images' response.",
           .conflicts = {"merge", "undistort", "colour", "characterize"}},
          {.name = "shutter-error",
           .type = Type::number,
           .help = "How far stated exposure times may be off, relative, one standard deviation. 0: they are exact.",
           .preset = "0.01",
           .lower = 0,
           .upper = 0.5,
           .needs = {"find-response"}}};
}

void check_response(cli::Invocation& call) {
  if (call.out.empty()) throw Error(Exit::usage, "--out", "is missing", "name the folder for the table");
  if (!call.given("PHOTOGRAPH") && !call.has_document)
    throw Error(Exit::no_input, "develop", "has no photographs",
                "name them, or pipe in a manifest whose images have files");
  if (call.given("PHOTOGRAPH")) call.document.allow_outside = true;
}

Exit find_response(cli::Invocation& call) {
  std::vector<ResponseView> views;
  std::vector<std::size_t> images;
  if (call.given("PHOTOGRAPH"))
    views = views_of_photographs(call);
  else
    images = images_of_camera(call, views);
  if (views.empty())
    throw Error(Exit::no_input, "develop", "has no exposures of one view",
                "images of 8 or 16 bits with a group and exposure_s");
  for (const ResponseView& view : views) check_settings(view);
  // Before anything names the files: reading says what is wrong with them.
  const photograph::ResponseData data = photograph::response_data(views);
  const FoundResponse found = photograph::find_response(data, call.number("shutter-error"));
  write_file(call.output_path("response.csv"), csv_of(found));
  write_file(call.output_path("response-times.csv"), times_of(found, data.times_s));
  for (const ResponseView& view : views)
    for (const auto& path : view.pictures) call.note_input(path);
  if (call.given("PHOTOGRAPH")) images = enter_photographs(call, views);
  const manifest::Value response = value_of(found);
  for (const std::size_t i : images) call.document.images[i].response = response;
  log(LogLevel::info, words_of(found));
  return Exit::done;
}

}  // namespace gonio::tools::develop
