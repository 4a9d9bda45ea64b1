// See clouds_problem.h: from the manifest to clouds.
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <unordered_map>

#include "base/error.h"
#include "explain/clouds/clouds_problem.h"
#include "io/ply.h"
#include "manifest/document.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/cloud.h"
#include "manifest/sections/image.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/mesh.h"
#include "mechanism/mechanism.h"
#include "scan/cloud_file.h"
#include "scan/stations.h"
#include "stats/intervals.h"

namespace gonio::explain {
namespace {

using manifest::Document;

constexpr std::size_t tiles_a_side = 6, points_a_tile = 16;
constexpr double far_sigmas = 8;  // robust, off the shape: of something else

// Images of one cloud by its first camera.
std::vector<const manifest::ImageEntry*> images_of(const Document& d, const std::string& name,
                                                   const manifest::Cloud& cloud) {
  std::vector<const manifest::ImageEntry*> found;
  for (const manifest::ImageEntry& image : d.images)
    if (image.camera == cloud.cameras[0] && image.projection == cloud.projection &&
        (image.group.empty() ? image.projection : image.group) == name)
      found.push_back(&image);
  return found;
}

std::optional<double> mean_of(const std::vector<const manifest::ImageEntry*>& images,
                              std::optional<double> manifest::ImageEntry::*what) {
  double sum = 0;
  for (const manifest::ImageEntry* image : images) {
    if (!(image->*what)) return std::nullopt;
    sum += *(image->*what);
  }
  return images.empty() ? std::nullopt : std::optional(sum / static_cast<double>(images.size()));
}

// What white adds about a point; the points of a camera beside a projector stand at whole pixels. All zero where a
// neighbour has no point.
class Brightness {
 public:
  explicit Brightness(std::span<const scan::ScanPoint> points) {
    for (const scan::ScanPoint& p : points) found_[key(std::lround(p.pixel.x), std::lround(p.pixel.y))] = p.reflected;
  }
  equation::Neighbours about(Vec2 pixel) const {
    equation::Neighbours all{};
    const long x = std::lround(pixel.x), y = std::lround(pixel.y);
    for (std::size_t k = 0; k < all.size(); ++k) {
      const auto it = found_.find(key(x + static_cast<long>(k % 5) - 2, y + static_cast<long>(k / 5) - 2));
      if (it == found_.end()) return {};
      all[k] = it->second;
    }
    return all;
  }

 private:
  static std::uint64_t key(long x, long y) {
    return static_cast<std::uint64_t>(x) << 32 | (static_cast<std::uint64_t>(y) & 0xffffffffu);
  }
  std::unordered_map<std::uint64_t, float> found_;
};

// As many of each tile of the picture, evenly through its points: a part is enough, and a corner counts like the
// middle.
void choose_points(std::vector<scan::ScanPoint> all, CloudView& view) {
  Vec2 low{1e30, 1e30}, high{-1e30, -1e30};
  for (const scan::ScanPoint& p : all) {
    low = {std::min(low.x, p.pixel.x), std::min(low.y, p.pixel.y)};
    high = {std::max(high.x, p.pixel.x), std::max(high.y, p.pixel.y)};
  }
  std::vector<std::vector<std::size_t>> tiles(tiles_a_side * tiles_a_side);
  const auto place = [](double v, double from, double to) {
    const double share = to > from ? (v - from) / (to - from) : 0;
    return std::min(tiles_a_side - 1, static_cast<std::size_t>(share * static_cast<double>(tiles_a_side)));
  };
  for (std::size_t i = 0; i < all.size(); ++i)
    tiles[place(all[i].pixel.y, low.y, high.y) * tiles_a_side + place(all[i].pixel.x, low.x, high.x)].push_back(i);
  std::uint32_t number = 0;
  for (const std::vector<std::size_t>& tile : tiles) {
    const std::size_t count = std::min(points_a_tile, tile.size());
    // The golden ratio's multiples: no stride that a pattern's period could share.
    for (std::size_t k = 0; k < count; ++k) {
      double whole = 0;
      const double at = count == tile.size() ? static_cast<double>(k) / static_cast<double>(count)
                                             : std::modf((static_cast<double>(k) + 0.5) * 0.6180339887498949, &whole);
      view.points.push_back(all[tile[static_cast<std::size_t>(at * static_cast<double>(tile.size()))]]);
      view.tile.push_back(number);
    }
    number += count > 0;
  }
}

bool has_cosines(const scan::Sequence& sequence) {
  return std::ranges::any_of(sequence.frames, [](const scan::Shown& s) { return s.what == scan::Shown::What::cosine; });
}

class CloudReader {
 public:
  CloudReader(const Document& document, CloudsInput& input) : d_(document), input_(input) {}

