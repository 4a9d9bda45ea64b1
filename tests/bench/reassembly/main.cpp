// The other side of `scripts/experiments/reassembly.mk`: a laboratory that nobody has to own, and the truth about it.
// usage: reassembly-maker laboratory FOLDER WIDTH VOXELS PRESSED_MM SIGMA_MM SEED
//          what is there (truth.json with pressed-*.ply and room.exr), the probe (ball.json), what a scanner makes of
//          the background (scan.ply, with labels, and as parts: scan-*.ply before the vessels stood there,
//          scan-pressed-*.ply after), poses.json, and what surfaces
//          are taken for (lambertian.json, measured.json), and
//          believed.json, a patch that leaves of the recorded truth what the photographer knows
//        reassembly-maker piece NAME VOXELS PHOTONS SEED FOLDER
//          NAME.nrrd as the tomograph records it, NAME-true.ply
//        reassembly-maker unwrap BALL.json orthographic|perspective raw|divided MAP.exr
//        reassembly-maker assemble RIG.json BACKGROUND POSES.json PIECE.json...        prints a scene: poses from truth
//        reassembly-maker labelled SCENE.json SCAN.ply STEM        prints SCENE with its mesh `background` cut into
//        parts
//          by the labels of SCAN, of which it is a deformation
//        reassembly-maker patch FILE.json PATCH.json...                                prints FILE, merged (RFC 7386)
//        reassembly-maker take FILE.json SECTION...                                    prints these sections alone
//        reassembly-maker scale PHOTO.exr RENDERED.exr                                 prints by what RENDERED is too
//        dark reassembly-maker pixels PHOTO.exr RENDERED.exr                                prints a table of pixels
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "base/atomic_file.h"
#include "base/text.h"
#include "ct/true_surface.h"
#include "glassware.h"
#include "io/picture.h"
#include "io/ply.h"
#include "manifests.h"
#include "probe.h"
#include "stats/intervals.h"

