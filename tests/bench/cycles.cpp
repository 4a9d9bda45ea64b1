// scripts/bench render: the same scenes through `render` and through Blender's Cycles.
//
//   bench-render scenes FOLDER BUNNY SKY   manifests for the race of speed and for the test of agreement, with what
//                                          they need; BUNNY: a PLY file, SKY: a latitude-longitude EXR
//   bench-render grid TRIANGLES FOLDER     one scene of a wavy sheet with so many triangles
//   bench-render timed COMMAND...          runs it; prints wall time s, processor time s, peak memory MiB
//   bench-render error PICTURE REFERENCE   relative mean square error
//   bench-render agree OURS THEIRS...      blocks of 8 x 8 pixels: ours with its variance against several renderings of
//                                          theirs that differ in their seed (Welch 1947)
//
// Relative mean square error: the mean over pixels and colours of (v - r)^2 / (r^2 + e^2), e a tenth of the reference's
// mean, so that black pixels count no more than dim ones.
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include "base/atomic_file.h"
#include "base/error.h"
#include "camera/intrinsics.h"
#include "io/merl.h"
#include "io/picture.h"
#include "io/ply.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"
#include "render/looking_at.h"
#include "render/specimen_glass.h"
#include "stats/distributions.h"
#include "surface/half_angle.h"
#include "surface/surface.h"

