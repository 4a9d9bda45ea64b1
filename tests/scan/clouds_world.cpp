// See clouds_world.h.
#include "scan/clouds_world.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "base/atomic_file.h"
#include "base/parallel.h"
#include "base/text.h"
#include "io/ply.h"
#include "scan/cloud_file.h"
#include "scan/decode.h"
#include "scan/rendered_world.h"

namespace gonio::tests {
namespace {

using Point = std::array<double, 3>;
constexpr double index_of_refraction = 1.5;
constexpr int most_across = 6;  // places of a camera's pixel along its row: a pixel covers some of the projector's
constexpr int depths = 6;

double dot_of(const Point& a, const Point& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Point unit(Point a) {
  const double length = std::sqrt(dot_of(a, a));
  return {a[0] / length, a[1] / length, a[2] / length};
}

// Snell's law for a ray that travels along d into a body with the outward normal n.
Point refracted(const Point& d, const Point& n) {
  const double c = -dot_of(d, n), r = 1 / index_of_refraction, k = std::sqrt(1 - r * r * (1 - c * c));
  Point out;
  for (std::size_t i = 0; i < 3; ++i) out[i] = r * d[i] + (r * c - k) * n[i];
  return out;
}

constexpr int rings = 8, spokes = 6;
constexpr double fading_per_m = 200;

class World {
 public:
  World(const CloudsWorld& w, std::size_t cloud) : w_(w), cloud_(cloud), radii_(radii()) {
    view_.shape = w.shape == CloudsWorld::Shape::planes ? ScanWorld::Shape::plane : ScanWorld::Shape::ball;
    view_.left = {240, 180, 450, {-0.08, 0, 0}, 0.1};
    // A pixel of the camera covers nearly two of the projector's.
    view_.projector = {480, 360, 800, {0.08, -0.01, 0}, -0.08};
    const double k = static_cast<double>(cloud);
    view_.tilt = 0.5 * std::sin(1.3 + 2.1 * k), view_.distance = 0.7 + 0.12 * std::cos(1.7 * k);
    view_.ball_x = 0.06 * std::sin(2.9 * k), view_.radius = 0.1;
    calibrated_ = view_.projector;
    view_.projector.toe_rad += w.turned_rad + w.turns_rad_per_s * time();
    const double toe = calibrated_.toe_rad;
    view_.projector.at[0] += w.nudged_m * std::cos(toe), view_.projector.at[2] -= w.nudged_m * std::sin(toe);
  }
  // Of the first camera, in the frame of the thing.
  Rigid<frame::World, frame::Camera> world_from_camera() const {
    Rigid<frame::World, frame::Rig> w;
    if (view_.shape == ScanWorld::Shape::plane) {
      const double angle = std::atan(view_.tilt);
      w.rotation = quaternion_of_rotation_vector({0, angle, 0});
      w.translation_m = -w.rotate(Vec3{0, 0, view_.distance});
    } else {
      w.translation_m = {-view_.ball_x, 0, -view_.distance};
    }
    w.translation_m.x += w_.apart_m * static_cast<double>(cloud_);
    return w * station_of(view_.left).rig_from_camera;
  }
  double time() const { return 3600 * (static_cast<double>(cloud_) - 0.5 * static_cast<double>(w_.clouds - 1)); }
  const ScanWorld& view() const { return view_; }
  const Pinhole& calibrated() const { return calibrated_; }

  scan::Codes codes(const scan::Sequence& sequence) const {
    scan::DecodeRequest request;
    request.sequence = sequence, request.width = view_.left.width, request.height = view_.left.height;
    request.noise = manifest::Noise{w_.gain, w_.read};
    std::optional<RenderedFrames> frames;
    if (w_.rendered > 0) frames.emplace(rendered_world(), view_.left, sequence);
    request.read = [&](std::size_t frame) { return frames ? (*frames)(frame) : seen(sequence, frame); };
    return scan::decode(request);
  }

  RenderedWorld grooves() const {
    RenderedWorld r = groove(opening(), groove_turn(), vertex());
    r.projector = view_.projector, r.distance_m = view_.distance;
    return r;
  }

 private:
  double opening() const { return (cloud_ % 2 == 0 ? 80 : 100) * pi / 180; }
  double groove_turn() const { return 0.2 * std::sin(2.1 * static_cast<double>(cloud_)); }
  Vec3 vertex() const { return {0.02 * std::sin(2.9 * static_cast<double>(cloud_)), 0, view_.distance}; }

  RenderedWorld rendered_world() const {
    RenderedWorld r = w_.shape == CloudsWorld::Shape::grooves ? grooves() : tests::rendered(view_);
    r.albedo = w_.albedo, r.gamma = w_.gamma, r.gain = w_.gain, r.read = w_.read, r.seed = w_.seed * 131 + cloud_;
    r.spp = static_cast<int>(w_.rendered), r.scattering_per_m = w_.scattering_per_m;
    return r;
  }

  Point normal(const Point& at) const {
    if (view_.shape == ScanWorld::Shape::plane) return unit({view_.tilt, 0, -1});
    return unit({at[0] - view_.ball_x, at[1], at[2] - view_.distance});
  }

  // The projector's pixel that lights `at`; its lens bends what it shows.
  std::array<double, 2> lit_from(const Point& at) const {
    const Pinhole& p = view_.projector;
    const std::array<double, 2> straight = p.pixel(at);
    const double x = (straight[0] - 0.5 * (p.width - 1)) / p.f, y = (straight[1] - 0.5 * (p.height - 1)) / p.f,
                 bend = 1 + w_.k1 * (x * x + y * y);
    return {p.f * x * bend + 0.5 * (p.width - 1), p.f * y * bend + 0.5 * (p.height - 1)};
  }

  // Where light enters that a ray into the body scatters at a depth.
  Point entry(const Point& exit, const Point& direction, double depth) const {
    const Point n = normal(exit), inside = refracted(direction, n);
    const Point travel =
        unit({exit[0] - view_.projector.at[0], exit[1] - view_.projector.at[1], exit[2] - view_.projector.at[2]});
    const Point lit = refracted(travel, n);
    Point at = exit;
    for (std::size_t i = 0; i < 3; ++i) at[i] += depth * (inside[i] / -dot_of(inside, n) - lit[i] / -dot_of(lit, n));
    return at;
  }

  // Of light that a source m below a surface sends back, fading over its way rho, rho^2 = r^2 + m^2, the share
  // exp(-fading (rho - m)) m / rho leaves beyond r: rings of equal shares.
  std::vector<double> radii() const {
    std::vector<double> all;
    const double m = w_.scatter_m;
    for (int ring = 0; m > 0 && ring < rings; ++ring) {
      double rho = m;
      for (int step = 0; step < 30; ++step)  // Newton
        rho -=
            (std::log((ring + 0.5) / rings) + fading_per_m * (rho - m) + std::log(rho / m)) / (fading_per_m + 1 / rho);
      all.push_back(std::sqrt(std::max(0.0, rho * rho - m * m)));
    }
    return all;
  }

  // Where light enters that leaves at `exit`, and its weight, by what the projector lights it with.
  struct Entry {
    Point at;
    double weight = 1;
  };
  std::vector<Entry> entries(const Point& exit) const {
    if (radii_.empty()) return {{exit}};
    const Point n = normal(exit), x = unit({n[2], 0, -n[0]}),
                y = {n[1] * x[2] - n[2] * x[1], n[2] * x[0] - n[0] * x[2], n[0] * x[1] - n[1] * x[0]};
    std::vector<Entry> all;
    for (int ring = 0; ring < rings; ++ring)
      for (int k = 0; k < spokes; ++k) {
        const double r = radii_[static_cast<std::size_t>(ring)], angle = 2 * pi * (k + 0.5 * (ring % 2)) / spokes;
        Entry e;
        for (std::size_t i = 0; i < 3; ++i) e.at[i] = exit[i] + r * (std::cos(angle) * x[i] + std::sin(angle) * y[i]);
        if (view_.shape == ScanWorld::Shape::ball) {
          const Point out = normal(e.at), middle = {view_.ball_x, 0, view_.distance};
          for (std::size_t i = 0; i < 3; ++i) e.at[i] = middle[i] + view_.radius * out[i];
        }
        Point to;
        for (std::size_t i = 0; i < 3; ++i) to[i] = view_.projector.at[i] - e.at[i];
        e.weight = std::max(0.0, dot_of(unit(to), normal(e.at))) * (view_.distance * view_.distance / dot_of(to, to)) /
                   (rings * spokes);
        all.push_back(e);
      }
    return all;
  }

  double printed(const Point& at) const {
    if (w_.print_m == 0) return 1;
    const double slope = std::sqrt(1 + view_.tilt * view_.tilt);
    return (std::lround(at[0] * slope / w_.print_m) + std::lround(at[1] / w_.print_m)) % 2 == 0 ? 1 : 0.2;
  }

  void spots(std::vector<double>& shown) const {
    if (w_.spot_px == 0) return;
    const std::vector<double> from = shown;
    const int reach = static_cast<int>(5 * w_.spot_px) + 1, size = static_cast<int>(from.size());
    for (int u = 0; u < size; ++u) {
      double sum = 0, weights = 0;
      for (int k = -reach; k <= reach; ++k) {
        const double weight = std::exp(-0.5 * k * k / (w_.spot_px * w_.spot_px));
        sum += weight * from[static_cast<std::size_t>(std::clamp(u + k, 0, size - 1))], weights += weight;
      }
      shown[static_cast<std::size_t>(u)] = sum / weights;
    }
  }

  void blur(std::vector<double>& lights) const {
    if (w_.blur_px == 0) return;
    const int width = view_.left.width, height = view_.left.height, reach = static_cast<int>(5 * w_.blur_px) + 1;
    for (const bool upwards : {false, true}) {
      const std::vector<double> from = lights;
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
          double sum = 0, weights = 0;
          for (int k = -reach; k <= reach; ++k) {
            const int i = upwards ? x : x + k, j = upwards ? y + k : y;
            if (i < 0 || j < 0 || i >= width || j >= height) continue;
            const double weight = std::exp(-0.5 * k * k / (w_.blur_px * w_.blur_px));
            sum += weight * from[static_cast<std::size_t>(j * width + i)], weights += weight;
          }
          lights[static_cast<std::size_t>(y * width + x)] = sum / weights;
        }
    }
  }

  scan::CameraFrame seen(const scan::Sequence& sequence, std::size_t frame) const {
    ScanWorld now = view_;
    const double sign = cloud_ % 2 == 0 ? 1 : -1.5;
    now.distance +=
        sign * w_.moves_m * (static_cast<double>(frame) / static_cast<double>(sequence.frames.size() - 1) - 0.5);
    const bool rows = sequence.frames[frame].axis == scan::Axis::row;
    const int size = rows ? sequence.height_px : sequence.width_px;
    std::vector<double> shown;
    for (int u = 0; u < size; ++u)
      shown.push_back(std::pow(scan::light_at(sequence, frame, rows ? 0 : u, rows ? u : 0), w_.gamma));
    spots(shown);
    std::vector<double> lights;
    const int places = w_.depth_m > 0 ? depths : 1, across = w_.scatter_m > 0 ? 2 : most_across;
    for (int i = 0; i < now.left.width * now.left.height; ++i) {
      double light = 0;
      for (int k = 0; k < across; ++k) {
        const double x = i % now.left.width + (k + 0.5) / across - 0.5, y = i / now.left.width;
        const Point exit = met(now, now.left, x, y);
        if (exit[2] == 0) continue;
        const Point direction = unit(now.left.direction(x, y));
        for (int d = 0; d < places; ++d) {
          const double depth = w_.depth_m > 0 ? -w_.depth_m * std::log(1 - (d + 0.5) / places) : 0;
          for (const Entry& e : entries(depth > 0 ? entry(exit, direction, depth) : exit)) {
            const auto pixel = lit_from(e.at);
            const double at = rows ? pixel[1] : pixel[0], other = rows ? pixel[0] : pixel[1];
            if (!(at > 0 && at < size - 1 && other > 0 && other < (rows ? sequence.width_px : sequence.height_px) - 1))
              continue;
            const auto u = static_cast<std::size_t>(at);
            light += e.weight * printed(exit) * (shown[u] * (1 - (at - double(u))) + shown[u + 1] * (at - double(u))) /
                     (across * places);
          }
        }
      }
      lights.push_back(0.03 + 0.7 * light);
    }
    blur(lights);
    std::mt19937_64 random(w_.seed * 7919 + cloud_ * 104729 + frame);
    scan::CameraFrame f;
    for (double v : lights) {
      v = static_cast<double>(std::poisson_distribution<long>(v * w_.gain)(random)) / w_.gain +
          std::normal_distribution<double>(0, w_.read)(random);
      f.light.push_back(static_cast<float>(v));
      f.saturated.push_back(false);
    }
    return f;
  }

  const CloudsWorld& w_;
  std::size_t cloud_;
  ScanWorld view_;
  std::vector<double> radii_;
  Pinhole calibrated_;
};

std::string camera_text(const char* name, const Pinhole& c) {
  return format(
      "\"%s\": {\"model\": \"pinhole\", \"width_px\": %d, \"height_px\": %d, \"fx_px\": %.17g, \"fy_px\": %.17g, "
      "\"cx_px\": %.17g, \"cy_px\": %.17g}",
      name, c.width, c.height, c.f, c.f, 0.5 * (c.width - 1), 0.5 * (c.height - 1));
}
std::string member_text(const char* name, const Pinhole& c) {
  return format(
      "{\"camera\": \"%s\", \"rig_from_camera\": {\"rotation\": [%.17g, 0, %.17g, 0], \"translation_m\": [%.17g, "
      "%.17g, %.17g]}}",
      name, std::cos(c.toe_rad / 2), std::sin(c.toe_rad / 2), c.at[0], c.at[1], c.at[2]);
}

std::string frames_text(const scan::Sequence& sequence) {
  std::string text;
  for (const scan::Shown& s : sequence.frames) {
    const char* axis = s.axis == scan::Axis::row ? "row" : "column";
    if (!text.empty()) text += ", ";
    switch (s.what) {
      case scan::Shown::What::white: text += "{\"show\": \"white\"}"; break;
      case scan::Shown::What::black: text += "{\"show\": \"black\"}"; break;
      case scan::Shown::What::bit:
        text += format("{\"show\": \"bit\", \"axis\": \"%s\", \"bit\": %d, \"inverse\": %s}", axis, s.bit,
                       s.inverse ? "true" : "false");
        break;
      default:
        text += format("{\"show\": \"cosine\", \"axis\": \"%s\", \"periods\": %.17g, \"shift_rad\": %.17g}", axis,
                       s.periods, s.shift_rad);
    }
  }
  return "[" + text + "]";
}

std::string known_text(const CloudsWorld& w) {
  return w.gamma_known
             ? format(", \"mechanisms\": {\"projector.gamma\": {\"on\": [\"projector\"], \"gamma\": %.17g}}", w.gamma)
             : "";
}

void write_mesh(const std::filesystem::path& path, const RenderedWorld& world) {
  io::TriangleMesh mesh;
  for (const Board& b : world.boards) {
    const auto first = static_cast<std::uint32_t>(mesh.positions_m.size());
    const Vec3 x = b.x * b.half_x_m, y = b.y * b.half_y_m;
    for (const Vec3& corner : {x + y, y - x, -x - y, x - y}) mesh.positions_m.push_back(b.middle_m + corner);
    mesh.triangles.push_back({first, first + 1, first + 2}), mesh.triangles.push_back({first, first + 2, first + 3});
  }
  io::write_ply(path, mesh);
}

}  // namespace

manifest::Document measured_clouds(const CloudsWorld& w, const std::filesystem::path& folder) {
  const scan::Axis columns[] = {scan::Axis::column};
  const double periods[] = {1, 8, 40};
  const scan::Sequence sequence =
      w.gray ? scan::gray_sequence(480, 360, columns) : scan::cosine_sequence(480, 360, columns, periods, 3);
  make_folder(folder);
  std::vector<std::string> clouds(w.clouds), images(w.clouds), files(w.clouds), meshes(w.clouds);
  parallel_for(0, w.clouds, [&](std::size_t c) {
    const World world(w, c);
    const scan::Cloud cloud =
        scan::points_of_projector(world.codes(sequence), station_of(world.view().left), station_of(world.calibrated()));
    const Rigid<frame::World, frame::Camera> pose = world.world_from_camera();
    const Rigid<frame::World, frame::Rig> world_from_rig =
        w.overlaps ? pose * inverse(station_of(world.view().left).rig_from_camera) : Rigid<frame::World, frame::Rig>{};
    scan::write_cloud(folder / format("c%zu.ply", c), cloud, world_from_rig);
    if (w.shape == CloudsWorld::Shape::grooves) write_mesh(folder / format("m%zu.ply", c), world.grooves());
    files[c] = format("\"f%zu\": {\"path\": \"c%zu.ply\"}", c, c);
    meshes[c] = format("\"m%zu\": {\"file\": \"m%zu\"}", c, c);
    if (w.shape == CloudsWorld::Shape::grooves) files[c] += format(", \"m%zu\": {\"path\": \"m%zu.ply\"}", c, c);
    const std::string groove = format("\"model\": \"mesh\", \"mesh\": \"m%zu\"", c);
    clouds[c] =
        format("\"c%zu\": {\"file\": \"f%zu\", \"cameras\": [\"camera\", \"projector\"], \"projection\": \"p\"%s%s%s}",
               c, c, w.overlaps ? "" : ", \"shape\": {",
               w.overlaps                               ? ""
               : w.shape == CloudsWorld::Shape::planes  ? "\"model\": \"plane\""
               : w.shape == CloudsWorld::Shape::grooves ? groove.c_str()
                                                        : "\"model\": \"sphere\", \"radius_m\": 0.1",
               w.overlaps ? "" : "}");
    const std::string placed = format(
        "\"world_from_camera\": {\"rotation\": [%.17g, %.17g, %.17g, %.17g], \"translation_m\": [%.17g, "
        "%.17g, %.17g]},",
        pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z, pose.translation_m.x, pose.translation_m.y,
        pose.translation_m.z);
    images[c] = format(
        "{\"id\": \"i%zu\", %s \"camera\": \"camera\", \"projection\": \"p\", \"shows\": 0, \"group\": "
        "\"c%zu\", \"time_s\": %.17g}",
        c, w.overlaps ? placed.c_str() : "", c, world.time());
  });
  const auto joined = [](const std::vector<std::string>& parts) {
    std::string text;
    for (const std::string& part : parts) text += (text.empty() ? "" : ", ") + part;
    return text;
  };
  const World first(w, 0);
  const std::string text =
      "{\"gonio\": 1, \"files\": {" + joined(files) + "}, \"cameras\": {" + camera_text("camera", first.view().left) +
      ", " + camera_text("projector", first.calibrated()) + "}, \"rigs\": {\"rig\": {\"cameras\": [" +
      member_text("camera", first.view().left) + ", " + member_text("projector", first.calibrated()) +
      "]}}, \"projections\": {\"p\": {" +
      format("\"width_px\": %d, \"height_px\": %d, \"frames\": ", sequence.width_px, sequence.height_px) +
      frames_text(sequence) + "}}, " +
      (w.shape == CloudsWorld::Shape::grooves ? "\"meshes\": {" + joined(meshes) + "}, " : "") + "\"clouds\": {" +
      joined(clouds) + "}, \"images\": [" + joined(images) + "]" + known_text(w) + "}";
  write_file(folder / "clouds.json", text);
  return manifest::read_document(folder / "clouds.json");
}

}  // namespace gonio::tests
