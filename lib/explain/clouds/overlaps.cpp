// See overlaps.h.
#include "explain/clouds/overlaps.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "explain/clouds/cloud_reading.h"
#include "explain/clouds/local_surface.h"
#include "manifest/document.h"

namespace gonio::explain {
namespace {

constexpr std::size_t most_looked_at = 20000;  // points of one cloud, for another
constexpr std::size_t most_overlaps = 10;
constexpr double same_side = 0.9;  // cosine between the normals
constexpr double near = 0.02;      // of the depth: what another cloud saw farther off is something else

struct Cloud {
  ReadCloud read;
  PointsByPixel by_pixel;
  explicit Cloud(ReadCloud r) : read(std::move(r)), by_pixel(read.points) {}
  Cloud(const Cloud&) = delete;  // by_pixel refers to its points
};

class Overlap {
 public:
  // Of `of` overlaps each looks at points of its own: noise that two of them shared would count twice.
  Overlap(const CloudsInput& input, const Cloud& own, const Cloud& other, std::size_t number, std::size_t of)
      : input_(input),
        own_(own),
        other_(other),
        number_(number),
        of_(of),
        other_from_own_(inverse(other.read.world_from_rig) * own.read.world_from_rig) {}

  bool find(CloudView& view, CloudView& against) const {
    const std::vector<std::size_t> seen = seen_by_both();
    if (seen.size() < fewest) return false;
    std::vector<Vec2> pixels;
    for (const std::size_t p : seen) pixels.push_back(own_.read.points[p].pixel);
    std::vector<Met> all;
    std::vector<double> distances;
    for (const Chosen& c : chosen(pixels, points_a_tile / 2))
      if (const auto met = meet(seen[c.point], c.tile)) all.push_back(*met), distances.push_back(met->apart_m);
    if (all.size() < fewest) return false;
    std::vector<Met> kept;
    for (const std::size_t k : near_median(distances)) kept.push_back(all[k]);
    return kept.size() >= fewest && (fill(kept, view, against), true);
  }

 private:
  static constexpr std::size_t fewest = tiles_a_side * tiles_a_side;
  struct Met {
    std::size_t point = 0, beside = 0;  // own and the other's that is seen next to it
    std::uint32_t tile = 0;
    Vec3 surface_m, normal, beside_m;  // below either point, and of the surface; rig of the other
    double apart_m = 0;
  };

  std::optional<Vec2> pixel_in_other(Vec3 at) const {
    const scan::Station& first = input_.stations[0];
    return first.lens.project(inverse(first.rig_from_camera) * at);
  }

  std::vector<std::size_t> seen_by_both() const {
    std::vector<std::size_t> seen;
    const std::size_t stride = std::max(of_, 1 + own_.read.points.size() / most_looked_at);
    for (std::size_t p = number_; p < own_.read.points.size(); p += stride) {
      const Vec3 at = other_from_own_ * own_.read.points[p].position_m;
      const auto pixel = pixel_in_other(at);
      const auto there = pixel ? other_.by_pixel.at(std::lround(pixel->x), std::lround(pixel->y)) : std::nullopt;
      if (there && norm(other_.read.points[*there].position_m - at) < near * norm(at)) seen.push_back(p);
    }
    return seen;
  }

  // Where a point would lie without what it is off by: nothing but its values may know of its noise.
  Vec3 on_surface(const LocalSurface& surface, const scan::ScanPoint& point, Vec3 at,
                  const Rigid<frame::Rig, frame::Rig>& other_from_its) const {
    const scan::Station& first = input_.stations[0];
    const Vec3 direction = other_from_its.rotate(first.rig_from_camera.rotate(first.lens.ray(point.pixel).direction));
    return surface.along(at, direction);
  }

