#include "glass/refine_world.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "base/atomic_file.h"
#include "base/error.h"
#include "glass/glasses.h"
#include "glass/make_cell.h"
#include "glass/refine/answer.h"
#include "glass/tensors.h"
#include "manifest/sections/image.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"

namespace gonio::glass {
namespace {

// A field of numbers that hang together over `reach` pixels, of standard deviation 1: white noise, blurred.
std::vector<double> smooth_noise(int width, int height, double reach, Random& random) {
  std::vector<double> field(static_cast<std::size_t>(width) * height);
  for (double& v : field) v = random.normal();
  const int r = static_cast<int>(std::ceil(2 * reach));
  for (const bool rows : {true, false}) {
    const std::vector<double> from = field;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        double sum = 0, squares = 0;
        for (int k = -r; k <= r; ++k) {
          const double w = std::exp(-2.0 * k * k / (reach * reach));
          const int i = rows ? std::clamp(x + k, 0, width - 1) : x, j = rows ? y : std::clamp(y + k, 0, height - 1);
          sum += w * from[static_cast<std::size_t>(j) * width + i], squares += w * w;
        }
        field[static_cast<std::size_t>(y) * width + x] = sum / std::sqrt(squares);
      }
  }
  return field;
}

double degrees_between(Vec3 a, Vec3 b) {
  return norm(a) < 0.5 ? 90 : std::acos(std::clamp(dot(a, b), -1.0, 1.0)) * 180 / pi;
}

// Only what the screen lights, and clear glass where that is wished.
Cell simplified(Cell cell, bool clear) {
  std::erase_if(cell.scene.images, [](const manifest::ImageEntry& i) { return i.id != "bare"; });
  if (!clear) return cell;
  std::erase_if(cell.scene.objects, [](const manifest::Object& o) { return o.id != "object" && o.id != "table"; });
  cell.scene.surfaces.at("glass").parameters.erase("alpha");
  return cell;
}

}  // namespace

World make_world(const WorldWish& wish, const std::filesystem::path& folder) {
  SetWish set_wish;
  set_wish.seed = wish.seed, set_wish.objects = wish.object + 1, set_wish.views = wish.views;
  set_wish.forms = {wish.form}, set_wish.width_px = set_wish.height_px = wish.size_px;
  set_wish.most_spp = wish.spp, set_wish.relative_error = wish.relative_error;
  const GlassSet set(set_wish, folder);
  World world;
  world.form = wish.form;
  for (std::size_t v = 0; v < wish.views; ++v) {
    const Cell cell = simplified(set.cell(wish.object * wish.views + v), wish.clear);
    make_cell(set, cell);
    const auto tensors = tensors_of(set, cell);
    world.glass = cell.facts.at("glass");
    const std::size_t n = static_cast<std::size_t>(wish.size_px) * wish.size_px;
    for (const bool front : {true, false}) {
      const std::vector<float>& t = tensors.at(front ? "front" : "back");
      std::vector<Vec3> normals(n);
      for (std::size_t i = 0; i < n; ++i) normals[i] = {t[i], t[n + i], t[2 * n + i]};
      (front ? world.front : world.back).push_back(std::move(normals));
    }
  }
  world.index = find_glass(world.glass)->index(0.55);
  world.document = turned_views(set, wish.object);
  world.views = views_in(world.document, {});
  return world;
}

void add_stand_in(World& world, double front_deg, double back_deg, double reach_px, std::uint64_t seed) {
  for (std::size_t v = 0; v < world.views.size(); ++v) {
    View& view = world.views[v];
    Random random(seed, v);
    NetworkAnswer answer;
    for (const bool front : {true, false}) {
      const double sigma = (front ? front_deg : back_deg) * pi / 180;
      std::array<std::vector<double>, 3> turn;
      for (auto& part : turn) part = smooth_noise(view.width, view.height, reach_px, random);
      std::vector<Vec3> normals = (front ? world.front : world.back)[v];
      for (std::size_t i = 0; i < normals.size(); ++i) {
        // Two of three components turn the normal.
        const Vec3 by = Vec3{turn[0][i], turn[1][i], turn[2][i]} * (sigma / std::sqrt(2.0));
        if (norm(normals[i]) > 0.5)
          normals[i] = view.world_from_camera_axes * (matrix_of(quaternion_of_rotation_vector(by)) * normals[i]);
      }
      (front ? answer.front : answer.back) = std::move(normals);
      (front ? answer.front_sigma_rad : answer.back_sigma_rad)
          .assign(view.outline_px.size(), static_cast<float>(1.072 * sigma));  // 68.3 % of such angles
    }
    view.network = std::move(answer);
  }
}