namespace {

using namespace gonio;
using namespace gonio::reassembly_experiment;
using Words = std::vector<std::string>;

Value read(const std::filesystem::path& path) {
  return manifest::parse_json(read_file(path), path.string());
}
void write(const std::filesystem::path& path, const Value& value) {
  write_file(path, manifest::print_json(value) + "\n");
}

void laboratory(const Words& words) {
  const std::filesystem::path folder = words.at(0);
  const std::size_t voxels = std::stoul(words.at(2));
  const double sigma_m = std::stod(words.at(4)) / 1000;
  const std::uint64_t seed = std::stoul(words.at(5));
  Laboratory all;
  all.table = table(std::stod(words.at(3)) / 1000), all.width_px = std::stoi(words.at(1));
  const io::TriangleMesh rest = scanned(all.table.rest, sigma_m, seed);
  write_parts(folder, "pressed", all.table.pressed);
  write_parts(folder, "scan", rest);
  write_parts(folder, "scan-pressed", scanned(all.table.pressed, sigma_m, seed));
  io::write_ply(folder / "scan.ply", rest, {{}, true});
  io::write_picture(folder / "room.exr", room(512));
  write(folder / "ball.json", ball(all));
  write(folder / "poses.json", poses(all, voxels));
  write(folder / "lambertian.json", lambertian_surfaces());
  write(folder / "measured.json", measured_surfaces());
  write(folder / "believed.json", believed());
  write(folder / "truth.json", truth(all, voxels));
  std::fprintf(stderr, "the cloth gave way by %.2f mm\n", 1000 * all.table.deepest_m);
}

void piece(const Words& words) {
  const std::string& name = words.at(0);
  const std::filesystem::path folder = words.at(4);
  const auto [phantom, scanner] =
      scanned(piece_named(name), std::stoul(words.at(1)), std::stod(words.at(2)), std::stoul(words.at(3)));
  const io::VolumeData volume = ct::scan(phantom, scanner);
  float largest = 0;
  for (const float v : volume.values) largest = std::max(largest, v);
  io::write_ply(folder / (name + "-true.ply"), ct::true_surface(phantom, scanner));
  io::write_nrrd(folder / (name + ".nrrd"), ct::stored_as(volume, io::VoxelType::u16, 50000.0 / largest, 8000));
}

void labelled(const Words& words) {
  const std::filesystem::path file = words.at(0);
  Value document = read(file);
  const std::string id = document["meshes"]["background"]["file"].as_string();
  io::TriangleMesh mesh = io::read_ply(file.parent_path() / document["files"][id]["path"].as_string());
  mesh.labels = io::read_ply(words.at(1), {{}, true}).labels;
  if (mesh.labels.size() != mesh.triangles.size()) throw std::invalid_argument("the scan has other faces");
  write_parts(file.parent_path(), words.at(2), mesh);
  auto& objects = document["objects"].as_array();
  std::erase_if(objects, [](const Value& object) { return object.find("id")->as_string() == "background"; });
  merge(document, Value::object({{"meshes", Value::object({{"background", Value()}})},
                                 {"files", Value::object({{id, Value()}})}}));
  add_background(document, words.at(2));
  std::puts(manifest::print_json(document).c_str());
}

Vec3 vector_of(const Value& list) {
  const auto& v = list.as_array();
  return {v.at(0).as_number(), v.at(1).as_number(), v.at(2).as_number()};
}

void unwrap(const Words& words) {
  const std::filesystem::path file = words.at(0);
  Value document = read(file);
  Unwrap wish;
  wish.perspective = words.at(1) == "perspective", wish.divided = words.at(2) == "divided";
  wish.centre_m = vector_of(*document["objects"].as_array().front()["world_from_object"].find("translation_m"));
  wish.radius_m = document["meshes"]["ball"]["sphere"]["radius_m"].as_number();
  wish.eta = vector_of(document["surfaces"]["chrome"]["eta"]), wish.k = vector_of(document["surfaces"]["chrome"]["k"]);
  std::vector<io::Image> pictures;
  std::vector<BallView> views;
  for (Value& image : document["images"].as_array())
    pictures.push_back(
        io::read_picture(file.parent_path() / document["files"][image["file"].as_string()]["path"].as_string()));
  for (std::size_t k = 0; k < pictures.size(); ++k) {
    Value& image = document["images"].as_array()[k];
    Value& camera = document["cameras"][image["camera"].as_string()];
    const auto& q = image["world_from_camera"]["rotation"].as_array();
    views.push_back({&pictures[k],
                     camera["fx_px"].as_number(),
                     {camera["cx_px"].as_number(), camera["cy_px"].as_number()},
                     {{q[0].as_number(), q[1].as_number(), q[2].as_number(), q[3].as_number()},
                      vector_of(image["world_from_camera"]["translation_m"])}});
  }
  io::write_picture(words.at(3), unwrapped(views, wish));
}

// The median over blocks of the ratio of their sums: glass is in few blocks, and noise with rare bright pixels, which
// bends fits that weigh by variance, leaves sums alone.
void scale(const Words& words) {
  const io::Image photo = io::read_picture(words.at(0)), rendered = io::read_picture(words.at(1));
  constexpr int block = 10;
  std::vector<double> ratios;
  for (int top = 0; top + block <= photo.height; top += block)
    for (int left = 0; left + block <= photo.width; left += block) {
      double sums[2] = {0, 0};
      for (int y = top; y < top + block; ++y)
        for (int x = left; x < left + block; ++x)
          for (const char* name : {"R", "G", "B"})
            sums[0] += photo.at(x, y, photo.channel(name)), sums[1] += rendered.at(x, y, rendered.channel(name));
      if (sums[1] > 0) ratios.push_back(sums[0] / sums[1]);
    }
  std::printf("%.6f\n", stats::median(ratios));
}

// Means of blocks of pixels whose noise counts little, in tiles that are held out together: what an expression over
// columns is held against, where explain does not simulate the picture itself.
void pixels(const Words& words) {
  const io::Image photo = io::read_picture(words.at(0)), rendered = io::read_picture(words.at(1));
  constexpr int tiles = 6, block = 4;
  const double half = 0.5 * (photo.width - 1), middle = 0.5 * (photo.height - 1);
  std::puts("series,channel,image_radius,rendered,photographed,photographed_sigma");
  for (int top = 0; top + block <= photo.height; top += block)
    for (int left = 0; left + block <= photo.width; left += block)
      for (int c = 0; c < 3; ++c) {
        const char* names[] = {"R", "G", "B"};
        const std::string name = names[c];
        double r = 0, v = 0, variance = 0;
        constexpr double share = 1.0 / (block * block);
        for (int y = top; y < top + block; ++y)
          for (int x = left; x < left + block; ++x) {
            r += share * rendered.at(x, y, rendered.channel(name)), v += share * photo.at(x, y, photo.channel(name));
            // The photograph is a rendering, too, as noisy as this one, beside its sensor's noise.
            variance += share * share * (2 * rendered.at(x, y, rendered.channel("variance." + name)) + 2.5e-7);
          }
        variance += share * v / 16000;
        if (!(r > 0.02) || !(v > 0.02) || !(variance < 0.0025 * r * r)) continue;
        const double x = left + 0.5 * (block - 1), y = top + 0.5 * (block - 1);
        std::printf("%d,%d,%.5f,%.6f,%.6f,%.6f\n", top * tiles / photo.height * tiles + left * tiles / photo.width, c,
                    std::hypot(x - half, y - middle) / (half + 0.5), r, v, std::sqrt(variance));
      }
}

}  // namespace

int main(int argc, char** argv) try {
  const Words words(argv + std::min(argc, 2), argv + argc);
  const std::string what = argc > 1 ? argv[1] : "";
  if (what == "laboratory") {
    laboratory(words);
  } else if (what == "piece") {
    piece(words);
  } else if (what == "unwrap") {
    unwrap(words);
  } else if (what == "scale") {
    scale(words);
  } else if (what == "pixels") {
    pixels(words);
  } else if (what == "assemble") {
    std::vector<Value> pieces;
    for (std::size_t k = 3; k < words.size(); ++k) pieces.push_back(read(words[k]));
    std::puts(manifest::print_json(assembled(read(words.at(0)), words.at(1), read(words.at(2)), pieces)).c_str());
  } else if (what == "labelled") {
    labelled(words);
  } else if (what == "patch") {
    Value document = read(words.at(0));
    for (std::size_t k = 1; k < words.size(); ++k) merge(document, read(words[k]));
    std::puts(manifest::print_json(document).c_str());
  } else if (what == "take") {
    const Value document = read(words.at(0));
    Value taken = Value::object();
    for (std::size_t k = 1; k < words.size(); ++k)
      if (const Value* section = document.find(words[k])) taken[words[k]] = *section;
    std::puts(manifest::print_json(taken).c_str());
  } else {
    std::fprintf(stderr,
                 "usage: reassembly-maker laboratory|piece|unwrap|assemble|labelled|patch|take|scale|pixels ...\n");
    return 64;
  }
  return 0;
} catch (const std::exception& e) {
  std::fprintf(stderr, "reassembly-maker: %s\n", e.what());
  return 70;
}