  std::optional<Met> meet(std::size_t point, std::uint32_t tile) const {
    const scan::ScanPoint& p = own_.read.points[point];
    const Vec3 at = other_from_own_ * p.position_m;
    const auto own = LocalSurface::about(own_.read.points, own_.by_pixel, p.pixel);
    const auto about = [this](Vec3 place) {
      return LocalSurface::about(other_.read.points, other_.by_pixel, *pixel_in_other(place));
    };
    const auto nearly = about(at);
    if (!own || !nearly) return std::nullopt;
    const Vec3 place = on_surface(*nearly, p, at, other_from_own_);
    const auto pixel = pixel_in_other(place);
    const auto beside = pixel ? other_.by_pixel.at(std::lround(pixel->x), std::lround(pixel->y)) : std::nullopt;
    const auto surface = pixel ? about(place) : std::nullopt;
    if (!beside || !surface) return std::nullopt;
    const scan::ScanPoint& there = other_.read.points[*beside];
    const Vec3 normal = surface->normal(place);
    if (dot(other_from_own_.rotate(own->normal(p.position_m)), normal) < same_side) return std::nullopt;
    return Met{point,
               *beside,
               tile,
               on_surface(*surface, p, at, other_from_own_),
               normal,
               on_surface(*surface, there, there.position_m, {}),
               surface->off(at) - surface->off(there.position_m)};
  }

  void fill(const std::vector<Met>& kept, CloudView& view, CloudView& against) const {
    Vec3 pivot;
    for (const Met& m : kept) pivot += m.surface_m * (1 / static_cast<double>(kept.size()));
    const Rigid<frame::Rig, frame::Rig> own_from_other = inverse(other_from_own_);
    const Vec3 own_pivot = own_from_other * pivot;
    view.shape = CloudShape::patch(own_pivot, {0, 0, -1}, own_pivot);
    against.shape = CloudShape::patch(pivot, {0, 0, -1}, pivot);
    for (const Met& m : kept) {
      view.points.push_back(own_.read.points[m.point]), against.points.push_back(other_.read.points[m.beside]);
      view.tile.push_back(m.tile), against.tile.push_back(m.tile);
      view.patches.push_back(
          CloudShape::patch(own_from_other * m.surface_m, own_from_other.rotate(m.normal), own_pivot));
      against.patches.push_back(CloudShape::patch(m.beside_m, m.normal, pivot));
      if (!input_.projector) continue;
      view.bright.push_back(own_.by_pixel.brightness(view.points.back().pixel));
      against.bright.push_back(other_.by_pixel.brightness(against.points.back().pixel));
    }
  }

  const CloudsInput& input_;
  const Cloud &own_, &other_;
  std::size_t number_, of_;
  Rigid<frame::Rig, frame::Rig> other_from_own_;
};

}  // namespace

void add_overlaps(const manifest::Document& document, const std::vector<std::string>& names, CloudsInput& input) {
  std::vector<std::unique_ptr<Cloud>> clouds;
  std::vector<ReadCloud> states;
  for (const std::string& name : names) {
    ReadCloud read = read_one(document, name, document.clouds.at(name), input.stations[0]);
    ReadCloud state;
    state.temperature_K = read.temperature_K, state.time_s = read.time_s;
    states.push_back(std::move(state));
    clouds.push_back(std::make_unique<Cloud>(std::move(read)));
  }
  input.clouds = names;
  const std::size_t pairs = clouds.size() * (clouds.size() - 1) / 2;
  std::size_t pair = 0;
  // Neighbours in their order first: these overlap most often, and every cloud has some.
  for (std::size_t apart = 1; apart < clouds.size(); ++apart)
    for (std::size_t a = 0; a + apart < clouds.size() && input.views.size() < most_overlaps; ++a) {
      const std::size_t b = a + apart;
      CloudView view{names[a] + " and " + names[b], a, {}}, against{names[b], b, {}};
      if (!Overlap(input, *clouds[a], *clouds[b], pair++, pairs).find(view, against)) continue;
      input.views.push_back(std::move(view)), input.against.push_back(std::move(against));
    }
  if (input.views.size() < fewest_clouds)
    throw Error(
        Exit::data, manifest::place(document, "/clouds"),
        "overlap in " + std::to_string(input.views.size()) + " pairs (at least " + std::to_string(fewest_clouds) + ")",
        "measure more of it from more sides, or say with --shape what points lie on");
  state_changes(states, input.views), state_changes(states, input.against);
}

}  // namespace gonio::explain