namespace gonio::bench {
namespace {

using manifest::Document;
namespace fs = std::filesystem;

// ---- scenes -------------------------------------------------------------------------------------------------------

void add_object(Document& document, const std::string& id, const std::string& surface, Vec3 at) {
  manifest::Object object{.id = id, .mesh = id, .surface = surface, .world_from_object = {}};
  object.world_from_object.emplace().translation_m = at;
  document.objects.push_back(object);
}

void add_camera(Document& document, Vec3 position_m, Vec3 target_m, int width_px, int height_px, double focal_px) {
  camera::enter_pinhole(document, "camera", width_px, height_px, focal_px);
  keep_images(document, {});
  const auto pose = render::looking_at(position_m, target_m);
  manifest::enter_image(document, {.id = "view", .camera = "camera", .world_from_camera = {pose, {}}});
}

void add_lamp(Document& document, double radius_m) {
  manifest::Light& lamp = document.lights["lamp"];
  lamp.model = radius_m > 0 ? "sphere" : "point";
  lamp.parameters = {{"position_m", std::vector<double>{0.3, -0.35, 0.5}},
                     {"watt_per_sr", std::vector<double>{1, 1, 1}}};
  if (radius_m > 0) lamp.parameters["radius_m"] = radius_m;
}

void add_sky(Document& document, const fs::path& sky) {
  manifest::Light& light = document.lights["sky"];
  light.model = "lat-long";
  light.file = manifest::add_file(document, sky, "sky");
}

void set_surface(Document& document, const std::string& id, const std::string& model, manifest::Parameters parameters) {
  manifest::Surface& surface = document.surfaces[id];
  surface.model = model;
  surface.parameters = std::move(parameters);
}

Document on_table(double albedo = 0.5) {
  Document document;
  document.meshes["table"].plane_size_m = {1.2, 1.2};
  set_surface(document, "table", "diffuse", {{"albedo", albedo}});
  add_object(document, "table", "table", {});
  return document;
}

// The bunny stands on z = 0 in its file (y up is turned by the recordings' own mesh).
Document bunny(const fs::path& mesh, const std::string& model, manifest::Parameters parameters) {
  Document document = on_table();
  document.meshes["bunny"].file = manifest::add_file(document, mesh, "bunny");
  set_surface(document, "bunny", model, std::move(parameters));
  add_object(document, "bunny", "bunny", {});
  add_camera(document, {0.05, -0.42, 0.2}, {0, 0, 0.05}, 240, 180, 420);
  return document;
}

Document ball(const std::string& model, manifest::Parameters parameters) {
  Document document = on_table();
  document.meshes["ball"].sphere_radius_m = 0.05;
  set_surface(document, "ball", model, std::move(parameters));
  add_object(document, "ball", "ball", {0, 0, 0.05});
  add_camera(document, {0.05, -0.42, 0.2}, {0, 0, 0.05}, 160, 120, 380);
  return document;
}

// A registered surface as a measured table in the file format of the MERL database.
void write_table(const fs::path& path, const std::string& model, const manifest::Parameters& parameters) {
  const surface::Model* law = surface::find(model);
  const surface::Values values = surface::values_of(*law, parameters, "/surfaces/" + model);
  io::MerlTable table{.bins = {90, 90, 180}, .brdf_per_sr = {}};
  for (std::size_t h = 0; h < table.bins[0]; ++h)
    for (std::size_t d = 0; d < table.bins[1]; ++d)
      for (std::size_t p = 0; p < table.bins[2]; ++p) {
        const double root = (static_cast<double>(h) + 0.5) / 90;
        const surface::HalfAngles angles{root * root * pi / 2, (static_cast<double>(d) + 0.5) / 90 * pi / 2,
                                         (static_cast<double>(p) + 0.5) / 180 * pi};
        const auto [wo, wi] = surface::directions_of(angles);
        const bool above = wo.z > 0 && wi.z > 0;
        const Rgb brdf = above ? law->evaluate(values, wo, wi) : Rgb{-1, -1, -1};
        for (const double f : {brdf.x, brdf.y, brdf.z}) table.brdf_per_sr.push_back(static_cast<float>(f));
      }
  io::write_merl(path, table);
}

void save(const Document& document, const fs::path& path) {
  write_file(path, manifest::print_document(document, path.parent_path()));
}

void scenes(const fs::path& folder, const fs::path& mesh, const fs::path& sky) {
  make_folder(folder);
  const std::vector<double> clay{0.62, 0.36, 0.24}, scatter{900, 1200, 1500}, absorb{2, 10, 30};
  Document race = bunny(mesh, "diffuse", {{"albedo", clay}});
  add_lamp(race, 0);
  save(race, folder / "race-bunny.json");
  race = bunny(mesh, "dipole", {{"eta", 1.3}, {"sigma_a_per_m", absorb}, {"sigma_s_per_m", scatter}});
  add_lamp(race, 0.03);
  save(race, folder / "race-translucent.json");
  race = render::glass_specimen(folder);
  keep_images(race, {"front"});
  race.lights.clear();
  add_sky(race, sky);
  save(race, folder / "race-bowl.json");
  // The same metal as a table, and as the formula that filled it for the program that reads no tables.
  const manifest::Parameters metal{{"f0", std::vector<double>{0.9, 0.6, 0.3}}, {"alpha", 0.2}};
  write_table(folder / "metal.binary", "metal", metal);
  race = ball("merl", {});
  race.surfaces["ball"].file = manifest::add_file(race, folder / "metal.binary", "metal");
  add_lamp(race, 0.03);
  save(race, folder / "race-merl.json");
  race = ball("metal", metal);
  add_lamp(race, 0.03);
  save(race, folder / "peer-merl.json");

  const auto agree = [&](const std::string& name, Document document, double radius_m, bool under_sky) {
    if (radius_m >= 0) add_lamp(document, radius_m);
    if (under_sky) add_sky(document, sky);
    save(document, folder / ("agree-" + name + ".json"));
  };
  agree("diffuse", bunny(mesh, "diffuse", {{"albedo", clay}}), 0, false);
  agree("coated", ball("coated-diffuse", {{"albedo", clay}, {"f0", 0.04}, {"alpha", 0.15}}), 0.03, false);
  agree("metal", ball("metal", {{"f0", std::vector<double>{0.9, 0.6, 0.3}}, {"alpha", 0.25}}), 0.03, false);
  agree("glass", ball("dielectric", {{"eta", 1.5}, {"alpha", 0.15}}), -1, true);
  agree("absorbing", ball("dielectric", {{"eta", 1.5}, {"sigma_a_per_m", std::vector<double>{20, 5, 12}}}), -1, true);
  agree("frosted", ball("dielectric", {{"eta", 1.5}, {"alpha", 0.03}}), -1, true);
  agree("medium",
        ball("dielectric", {{"eta", 1.3},
                            {"sigma_a_per_m", std::vector<double>{2, 5, 10}},
                            {"sigma_s_per_m", std::vector<double>{60, 80, 100}},
                            {"g", 0.4}}),
        -1, true);
}

// A sheet of 2 n^2 triangles with waves, above a table: rays meet small triangles at every depth of the tree.
void grid(std::size_t triangles, const fs::path& folder) {
  make_folder(folder);
  const auto n = static_cast<std::uint32_t>(std::lround(std::sqrt(static_cast<double>(triangles) / 2)));
  io::TriangleMesh mesh;
  mesh.positions_m.reserve((n + 1) * static_cast<std::size_t>(n + 1));
  mesh.triangles.reserve(2 * static_cast<std::size_t>(n) * n);
  for (std::uint32_t j = 0; j <= n; ++j)
    for (std::uint32_t i = 0; i <= n; ++i) {
      const double x = 0.3 * (i / static_cast<double>(n) - 0.5), y = 0.3 * (j / static_cast<double>(n) - 0.5);
      mesh.positions_m.push_back(
          {x, y, 0.02 + 0.006 * std::sin(120 * x) * std::cos(90 * y) + 0.002 * std::sin(900 * x)});
    }
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
  const fs::path file = folder / "sheet.ply";
  io::write_ply(file, mesh);
  Document document = on_table();
  document.meshes["sheet"].file = manifest::add_file(document, file, "sheet");
  set_surface(document, "sheet", "diffuse", {{"albedo", 0.6}});
  add_object(document, "sheet", "sheet", {});
  add_lamp(document, 0);
  add_camera(document, {0.05, -0.42, 0.3}, {0, 0, 0.02}, 320, 240, 500);
  save(document, folder / "sheet.json");
}

// ---- measurements -------------------------------------------------------------------------------------------------

int timed(char** command) {
  const auto begin = std::chrono::steady_clock::now();
  const pid_t child = ::fork();
  if (child == 0) {
    ::dup2(2, 1);  // what it prints goes to stderr: standard output carries the figures
    ::execvp(command[0], command);
    ::_exit(127);
  }
  int status = 0;
  rusage use{};
  ::wait4(child, &status, 0, &use);
  const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const auto seconds = [](timeval t) { return static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_usec) * 1e-6; };
  std::printf("%.3f %.3f %.0f\n", wall, seconds(use.ru_utime) + seconds(use.ru_stime),
              static_cast<double>(use.ru_maxrss) / 1024);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}

struct Picture {
  io::Image image;
  std::array<int, 3> rgb, variance;
  explicit Picture(const fs::path& path)
      : image(io::read_picture(path)),
        rgb{image.channel("R"), image.channel("G"), image.channel("B")},
        variance{image.channel("variance.R"), image.channel("variance.G"), image.channel("variance.B")} {
    if (rgb[0] < 0 || rgb[1] < 0 || rgb[2] < 0) throw Error(Exit::data, path.string(), "has no channels R, G, B");
  }
  double at(int x, int y, std::size_t c) const { return image.at(x, y, rgb[c]); }
};

double relative_error(const Picture& picture, const Picture& reference) {
  const int w = reference.image.width, h = reference.image.height;
  double mean = 0, sum = 0;
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x)
      for (std::size_t c = 0; c < 3; ++c) mean += reference.at(x, y, c) / (3.0 * w * h);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x)
      for (std::size_t c = 0; c < 3; ++c) {
        const double r = reference.at(x, y, c), d = picture.at(x, y, c) - r;
        sum += d * d / (r * r + 0.01 * mean * mean) / (3.0 * w * h);
      }
  return sum;
}