  void read(const std::string& name, const manifest::Cloud& cloud) {
    const std::string at = manifest::place(d_, "/clouds/" + name);
    const std::vector<const manifest::ImageEntry*> images = images_of(d_, name, cloud);
    Rigid<frame::World, frame::Rig> world_from_rig;
    if (!images.empty() && images[0]->world_from_camera) {
      const Rigid<frame::World, frame::Camera>& pose = *images[0]->world_from_camera;
      world_from_rig = pose * inverse(input_.stations[0].rig_from_camera);
    }
    const auto path = manifest::resolve(d_, cloud.file, "/clouds/" + name + "/file");
    std::vector<scan::ScanPoint> all = scan::read_cloud(path, world_from_rig);
    std::vector<Vec3> places;
    for (const scan::ScanPoint& p : all) places.push_back(p.position_m);
    CloudView view{name, shape_of(*cloud.shape, places, inverse(world_from_rig), at), {}, {}, {}};
    const Brightness brightness(all);
    drop_far(view.shape, all, at);
    const bool known = input_.projector && keep_surrounded(brightness, all);
    choose_points(std::move(all), view);
    if (known)
      for (const scan::ScanPoint& p : view.points) view.bright.push_back(brightness.about(p.pixel));
    temperatures_.push_back(mean_of(images, &manifest::ImageEntry::temperature_K));
    times_.push_back(mean_of(images, &manifest::ImageEntry::time_s));
    input_.views.push_back(std::move(view));
  }

  // Temperature where every cloud states it; else time.
  void finish() {
    const bool warm = differences(temperatures_, &CloudView::warmer_K);
    if (!warm) differences(times_, &CloudView::later_s);
  }

 private:
  bool differences(const std::vector<std::optional<double>>& values, double CloudView::*difference) {
    double sum = 0;
    for (const std::optional<double>& v : values) {
      if (!v) return false;
      sum += *v;
    }
    for (std::size_t i = 0; i < values.size(); ++i)
      input_.views[i].*difference = *values[i] - sum / static_cast<double>(values.size());
    return true;
  }

  CloudShape shape_of(const manifest::KnownShape& shape, std::span<const Vec3> points,
                      const Rigid<frame::Rig, frame::World>& rig_from_world, const std::string& at) {
    if (shape.model == "plane") return CloudShape::plane(points, at);
    if (shape.model == "sphere") {
      if (!shape.radius_m)
        throw Error(Exit::data, at + "/shape", "is a sphere without a radius", "give radius_m, calibrated");
      return CloudShape::ball(points, *shape.radius_m, at);
    }
    if (shape.mesh.empty()) throw Error(Exit::data, at + "/shape", "names no mesh", "\"mesh\": its name in meshes");
    std::shared_ptr<const ShapeMesh>& mesh = meshes_[shape.mesh];
    if (!mesh) {
      const manifest::Mesh& entry = d_.meshes.at(shape.mesh);
      if (entry.file.empty())
        throw Error(Exit::data, at + "/shape/mesh", "is a mesh without a file",
                    "give a mesh of triangles, or the model plane or sphere");
      io::TriangleMesh raw = io::read_ply(manifest::resolve(d_, entry.file, "/meshes/" + shape.mesh + "/file"));
      mesh = std::make_shared<const ShapeMesh>(std::move(raw.positions_m), std::move(raw.triangles));
    }
    Rigid<frame::World, frame::Object> pose;
    if (shape.world_from_object) pose = *shape.world_from_object;
    return CloudShape::of_mesh(mesh, rig_from_world * pose);
  }

  // Where most points have all their neighbours, those that have: what is seen beside a hole is a mixture. Else false.
  static bool keep_surrounded(const Brightness& brightness, std::vector<scan::ScanPoint>& all) {
    std::vector<scan::ScanPoint> surrounded;
    for (const scan::ScanPoint& p : all)
      if (brightness.about(p.pixel)[12] > 0) surrounded.push_back(p);
    if (2 * surrounded.size() < all.size()) return false;
    all = std::move(surrounded);
    return true;
  }

