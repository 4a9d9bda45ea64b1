// See call.h.
#include "tools/glass-refine/call.h"

#include <algorithm>

#include "base/atomic_file.h"
#include "base/progress.h"
#include "base/text.h"
#include "glass/refine/answer.h"
#include "io/picture.h"
#include "manifest/image_list.h"
#include "manifest/sections/comparison.h"
#include "manifest/sections/image.h"

namespace gonio::tools::glass_refine {

using namespace gonio::glass;

namespace {

using cli::Type;
namespace fs = std::filesystem;

constexpr const char* name_of_body = "refined";

std::size_t held_out(const cli::Invocation& call) {
  if (!call.given("hold-out")) return call.document.images.empty() ? 0 : call.document.images.size() - 1;
  const auto image = manifest::index_of_image(call.document, call.text("hold-out"));
  if (!image)
    throw Error(Exit::usage, "--hold-out", "\"" + call.text("hold-out") + "\" is no image of the manifest",
                "name one of `images`");
  return *image;
}

ViewFiles files_of(cli::Invocation& call) {
  ViewFiles files;
  files.on_file = [&](const fs::path& path) { call.note_input(path); };
  if (call.given("network")) files.network = call.text("network");
  files.most_px = static_cast<int>(call.integer("pixels"));
  return files;
}

RefineWish wish_of(const cli::Invocation& call) {
  RefineWish wish;
  wish.hull.cells = static_cast<int>(call.integer("cells"));
  if (call.given("stands-on")) wish.hull.floor_m = call.number("stands-on");
  wish.index = call.number("index"), wish.index_sigma = call.number("index-sigma");
  wish.held_out = held_out(call);
  wish.light = !call.flag("no-light");
  wish.seed = call.seed;
  return wish;
}

// Writes the stage's mesh, and the view that was held out as it is rendered with it.
Rendered rendered_with(const cli::Invocation& call, const View& view, const Stage& stage, std::size_t image,
                       const std::string& name) {
  const fs::path mesh = call.output_path(name + ".ply"), picture = call.output_path("held-out-" + name + ".exr");
  io::write_ply(mesh, mesh_of(stage.field));
  const int spp = static_cast<int>(call.integer("spp"));
  if (spp == 0) return {};
  manifest::Document document = call.document;
  document.allow_outside = true;  // its own files lie where the manifest does, the body below --out
  enter_body(document, stage, 0, name, mesh);
  const io::Image rendered = rendered_with_stokes(document, image, spp, call.seed, picture);
  io::write_picture(picture, rendered);
  return {difference_from(view, rendered), rendered};
}

std::string table_of(const Refined& refined, double index_sigma) {
  std::string text = "stage,unexplained,unexplained_held_out,index,index_sigma,absorption_per_m,answer\n";
  for (std::size_t s = 0; s < refined.stages.size(); ++s) {
    const Stage& stage = refined.stages[s];
    const bool answer = s == refined.answer;
    text += format("%s,%.5f,%.5f,%.5f,%s,%.4f,%d\n", stage.name.c_str(), stage.unexplained, stage.unexplained_held_out,
                   stage.glass.index, answer && index_sigma > 0 ? format("%.5f", index_sigma).c_str() : "",
                   stage.glass.absorption / stage.field.cell_m(), answer ? 1 : 0);
  }
  return text;
}

void enter_comparison(manifest::Document& document, const View& view, double before, double after) {
  manifest::Comparison comparison;
  comparison.image = view.id;
  comparison.rmse = after * view.screen->mean_luminance();
  comparison.relative_rmse = after;
  std::int64_t pixels = 0;
  for (const float d : view.outline_px) pixels += d > 0 ? 1 : 0;
  comparison.pixels = pixels;
  document.comparisons.push_back(std::move(comparison));
  log(LogLevel::info, format("%s, kept out: the rendering with the hull differs from the photograph by %.3f of "
                             "the screen's mean, with the refined body by %.3f",
                             view.id.c_str(), before, after));
}

std::vector<io::Image> write_maps(cli::Invocation& call, const Refined& refined, const Measuring& measuring,
                                  std::size_t views) {
  make_folder(call.out / "maps");
  std::vector<io::Image> all;
  for (std::size_t v = 0; v < views; ++v) {
    const std::string& id = measuring.view(v).id;
    const fs::path path = call.output_path("maps/" + file_stem(id) + ".exr");
    all.push_back(maps_of(refined, measuring, v));
    io::write_picture(path, all.back());
    manifest::add_file(call.document, path, "maps-" + id);
  }
  return all;
}

}  // namespace

std::vector<cli::Option> options() {
  return {
      {.name = "network",
       .type = Type::folder,
       .help = "Answers of a network, IMAGE.exr for each image, as glass-net(1) writes them."},
      {.name = "hold-out",
       .type = Type::text,
       .help = "The image that is kept out of the fit, to judge it; left out: the last.",
       .metavar = "IMAGE"},
      {.name = "stands-on",
       .type = Type::quantity,
       .help = "The object stands on the plane z = this of the world.",
       .dimension = Dimension::length,
       .lower = -1e3,
       .upper = 1e3},
      {.name = "cells",
       .type = Type::integer,
       .help = "Of the grid, along the object's longest side.",
       .preset = "36",
       .lower = 10,
       .upper = 128},
      {.name = "pixels",
       .type = Type::integer,
       .help = "Photographs with more pixels a side are reduced to at most so many.",
       .preset = "160",
       .lower = 16,
       .upper = 1024},
      {.name = "index",
       .type = Type::number,
       .help = "Index of refraction where nothing else is known.",
       .preset = "1.52",
       .lower = 1.2,
       .upper = 2.2},
      {.name = "index-sigma",
       .type = Type::number,
       .help = "Its standard deviation.",
       .preset = "0.06",
       .lower = 1e-4,
       .upper = 0.5},
      {.name = "no-light", .type = Type::flag, .help = "Stop after outlines and the network's normals."},
      {.name = "spp",
       .type = Type::integer,
       .help = "Samples per pixel of the renderings that judge the answer; 0: none.",
       .preset = "64",
       .lower = 0,
       .upper = 1 << 16},
  };
}

void check(cli::Invocation& call) {
  if (call.given("MANIFEST") && !call.text("MANIFEST").ends_with(".json"))
    throw Error(Exit::usage, call.text("MANIFEST"), "is no manifest", "name a file that ends in .json");
  if (call.out.empty()) throw Error(Exit::usage, "--out", "is missing", "name the folder of the answer");
  held_out(call);
  if (call.given("network")) {
    const fs::path folder = call.text("network");
    if (!fs::is_directory(folder)) throw Error(Exit::no_input, folder.string(), "is no folder");
    const std::vector<std::string> images = manifest::names_in(call.document, "images");
    if (std::ranges::none_of(images, [&](const std::string& id) { return fs::exists(folder / (id + ".exr")); }))
      throw Error(Exit::no_input, folder.string(), "holds no IMAGE.exr of an image of the manifest",
                  "glass-net -i MANIFEST writes them");
  }
  if (call.document.images.size() < 4)
    throw Error(Exit::data, manifest::place(call.document, "/images"),
                format("are %zu views", call.document.images.size()),
                "give 4 or more, from all round: one judges the others");
}

Exit run(cli::Invocation& call) {
  const RefineWish wish = wish_of(call);
  const std::vector<View> views = views_in(call.document, files_of(call));
  const Refined refined = refine(views, wish);
  const Measuring measuring(views, wish.sigmas);
  const std::size_t image = *wish.held_out;
  const Rendered before = rendered_with(call, views[image], refined.stages.front(), image, "hull");
  const Rendered after = rendered_with(call, views[image], refined.best(), image, name_of_body);
  const std::vector<io::Image> maps = write_maps(call, refined, measuring, views.size());
  const fs::path table = call.output_path("stages.csv");
  write_file(table, table_of(refined, refined.index_sigma));
  manifest::add_file(call.document, table, "stages");
  const fs::path page = call.output_path("report.html");
  write_file(page, page_of(refined, views, image, maps, before, after));
  manifest::add_file(call.document, page, "glass-refine-page");
  enter_body(call.document, refined.best(), refined.index_sigma, name_of_body, call.out / "refined.ply");
  if (call.integer("spp") > 0) enter_comparison(call.document, views[image], before.difference, after.difference);
  if (wish.light && refined.index_sigma == 0)
    log(LogLevel::warning,
        "two refractions do not explain the view that was kept out any better: the answer is that of "
        "outlines and network, the index is the one given; is the object hollow?");
  return Exit::done;
}

}  // namespace gonio::tools::glass_refine
