#include "tools/glass-net/call.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/loaded_library.h"
#include "base/lower_case.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "base/text.h"
#include "glass/net/answer.h"
#include "glass/net/onnx_module.h"
#include "glass/net/reliability.h"
#include "io/picture.h"
#include "manifest/image_list.h"
#include "manifest/sections/image.h"
#include "photograph/raw_frame.h"

namespace gonio::tools::glass_net {
namespace {

namespace fs = std::filesystem;
using namespace gonio::glass;
using cli::Type;

struct Photograph {
  std::string id;
  fs::path path;
  std::optional<std::size_t> image;  // of the manifest
};

std::vector<Photograph> photographs_of(const cli::Invocation& call) {
  std::vector<Photograph> all;
  std::set<std::string> ids;
  for (const std::string& text : call.texts("PHOTOGRAPH")) {
    all.push_back({fs::path(text).stem().string(), text, std::nullopt});
    if (!ids.insert(all.back().id).second)
      throw Error(Exit::usage, text, "has the name of another photograph", "their names name what is written");
  }
  if (!all.empty()) return all;
  const std::vector<std::string>& asked = call.texts("image");
  for (const std::string& id : asked)
    if (!manifest::index_of_image(call.document, id))
      throw Error(Exit::usage, "--image", "\"" + id + "\" is no image of the manifest", "name one of them");
  for (std::size_t i = 0; i < call.document.images.size(); ++i) {
    const manifest::ImageEntry& image = call.document.images[i];
    if (asked.empty() ? !image.file.empty() : std::ranges::find(asked, image.id) != asked.end())
      all.push_back({image.id, manifest::picture_path(call.document, i), i});
  }
  if (all.empty())
    throw Error(Exit::usage, "glass-net", "has no photograph to look at", "name files, or give a manifest with images");
  return all;
}

// EXR as it is; other files are read as codes of a sensor behind its mosaic, or, for weights on RGB, as sRGB.
io::Image read_photograph(const cli::Invocation& call, const fs::path& path, const std::string& input) {
  if (lower_case(path.extension().string()) == ".exr") return io::read_picture(path);
  if (input == "rgb") {
    io::Image picture = io::read_picture(path);
    for (float& value : picture.data) value = io::linear_from_srgb(value);
    return picture;
  }
  photograph::RawStated stated;
  stated.mosaic = "polarizers";
  if (call.given("black")) stated.black = call.number("black");
  photograph::RawFrame frame = photograph::read_raw_frame(path, stated);
  io::Image picture(frame.width, frame.height, {"Y"});
  picture.data = std::move(frame.codes);
  return picture;
}

int shrink_for(const cli::Invocation& call, const Weights& weights, const io::Image& picture) {
  if (call.given("shrink")) return static_cast<int>(call.integer("shrink"));
  return std::max(1, static_cast<int>(std::lround(static_cast<double>(picture.height) / weights.height_px)));
}

// From the camera's frame into the world's.
void turn_normals(io::Image& answer, const Mat3& world_from_camera) {
  for (const char* name : {"normal.X", "back_normal.X"}) {
    const int c = answer.channel(name);
    for (std::size_t i = 0; c >= 0 && i < answer.pixels(); ++i) {
      float* at = &answer.data[i * answer.channels.size() + static_cast<std::size_t>(c)];
      const Vec3 normal = world_from_camera * Vec3{at[0], at[1], at[2]};
      for (int k = 0; k < 3; ++k) at[k] = static_cast<float>(normal[k]);
    }
  }
}

struct Answered {
  Looked looked;
  io::Image full;  // as many pixels as the photograph
};
Answered look_at(cli::Invocation& call, const Weights& weights, const Photograph& photograph) {
  const std::string place = photograph.path.string();
  call.note_input(photograph.path);
  const io::Image picture = read_photograph(call, photograph.path, weights.input);
  const int shrink = shrink_for(call, weights, picture);
  Planes seen = seen_of(picture, weights.input, shrink, place);
  in_mean_light(seen, weights.input, place);
  const io::Image answer = answer_of(weights, seen, static_cast<int>(call.integer("tile")));
  Answered made{{photograph.id, io::Image(answer.width, answer.height, {"Y"}),
                 as_photographed(answer, 1, answer.width, answer.height)},
                as_photographed(answer, shrink, picture.width, picture.height)};
  std::copy_n(seen.plane(0), seen.pixels(), made.looked.light.data.begin());
  if (!photograph.image || !call.document.images[*photograph.image].world_from_camera) return made;
  const Mat3 world_from_camera = matrix_of(call.document.images[*photograph.image].world_from_camera->rotation);
  turn_normals(made.looked.answer, world_from_camera), turn_normals(made.full, world_from_camera);
  return made;
}

void enter(cli::Invocation& call, const Photograph& photograph, const fs::path& answer) {
  if (!photograph.image) {
    manifest::ImageEntry image;
    image.id = photograph.id;
    image.file = manifest::add_file(call.document, photograph.path, photograph.id);
    call.document.images.push_back(std::move(image));
  }
  manifest::add_file(call.document, answer, photograph.id + "-glass");
}

Exit check_reliability(cli::Invocation& call, const Weights& weights) {
  const fs::path set = call.text("reliability");
  const SetAnswers answers = answers_of_set(weights, set, call.text("share"));
  const std::string text = reliability_text(weights, answers);
  std::fputs(text.c_str(), stdout);
  call.writes_document = false;
  bool honest = true;
  for (const auto& [head, r] : answers.heads)
    honest = honest && !r.bins.empty() && r.calibration_error <= call.number("most");
  return honest ? Exit::done : Exit::negative;
}

}  // namespace

std::vector<cli::Option> options() {
  return {
      {.name = "weights",
       .type = Type::folder,
       .help = "Folder of a training: network.onnx and run.json. There are none without."},
      {.name = "image", .type = Type::text, .help = "Look at this image only.", .metavar = "ID", .repeat = true},
      {.name = "shrink",
       .type = Type::integer,
       .help = "Show the network means of N x N pixels. Left out: as many as make the picture as high as those that it "
               "learnt from.",
       .metavar = "N",
       .lower = 1,
       .upper = 256},
      {.name = "tile",
       .type = Type::integer,
       .help = "Longest side of what the network sees at once, in pixels; parts overlap as far as it looks.",
       .metavar = "N",
       .preset = "1024",
       .lower = 16,
       .upper = 8192},
      {.name = "black", .type = Type::number, .help = "Code of a photograph without light.", .lower = 0},
      {.name = "reliability",
       .type = Type::folder,
       .help = "Look at no photograph: hold the stated uncertainties against the truth of this set of glass-make(1).",
       .conflicts = {"image", "shrink", "tile", "black", "out"}},
      {.name = "share",
       .type = Type::choice,
       .help = "Which cells of the set.",
       .preset = "test",
       .choices = {"training", "validation", "test"},
       .needs = {"reliability"}},
      {.name = "most",
       .type = Type::quantity,
       .help = "Largest calibration error that is honest.",
       .preset = "5%",
       .dimension = Dimension::ratio,
       .lower = 0,
       .upper = 1,
       .needs = {"reliability"}},
  };
}

void check(cli::Invocation& call) {
  if (!call.given("weights"))
    throw Error(Exit::usage, "--weights", "is missing: glass-net has no weights of its own",
                "name the folder of a training; scripts/glass-net/train makes one from a set of glass-make(1)");
  read_weights(call.text("weights"));
  if (call.given("reliability")) {
    if (call.texts("PHOTOGRAPH").empty()) return;
    throw Error(Exit::usage, "--reliability", "looks at no photograph", "leave the photographs out");
  }
  if (call.out.empty()) throw Error(Exit::usage, "--out", "is missing", "name the folder for what is written");
  photographs_of(call);
}

Exit run(cli::Invocation& call) {
  const fs::path folder = call.text("weights");
  const Weights weights = read_weights(folder);
  for (const char* name : {"run.json", "network.onnx"}) call.note_input(folder / name);
  loaded_from_module<decltype(gonio_onnx_threads)>("onnx", "gonio_onnx_threads")(threads());
  if (call.given("reliability")) return check_reliability(call, weights);
  if (weights.calibration.empty())
    log(LogLevel::warning, folder.string() + ": says nothing of its errors: its set had no validation share");
  const std::vector<Photograph> photographs = photographs_of(call);
  for (const Photograph& photograph : photographs) call.output_path(photograph.id + ".exr");
  std::vector<Looked> all;
  Progress progress("photographs", photographs.size());
  for (const Photograph& photograph : photographs) {
    throw_if_interrupted();
    Answered made = look_at(call, weights, photograph);
    const fs::path path = call.output_path(photograph.id + ".exr");
    io::write_picture(path, made.full);
    all.push_back(std::move(made.looked));
    enter(call, photograph, path);
    log(LogLevel::info, summary_of(all.back()));
    progress.advance();
  }
  const fs::path page = call.output_path("report.html");
  write_file(page, page_of(all, folder.string()));
  manifest::add_file(call.document, page, "glass-net-page");
  return Exit::done;
}

}  // namespace gonio::tools::glass_net
