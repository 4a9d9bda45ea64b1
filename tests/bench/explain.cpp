// scripts/bench explain: how the time of an explanation grows.
//
//   bench-explain table ROWS GROUPS CANDIDATES   seconds of explaining so many rows by so many mechanisms (formulas)
//   bench-explain scene FOLDER WIDTH IMAGES      records a ball on a table with gloss that the manifest leaves out:
//                                                IMAGES pictures of WIDTH x WIDTH pixels, FOLDER/recording.json
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <string>

#include "base/atomic_file.h"
#include "base/error.h"
#include "explain/engine.h"
#include "inference/nonlinear_toy.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "render/looking_at.h"
#include "render/path_tracer.h"
#include "render/ray_caster.h"
#include "scene/scene.h"

namespace gonio::explain {
namespace {

namespace fs = std::filesystem;

// The library of the tests, and powers of x and z for the rest.
std::vector<tests::Effect> effects(std::size_t count) {
  std::vector<tests::Effect> all = tests::library();
  for (std::size_t k = all.size(); k < count; ++k) {
    const int px = static_cast<int>(k % 5), pz = static_cast<int>(k / 5 % 5) + 1;
    all.push_back(
        {"toy.power-" + std::to_string(k), {tests::amplitude()}, {"x", "z"}, [=](tests::Numbers p, double x, double z) {
           return p[0] * std::pow(x, px) * std::pow(z, pz) * (1 + 0.01 * static_cast<double>(k));
         }});
  }
  all.resize(count);
  return all;
}

int table(std::size_t rows, std::size_t groups, std::size_t candidates) {
  std::vector<std::vector<double>> truth(candidates);
  truth[0] = {0.25};
  const tests::Size size{groups, std::max<std::size_t>(4, rows / groups / 2), 2};
  const tests::NonlinearToy problem(effects(candidates), truth, {{}, 0.1, 0.03}, 1, size);
  const auto begin = std::chrono::steady_clock::now();
  const Explanation e = explain(problem, Options{});
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  std::printf("%.3f %s\n", seconds, e.named.empty() ? "-" : problem.candidates()[e.named[0]].id().c_str());
  return 0;
}

std::string numbers(Vec3 v) {
  return "[" + std::to_string(v.x) + "," + std::to_string(v.y) + "," + std::to_string(v.z) + "]";
}

std::string pose(Vec3 from) {
  const auto p = render::looking_at(from, {0, 0, 0.05});
  const auto q = p.rotation;
  return "{\"rotation\":[" + std::to_string(q.w) + "," + std::to_string(q.x) + "," + std::to_string(q.y) + "," +
         std::to_string(q.z) + "],\"translation_m\":" + numbers(p.translation_m) + "}";
}

std::string manifest_text(int width, int images, const std::string& mechanisms) {
  const Vec3 lamps[3] = {{0.3, -0.3, 0.4}, {-0.35, -0.1, 0.45}, {0.05, 0.25, 0.5}};
  std::string files, entries, lights;
  for (int l = 0; l < 3; ++l)
    lights += std::string(l ? "," : "") + "\"lamp-" + std::to_string(l) +
              "\":{\"model\":\"point\",\"position_m\":" + numbers(lamps[l]) +
              ",\"watt_per_sr\":{\"value\":[0.6,0.6,0.6],\"free\":true,\"share\":\"lamp\"}}";
  for (int i = 0; i < images; ++i) {
    const double turn = 2.1 * (i / 3);
    const std::string id = "image-" + std::to_string(i), comma = i ? "," : "";
    files += comma + "\"" + id + "\":{\"path\":\"" + id + ".exr\"}";
    entries += comma + "{\"id\":\"" + id + "\",\"file\":\"" + id + "\",\"camera\":\"camera\",\"world_from_camera\":" +
               pose({0.5 * std::cos(turn), 0.5 * std::sin(turn), 0.32}) + ",\"light\":\"lamp-" + std::to_string(i % 3) +
               "\",\"noise\":{\"gain\":1e9,\"read\":0.002}}";
  }
  const std::string size = std::to_string(width), focal = std::to_string(1.8 * width),
                    centre = std::to_string((width - 1) / 2.0);
  return "{\"gonio\":1,\"files\":{" + files + "},\"cameras\":{\"camera\":{\"width_px\":" + size +
         ",\"height_px\":" + size + ",\"fx_px\":" + focal + ",\"fy_px\":" + focal + ",\"cx_px\":" + centre +
         ",\"cy_px\":" + centre +
         "}},\"meshes\":{\"ball\":{\"sphere\":{\"radius_m\":0.08}},\"table\":{\"plane\":{\"size_m\":[1.5,1.5]}}},"
         "\"surfaces\":{\"ball\":{\"model\":\"diffuse\",\"albedo\":{\"value\":[0.5,0.4,0.3],\"free\":true}},"
         "\"table\":{\"model\":\"diffuse\",\"albedo\":{\"value\":[0.5,0.5,0.5],\"free\":true}}},\"lights\":{" +
         lights +
         "},\"objects\":[{\"id\":\"ball\",\"mesh\":\"ball\",\"surface\":\"ball\",\"world_from_object\":{\"rotation\":"
         "[1,0,0,0],\"translation_m\":[0,0,0.081]}},{\"id\":\"table\",\"mesh\":\"table\",\"surface\":\"table\"}],"
         "\"images\":[" +
         entries + "],\"mechanisms\":{" + mechanisms + "}}";
}

int record(const fs::path& folder, int width, int images) {
  fs::create_directories(folder);
  const std::string gloss = "\"surface.interface\":{\"on\":[\"ball\"],\"f0\":0.05,\"alpha\":0.2}";
  const manifest::Document truth = manifest::parse_document(manifest_text(width, images, gloss), "truth", folder);
  const scene::Scene scene = scene::build_scene(truth);
  const render::RayCaster caster(scene.instances);
  render::Options options;
  options.spp = 64;
  options.geometry = false;
  for (std::size_t v = 0; v < scene.views.size(); ++v) {
    const io::Image rendered = render::render(scene, v, caster, options);
    io::Image picture(width, width, {"R", "G", "B"});
    Random random(1, v);
    for (std::size_t i = 0; i < picture.pixels(); ++i)
      for (std::size_t c = 0; c < 3; ++c)
        picture.data[3 * i + c] =
            rendered.data[i * rendered.channels.size() + c] + static_cast<float>(0.002 * random.normal());
    io::write_picture(folder / ("image-" + std::to_string(v) + ".exr"), picture);
  }
  write_file(folder / "recording.json", manifest_text(width, images, ""));
  return 0;
}

}  // namespace
}  // namespace gonio::explain

int main(int argc, char** argv) {
  const std::string task = argc > 1 ? argv[1] : "";
  const auto count = [&](int k) { return static_cast<std::size_t>(std::atoll(argv[k])); };
  try {
    if (task == "table" && argc == 5) return gonio::explain::table(count(2), count(3), count(4));
    if (task == "scene" && argc == 5) return gonio::explain::record(argv[2], std::atoi(argv[3]), std::atoi(argv[4]));
  } catch (const std::exception& e) {
    std::cerr << e.what() << "\n";
    return 1;
  }
  std::cerr << "usage: bench-explain table ROWS GROUPS CANDIDATES | scene FOLDER WIDTH IMAGES\n";
  return 64;
}
