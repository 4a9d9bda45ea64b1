// See clouds_problem.h: from the manifest to clouds.
#include <algorithm>
#include <map>

#include "base/error.h"
#include "explain/clouds/cloud_reading.h"
#include "explain/clouds/clouds_problem.h"
#include "explain/clouds/overlaps.h"
#include "io/ply.h"
#include "manifest/document.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/cloud.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/mesh.h"
#include "mechanism/mechanism.h"
#include "scan/stations.h"

namespace gonio::explain {
namespace {

using manifest::Document;

bool has_cosines(const scan::Sequence& sequence) {
  return std::ranges::any_of(sequence.frames, [](const scan::Shown& s) { return s.what == scan::Shown::What::cosine; });
}

class CloudReader {
 public:
  CloudReader(const Document& document, CloudsInput& input) : d_(document), input_(input) {}

  void read(const std::string& name, const manifest::Cloud& cloud) {
    const std::string at = manifest::place(d_, "/clouds/" + name);
    ReadCloud read = read_one(d_, name, cloud, input_.stations[0]);
    std::vector<Vec3> places;
    for (const scan::ScanPoint& p : read.points) places.push_back(p.position_m);
    input_.clouds.push_back(name);
    CloudView view{name, reads_.size(), shape_of(*cloud.shape, places, inverse(read.world_from_rig), at)};
    const PointsByPixel by_pixel(read.points);
    std::vector<scan::ScanPoint> asked = on_shape(view.shape, read.points, at);
    const bool known = input_.projector && keep_surrounded(by_pixel, asked);
    std::vector<Vec2> pixels;
    for (const scan::ScanPoint& p : asked) pixels.push_back(p.pixel);
    for (const Chosen& c : chosen(pixels)) {
      view.points.push_back(asked[c.point]), view.tile.push_back(c.tile);
      if (known) view.bright.push_back(by_pixel.brightness(asked[c.point].pixel));
    }
    read.points.clear();
    reads_.push_back(std::move(read));
    input_.views.push_back(std::move(view));
  }
  void finish() { state_changes(reads_, input_.views); }

 private:
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
  static bool keep_surrounded(const PointsByPixel& by_pixel, std::vector<scan::ScanPoint>& all) {
    std::vector<scan::ScanPoint> surrounded;
    for (const scan::ScanPoint& p : all)
      if (by_pixel.brightness(p.pixel)[12] > 0) surrounded.push_back(p);
    if (2 * surrounded.size() < all.size()) return false;
    all = std::move(surrounded);
    return true;
  }

  static std::vector<scan::ScanPoint> on_shape(const CloudShape& shape, std::span<const scan::ScanPoint> all,
                                               const std::string& at) {
    std::vector<double> off;
    for (const scan::ScanPoint& p : all) off.push_back(shape.off(p.position_m));
    std::vector<scan::ScanPoint> near;
    for (const std::size_t i : near_median(off)) near.push_back(all[i]);
    if (near.size() < tiles_a_side * tiles_a_side)
      throw Error(Exit::data, at, "has " + std::to_string(near.size()) + " points on its shape", "measure it again");
    return near;
  }

  const Document& d_;
  CloudsInput& input_;
  std::map<std::string, std::shared_ptr<const ShapeMesh>> meshes_;
  std::vector<ReadCloud> reads_;  // without their points
};

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

using Sets = std::map<std::vector<std::string>, std::vector<std::string>>;  // of clouds, by devices and projection

Sets sets_of(const Document& document, bool shaped) {
  Sets sets;
  for (const auto& [name, cloud] : document.clouds) {
    if (cloud.shape.has_value() != shaped) continue;
    const bool whole = cloud.cameras.size() == 2 && !cloud.projection.empty();
    if (shaped && !whole)
      throw Error(Exit::data, manifest::place(document, "/clouds/" + name),
                  "does not say which two devices measured it, and by which projection",
                  "give a cloud that structured-light wrote");
    if (whole && (shaped || is_placed(document, name, cloud)))
      sets[{cloud.cameras[0], cloud.cameras[1], cloud.projection}].push_back(name);
  }
  if (!shaped)
    std::erase_if(sets, [&](const auto& set) {
      return set.second.size() < fewest_clouds || (is_projector(document, set.first[1], set.first[2]) &&
                                                   !has_cosines(scan::sequence_of(document, set.first[2])));
    });
  return sets;
}

CloudsInput input_of(const Document& document, const std::vector<std::string>& key) {
  CloudsInput input;
  input.first = key[0], input.second = key[1];
  input.projector = is_projector(document, key[1], key[2]);
  input.sequence = scan::sequence_of(document, key[2]);
  if (input.projector && !has_cosines(input.sequence))
    throw Error(Exit::data, manifest::place(document, "/projections/" + key[2]),
                "shows bits alone, whose stripes make steps that are no noise",
                "show cosines, too, or let a second camera look on: what is asked is smaller than a stripe");
  input.stations = scan::stations_of(document, {key[0], key[1]});
  take_given(document, input);
  return input;
}

}  // namespace

bool has_clouds_to_ask(const Document& document) {
  return std::ranges::any_of(document.clouds, [](const auto& c) { return c.second.shape.has_value(); }) ||
         !sets_of(document, false).empty();
}

std::vector<CloudsInput> clouds_inputs(const Document& document) {
  std::vector<CloudsInput> inputs;
  for (const auto& [key, names] : sets_of(document, true)) {
    if (names.size() < fewest_clouds)
      throw Error(
          Exit::data, manifest::place(document, "/clouds"),
          "has " + std::to_string(names.size()) + " of known shape by " + key[0] + " and " + key[1] + " (at least " +
              std::to_string(fewest_clouds) + ")",
          "measure the shape at other places, too: what was left out is judged on clouds that the fit never saw");
    CloudsInput input = input_of(document, key);
    CloudReader reader(document, input);
    for (const std::string& name : names) reader.read(name, document.clouds.at(name));
    reader.finish();
    inputs.push_back(std::move(input));
  }
  for (const auto& [key, names] : sets_of(document, false)) {
    inputs.push_back(input_of(document, key));
    add_overlaps(document, names, inputs.back());
  }
  return inputs;
}

}  // namespace gonio::explain