  static void drop_far(const CloudShape& shape, std::vector<scan::ScanPoint>& all, const std::string& at) {
    std::vector<double> off;
    for (const scan::ScanPoint& p : all) off.push_back(shape.off(p.position_m));
    const double middle = stats::median(off);
    std::vector<double> sizes;
    for (const double v : off) sizes.push_back(std::abs(v - middle));
    const double reach = far_sigmas * 1.4826 * stats::median(sizes);
    std::vector<scan::ScanPoint> near;
    for (std::size_t i = 0; i < all.size(); ++i)
      if (sizes[i] <= reach) near.push_back(all[i]);
    if (near.size() < tiles_a_side * tiles_a_side)
      throw Error(Exit::data, at, "has " + std::to_string(near.size()) + " points on its shape", "measure it again");
    all = std::move(near);
  }

  const Document& d_;
  CloudsInput& input_;
  std::map<std::string, std::shared_ptr<const ShapeMesh>> meshes_;
  std::vector<std::optional<double>> temperatures_, times_;
};

// A projector has recorded nothing.
bool is_projector(const Document& d, const std::string& camera, const std::string& projection) {
  return std::ranges::none_of(d.images, [&](const manifest::ImageEntry& image) {
    return image.camera == camera && image.projection == projection && image.shows;
  });
}

void take_given(const Document& d, CloudsInput& input) {
  for (const auto& [id, use] : d.mechanisms) {
    const mechanism::Mechanism* m = mechanism::find_mechanism(id);
    if (m == nullptr || std::ranges::find(m->domains, "clouds") == m->domains.end()) continue;
    input.given.push_back(id);
    for (const auto& [name, parameter] : use.parameters)
      for (std::size_t k = 0; k < parameter.value.size(); ++k) {
        const std::string on = k < use.on.size() ? use.on[k] : "";
        input.given_values.emplace_back(id + "." + name, parameter.value[k]);
        input.given_values.emplace_back(on + "/" + name, parameter.value[k]);
        input.given_values.emplace_back("cameras/" + on + "/" + name, parameter.value[k]);
      }
  }
}

}  // namespace

bool has_known_shapes(const Document& document) {
  return std::ranges::any_of(document.clouds, [](const auto& c) { return c.second.shape.has_value(); });
}

std::vector<CloudsInput> clouds_inputs(const Document& document) {
  std::map<std::vector<std::string>, std::vector<std::string>> sets;  // of clouds, by devices and projection
  for (const auto& [name, cloud] : document.clouds) {
    if (!cloud.shape) continue;
    const std::string at = manifest::place(document, "/clouds/" + name);
    if (cloud.cameras.size() != 2 || cloud.projection.empty())
      throw Error(Exit::data, at, "does not say which two devices measured it, and by which projection",
                  "give a cloud that structured-light wrote");
    sets[{cloud.cameras[0], cloud.cameras[1], cloud.projection}].push_back(name);
  }
  std::vector<CloudsInput> inputs;
  for (const auto& [key, names] : sets) {
    if (names.size() < fewest_clouds)
      throw Error(
          Exit::data, manifest::place(document, "/clouds"),
          "has " + std::to_string(names.size()) + " of known shape by " + key[0] + " and " + key[1] + " (at least " +
              std::to_string(fewest_clouds) + ")",
          "measure the shape at other places, too: what was left out is judged on clouds that the fit never saw");
    CloudsInput input;
    input.first = key[0], input.second = key[1];
    input.projector = is_projector(document, key[1], key[2]);
    input.sequence = scan::sequence_of(document, key[2]);
    if (input.projector && !has_cosines(input.sequence))
      throw Error(Exit::data, manifest::place(document, "/projections/" + key[2]),
                  "shows bits alone, whose stripes make steps that are no noise",
                  "show cosines, too, or let a second camera look on: what is asked is smaller than a stripe");
    input.stations = scan::stations_of(document, {key[0], key[1]});
    CloudReader reader(document, input);
    for (const std::string& name : names) reader.read(name, document.clouds.at(name));
    reader.finish();
    take_given(document, input);
    inputs.push_back(std::move(input));
  }
  return inputs;
}

}  // namespace gonio::explain