// Sum of a block of one colour, and of our variance of it.
struct Block {
  double sum = 0, variance = 0;
};
Block block_of(const Picture& p, int left, int top, int size, std::size_t c) {
  Block block;
  for (int y = top; y < top + size; ++y)
    for (int x = left; x < left + size; ++x) {
      block.sum += p.at(x, y, c);
      if (p.variance[c] >= 0) block.variance += p.image.at(x, y, p.variance[c]);
    }
  return block;
}

// Welch's t of every block and colour; ours is taken as exact in its variance (many replicates), theirs has seeds - 1
// degrees of freedom.
void agree(const Picture& ours, const std::vector<Picture>& theirs) {
  constexpr int size = 8;
  const auto n = static_cast<double>(theirs.size());
  int count = 0, beyond = 0;
  double worst = 0, squares = 0, sum_ours = 0, sum_theirs = 0, noise = 0;
  std::vector<double> relative;
  for (int y = 0; y + size <= ours.image.height; y += size)
    for (int x = 0; x + size <= ours.image.width; x += size)
      for (std::size_t c = 0; c < 3; ++c) {
        const Block mine = block_of(ours, x, y, size, c);
        double mean = 0, spread = 0;
        for (const Picture& p : theirs) mean += block_of(p, x, y, size, c).sum / n;
        for (const Picture& p : theirs) {
          const double d = block_of(p, x, y, size, c).sum - mean;
          spread += d * d / (n - 1);
        }
        const double a = mine.variance, b = spread / n;
        sum_ours += mine.sum, sum_theirs += mean;
        if (!(a + b > 0)) continue;
        const double t = (mine.sum - mean) / std::sqrt(a + b);
        const double degrees = std::max(n - 1, (a + b) * (a + b) / (b * b / (n - 1) + 1e-300));
        const double p = 2 * stats::student_upper(std::abs(t), degrees);
        ++count;
        beyond += p < 0.01;
        worst = std::max(worst, std::abs(t));
        relative.push_back((mine.sum - mean) / std::max(mean, 1e-12));
        squares += relative.back() * relative.back();
        noise += (a + b) / std::max(mean * mean, 1e-24);
      }
  std::sort(relative.begin(), relative.end());
  const double rms = std::sqrt(squares / count), expected = std::sqrt(noise / count);
  std::printf(
      "blocks %d, p < 0.01 in %.2f %%, largest |t| %.1f, total %+.3f %%, median %+.3f %%, rms %.3f %% (noise "
      "alone %.3f %%)\n",
      count, 100.0 * beyond / count, worst, 100 * (sum_ours / sum_theirs - 1), 100 * relative[relative.size() / 2],
      100 * rms, 100 * expected);
}

int run(int argc, char** argv) {
  const std::string task = argc > 1 ? argv[1] : "";
  if (task == "scenes" && argc == 5) return scenes(argv[2], argv[3], argv[4]), 0;
  if (task == "grid" && argc == 4) return grid(std::stoul(argv[2]), argv[3]), 0;
  if (task == "timed" && argc > 2) return timed(argv + 2);
  if (task == "error" && argc == 4) {
    std::printf("%.6g\n", relative_error(Picture(argv[2]), Picture(argv[3])));
    return 0;
  }
  if (task == "agree" && argc > 4) {
    std::vector<Picture> theirs;
    for (int i = 3; i < argc; ++i) theirs.emplace_back(argv[i]);
    return agree(Picture(argv[2]), theirs), 0;
  }
  std::cerr << "usage: bench-render scenes|grid|timed|error|agree ...\n";
  return 64;
}

}  // namespace
}  // namespace gonio::bench

int main(int argc, char** argv) {
  try {
    return gonio::bench::run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "bench-render: " << error.what() << "\n";
    return 65;
  }
}