void ask_network(World& world, const std::filesystem::path& weights, bool masks, const std::filesystem::path& folder) {
  const std::filesystem::path asked = folder / "asked.json", answers = folder / "network";
  write_file(asked, manifest::print_document(world.document, folder));
  const char* program = std::getenv("GLASS_NET");
  const auto quoted = [](const std::filesystem::path& path) { return " '" + path.string() + "'"; };
  const std::string call = std::string(program ? program : "glass-net") + " --log-level error --force --weights" +
                           quoted(weights) + " --out" + quoted(answers) + " -o" + quoted(folder / "answered.json") +
                           quoted(asked);
  if (std::system(call.c_str()) != 0) throw Error(Exit::data, call, "failed");
  manifest::Document document = world.document;
  if (masks)
    for (manifest::ImageEntry& image : document.images) image.mask.clear();
  world.views = views_in(document, {.network = answers});
}

void shake_masks(World& world, double sigma_px, std::uint64_t seed) {
  for (std::size_t v = 0; v < world.views.size(); ++v) {
    View& view = world.views[v];
    Random random(seed, 1000 + v);
    const std::vector<double> off = smooth_noise(view.width, view.height, 8, random);
    std::vector<float> mask(view.outline_px.size());
    for (std::size_t i = 0; i < mask.size(); ++i)
      mask[i] = static_cast<float>(std::clamp(0.5 + view.outline_px[i] + sigma_px * off[i], 0.0, 1.0));
    view.outline_px = distance_from_edge(mask, view.width, view.height);
  }
}

Angles angles(const World& world, std::size_t held_out,
              const std::function<Vec3(std::size_t, int, int, bool)>& normal) {
  Angles sum;
  double count = 0, held = 0;
  for (std::size_t v = 0; v < world.views.size(); ++v)
    for (int y = 0; y < world.views[v].height; ++y)
      for (int x = 0; x < world.views[v].width; ++x) {
        const std::size_t i = world.views[v].pixel(x, y);
        if (norm(world.front[v][i]) < 0.5 || norm(world.back[v][i]) < 0.5) continue;
        const Mat3& axes = world.views[v].world_from_camera_axes;
        const double front = degrees_between(normal(v, x, y, true), axes * world.front[v][i]);
        const double back = degrees_between(normal(v, x, y, false), axes * world.back[v][i]);
        if (v == held_out) sum.held_front += front, sum.held_back += back, ++held;
        if (v != held_out) sum.front += front, sum.back += back, ++count;
      }
  sum.front /= count, sum.back /= count;
  if (held > 0) sum.held_front /= held, sum.held_back /= held;
  return sum;
}

Angles angles_of(const World& world, const Stage& stage, std::size_t held_out) {
  const Measuring measuring(world.views, {});
  return angles(world, held_out, [&](std::size_t v, int x, int y, bool front) {
    Measuring::Path path;
    if (!measuring.straight(stage.field, measuring.ray(stage.field, v, x, y), path)) return Vec3{};
    return -normalized((front ? path.first : path.second).jet.slope);
  });
}

Angles angles_of_network(const World& world, std::size_t held_out) {
  return angles(world, held_out, [&](std::size_t v, int x, int y, bool front) {
    const View& view = world.views[v];
    return (front ? view.network->front : view.network->back)[view.pixel(x, y)];
  });
}

MapsJudged judge_maps(const World& world, const Refined& refined, std::size_t held_out) {
  const Measuring measuring(world.views, {});
  std::vector<io::Image> maps;
  for (std::size_t v = 0; v < world.views.size(); ++v)
    maps.push_back(v == held_out ? io::Image() : maps_of(refined, measuring, v));
  const auto told = [&](std::size_t v, int x, int y, int c) {
    return Vec3{maps[v].at(x, y, c), maps[v].at(x, y, c + 1), maps[v].at(x, y, c + 2)};
  };
  MapsJudged judged;
  double count = 0;
  const Angles means = angles(world, held_out, [&](std::size_t v, int x, int y, bool front) {
    if (v == held_out || maps[v].at(x, y, 0) == 0) return Vec3{};
    const int c = front ? 2 : 6;
    const View& view = world.views[v];
    const Vec3 truth = view.world_from_camera_axes * (front ? world.front : world.back)[v][view.pixel(x, y)];
    const double off = degrees_between(told(v, x, y, c), truth) * pi / 180 / maps[v].at(x, y, c + 3);
    judged.within += off < 1, judged.within_two += off<2, judged.beyond_three += off> 3, ++count;
    return told(v, x, y, c);
  });
  judged.front = means.front, judged.back = means.back;
  judged.within /= count, judged.within_two /= count, judged.beyond_three /= count;
  return judged;
}

}  // namespace gonio::glass
