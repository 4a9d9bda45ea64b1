// CT volumes of hollow pieces of glass and aluminium: X-rays through exact ellipsoids, photons, filtered
// back-projection (tests/ct), told against a mesh of the piece. What is believed of the piece is right, but for where
// it lies.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "base/text.h"
#include "ct/scanner.h"
#include "geom/vector.h"
#include "sealed/camera_chain.h"
#include "sealed/recording.h"
#include "sealed/worlds.h"

namespace gonio::sealed {
namespace {

constexpr std::size_t side = 96;

struct Ellipsoid {
  Vec3 centre, radii;
  Mat3 turn;
  bool hollow = false;
};

struct Marker {
  Vec3 centre_m;
  double radius_m = 0;
};

class Tomograph final : public World {
 public:
  std::vector<EffectKind> effects() const override {
    const std::vector<std::string> stage{"tomograph"};
    std::vector<EffectKind> k;
    const auto add = [&](EffectKind kind) -> EffectKind& { return k.emplace_back(std::move(kind)); };
    add({"threshold", "ct.threshold", stage, {"volume.size", "volume.curvature"}, 0.08, 0.4})
        .of_either_sign()
        .as_drawn()
        .means({"offset_voxels"});
    add({"scale", "ct.scale", stage, {"volume.size"}, 0.0015, 0.008}).of_either_sign().as_drawn().means({"scale"});
    add({"blur", "ct.blur", stage, {"volume.edge-width", "volume.edge-tilt"}, 0.9, 2})
        .as_drawn()
        .nearly("spread_voxels");
    add({"hardening", "ct.beam-hardening", stage, {"volume.path", "volume.depth", "volume.radius"}, 0.25, 1})
        .as_drawn();
    add({"cupping", "ct.cupping", stage, {"volume.radius", "volume.depth"}, 0.04, 0.2}).as_drawn().means({"cupping"});
    add({"rings", "ct.ring", stage, {"volume.ring", "volume.radius"}, 0.004, 0.02}).as_drawn();
    add({"tilt",
         "ct.axis-tilt",
         stage,
         {"volume.azimuth-by-height", "volume.edge-azimuth", "volume.height"},
         0.006,
         0.03})
        .of_either_sign()
        .as_drawn()
        .nearly("tilt_rad");
    add({"scatter", "ct.scatter", stage, {"volume.path", "volume.depth", "volume.radius"}, 0.08, 0.3}).as_drawn();
    add({"streaks", "ct.streak", stage, {"volume.marker-path", "volume.path"}, 0.02, 0.05})
        .as_drawn()
        .only_for("markers");
    add({"offset axis", "", stage, {}, 0.7, 2}).as_drawn();
    add({"drifting source", "", stage, {}, 0.05, 0.3}).as_drawn();
    return k;
  }

  void design(Random& random, const std::string& variant) override {
    voxel_m_ = random.uniform(2e-4, 4e-4);
    const double extent = static_cast<double>(side) * voxel_m_;
    glass_ = random.uniform() < 0.7;
    const auto turned = [&] {
      const Vec3 axis = normalized({random.normal(), random.normal(), random.normal()});
      return ct::rotation_about(axis, random.uniform(0, pi));
    };
    const auto near = [&](double reach) {
      return Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)} * (reach * extent);
    };
    if (variant == "ball") {
      const double r = random.uniform(0.25, 0.36) * extent;
      bodies_ = {{near(0.05), {r, r, r}, {}, false}};
    } else {
      const Vec3 radii{random.uniform(0.3, 0.4) * extent, random.uniform(0.26, 0.36) * extent,
                       random.uniform(0.3, 0.42) * extent};
      const Ellipsoid outer{near(0.03), radii, turned(), false};
      const double wall = (variant == "thin" ? random.uniform(0.032, 0.05) : random.uniform(0.09, 0.13)) * extent;
      if (variant == "thin") {  // a shell of 3.1 to 4.8 voxels
        bodies_ = {outer, {outer.centre, radii - Vec3{1, 1, 1} * wall, outer.turn, true}};
      } else {
        bodies_ = with_hollows(outer, wall, turned, random);
      }
    }
    if (variant == "markers") glue_markers(random);
    photons_ = std::exp(random.uniform(std::log(4e4), std::log(4e5)));
    turn_ =
        ct::rotation_about(normalized({random.normal(), random.normal(), random.normal()}), random.uniform(0, 0.02));
    shift_ = near(1.0 / static_cast<double>(side));
    noise_seed_ = random.next();
    scanner_.seed = random.next();
  }

  Numbers base() const override { return {0}; }
  Numbers base_steps() const override { return {1}; }
  // What moves the piece, and the values of air and glass.
  std::vector<Numbers> base_columns() const override {
    const Numbers v = simulate({}, {});
    std::vector<Numbers> columns(8, Numbers(v.size(), 0.0));
    const double middle = 0.5 * (static_cast<double>(side) - 1);
    for_inner([&](std::size_t n, Vec3 index) {
      const Vec3 g{v[n + 1] - v[n - 1], v[n + side] - v[n - side], v[n + side * side] - v[n - side * side]};
      const Vec3 t = cross(index - Vec3{middle, middle, middle}, g);
      for (std::size_t a = 0; a < 3; ++a) {
        columns[a][n] = g[static_cast<int>(a)];
        columns[a + 3][n] = t[static_cast<int>(a)];
      }
    });
    columns[6] = v;
    columns[7].assign(v.size(), 1.0);
    return columns;
  }

  Numbers simulate(const Numbers&, const Sizes& sizes) const override {
    told_ = sizes;
    Sizes scanned = sizes;  // without what the mesh and the file's head say wrong
    scanned.erase("threshold");
    scanned.erase("scale");
    for (const auto& [known, volume] : scanned_)
      if (known == scanned) return misread(volume, sizes);
    ct::Scanner s = scanner_of(scanned);
    const ct::Phantom phantom = piece();
    const ct::Projections p = ct::projections(phantom, s);
    if (scanned.empty()) paths_ = p;
    const io::VolumeData data = ct::reconstructed(p, s);
    Numbers volume(data.values.begin(), data.values.end());
    scanned_.emplace_back(scanned, volume);
    return misread(volume, sizes);
  }
  // Noise of photons: sd exp(p / 2) / sqrt(N) in every reading, reconstructed.
  Numbers noise(Random& random) const {
    ct::Projections n = paths_;
    for (float& p : n.values)
      p = static_cast<float>(std::exp(0.5 * static_cast<double>(p)) / std::sqrt(photons_) * random.normal());
    const io::VolumeData data = ct::reconstructed(n, scanner_of({}));
    return {data.values.begin(), data.values.end()};
  }
  Numbers sigma(const Numbers& clean) const override {
    if (sigma_ == 0) {
      Random random(noise_seed_, 1);
      double squares = 0;
      for (const double v : noise(random)) squares += v * v;
      sigma_ = std::sqrt(squares / static_cast<double>(clean.size()));
    }
    return Numbers(clean.size(), sigma_);
  }
  Numbers noisy(const Numbers&, Random& random) const override {
    offset_voxels_ = size_of(told_, "threshold"), scale_ = size_of(told_, "scale");
    Numbers v = scanned_.back().second;
    const Numbers n = noise(random);
    for (std::size_t i = 0; i < v.size(); ++i) v[i] += n[i];
    return v;
  }
  // Voxels of the walls alone: a wall's error is not diluted by the air around.
  Numbers norm(const Numbers&) const override {
    const Numbers& v = scanned_.front().second;
    const double material = value_of_material();
    Numbers n(v.size(), 0.0);
    for (std::size_t i = 0; i < v.size(); ++i)
      if (v[i] > 0.15 * material && v[i] < 0.85 * material) n[i] = material * material;
    return n;
  }
  bool relative() const override { return true; }
  bool asks_rivals() const override { return false; }
  bool knows_floor() const override { return false; }  // scored by readings along normals
  void locate(const Numbers&, const Numbers&, Case&) const override {}

  void write(const Numbers& observed, const Numbers&, Case& into) const override {
    std::string file = "NRRD0005\ntype: float\ndimension: 3\nsizes:";
    for (int a = 0; a < 3; ++a) file += format(" %zu", side);
    const double told_mm = 1e3 * voxel_m_ * (1 + scale_), origin_mm = -0.5 * told_mm * (static_cast<double>(side) - 1);
    file += "\nspace dimension: 3\nspace units: \"mm\" \"mm\" \"mm\"\n";
    file += format("space directions: (%.17g,0,0) (0,%.17g,0) (0,0,%.17g)\nspace origin: (%.17g,%.17g,%.17g)\n",
                   told_mm, told_mm, told_mm, origin_mm, origin_mm, origin_mm);
    file += "endian: little\nencoding: raw\n\n";
    for (const double v : observed) {
      const auto number = static_cast<float>(v);
      file.append(reinterpret_cast<const char*>(&number), sizeof number);
    }
    into.files["scan.nrrd"] = file;
    into.files["piece.ply"] = mesh();
    Value m = Value::object();
    m["meshes"]["piece"] = Value::object({{"file", "piece"}});
    m["volumes"]["v"] = Value::object({{"file", "scan"}, {"reference", "piece"}, {"value", "attenuation"}});
    if (!markers_.empty()) m["markers"] = Value::array();
    for (std::size_t k = 0; k < markers_.size(); ++k) {
      const Vec3 c = markers_[k].centre_m;
      Value marker = Value::object({{"id", format("m%zu", k)}, {"volume", "v"}, {"radius_m", markers_[k].radius_m}});
      marker["centre_m"] = Value(Value::Array{Value(c.x), Value(c.y), Value(c.z)});
      m["markers"].as_array().push_back(std::move(marker));
    }
    finish(m, into);
  }

 private:
  // A large hollow to one side, and a small one opposite.
  template <class Turned>
  static std::vector<Ellipsoid> with_hollows(const Ellipsoid& outer, double wall, const Turned& turned,
                                             Random& random) {
    const double least = std::min({outer.radii.x, outer.radii.y, outer.radii.z}) - wall;
    const Vec3 way = normalized({random.normal(), random.normal(), random.normal()});
    const double large = 0.62 * least, small = 0.26 * least;
    const Ellipsoid hollow{outer.centre + way * (least - large),
                           {large, large * random.uniform(0.7, 0.95), large * random.uniform(0.7, 0.95)},
                           turned(),
                           true};
    const Ellipsoid bubble{outer.centre - way * (least - small), {small, small, small}, {}, true};
    return {outer, hollow, bubble};
  }
  // Iron balls that stand on the piece.
  void glue_markers(Random& random) {
    const Ellipsoid& piece = bodies_.front();
    for (int k = 0; k < 3; ++k) {
      const double height = random.uniform(-0.7, 0.7), angle = 2 * pi * k / 3 + random.uniform(-0.6, 0.6);
      const double level = std::sqrt(1 - height * height), radius = random.uniform(4, 6) * voxel_m_;
      const Vec3 unit{level * std::cos(angle), level * std::sin(angle), height};
      const Vec3 outward = normalized({unit.x / piece.radii.x, unit.y / piece.radii.y, unit.z / piece.radii.z});
      markers_.push_back({piece.turn * (unit * piece.radii + outward * radius) + piece.centre, radius});
    }
  }
  ct::Scanner scanner_of(const Sizes& sizes) const {
    ct::Scanner s = scanner_;
    s.voxels = side, s.voxel_m = voxel_m_;
    s.samples = {2, 2};
    // Iron hardens a beam whatever is left out: with markers one energy.
    s.spectrum = markers_.empty() ? ct::tube(120, 2, 0, 16) : ct::mono(70);
    s.imperfections["beam-hardening"] = size_of(sizes, "hardening");
    constexpr std::array<std::pair<const char*, const char*>, 8> names{{{"blur", "blur"},
                                                                        {"streaks", "streak"},
                                                                        {"cupping", "cupping"},
                                                                        {"rings", "ring"},
                                                                        {"tilt", "axis-tilt"},
                                                                        {"scatter", "scatter"},
                                                                        {"offset axis", "axis-offset"},
                                                                        {"drifting source", "drift"}}};
    for (const auto& [own, its] : names)
      if (sizes.contains(own)) s.imperfections[its] = size_of(sizes, own);
    return s;
  }
  ct::Phantom piece() const {
    ct::ShapePtr shape;
    for (const Ellipsoid& e : bodies_) {
      const ct::ShapePtr own = ct::turned(ct::ellipsoid({}, e.radii), e.turn, e.centre);
      shape = !shape ? own : e.hollow ? ct::without(shape, own) : ct::united({shape, own});
    }
    ct::Phantom phantom{"piece", {{"piece", shape, glass_ ? ct::glass() : ct::aluminium()}}, {}};
    for (const Marker& m : markers_) phantom.parts.push_back({"marker", ct::ball(m.centre_m, m.radius_m), ct::iron()});
    return phantom;
  }
  double value_of_material() const {
    Numbers v = scanned_.front().second;
    const auto near = v.begin() + static_cast<std::ptrdiff_t>(v.size() - v.size() / 50);
    std::nth_element(v.begin(), near, v.end());
    return *near;
  }
  // What a mesh that was cut elsewhere, and a head that tells larger voxels, make of a comparison, to first order:
  // walls are off along their normals, and by a share of their distance from the middle.
  Numbers misread(const Numbers& v, const Sizes& sizes) const {
    const double offset = size_of(sizes, "threshold"), scale = size_of(sizes, "scale");
    Numbers result = v;
    if (offset == 0 && scale == 0) return result;
    const double middle = 0.5 * (static_cast<double>(side) - 1);
    for_inner([&](std::size_t n, Vec3 index) {
      const Vec3 slope =
          Vec3{v[n + 1] - v[n - 1], v[n + side] - v[n - side], v[n + side * side] - v[n - side * side]} * 0.5;
      result[n] += offset * gonio::norm(slope) - scale * dot(index - Vec3{middle, middle, middle}, slope);
    });
    return result;
  }
  template <class Body>
  static void for_inner(const Body& body) {
    for (std::size_t k = 1; k + 1 < side; ++k)
      for (std::size_t j = 1; j + 1 < side; ++j)
        for (std::size_t i = 1; i + 1 < side; ++i)
          body((k * side + j) * side + i, Vec3{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
  }
  // Ellipsoids as nets of longitudes and latitudes, moved to where the user believes them, walls `offset_voxels_`
  // within (material) of where they are.
  std::string mesh() const {
    constexpr int around = 180, down = 90;
    std::string points, faces;
    std::uint32_t count = 0, triangles = 0;
    const Mat3 back = transposed(turn_);
    const auto put = [](std::string& to, auto value) {
      to.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
    for (const Ellipsoid& e : bodies_) {
      const std::uint32_t first = count;
      for (int d = 0; d <= down; ++d)
        for (int a = 0; a < (d == 0 || d == down ? 1 : around); ++a) {
          const double t = pi * d / down, f = 2 * pi * a / around;
          const Vec3 unit{std::sin(t) * std::cos(f), std::sin(t) * std::sin(f), std::cos(t)};
          const Vec3 outward = normalized({unit.x / e.radii.x, unit.y / e.radii.y, unit.z / e.radii.z});
          const Vec3 at =
              e.turn * (unit * e.radii - outward * ((e.hollow ? -1 : 1) * offset_voxels_ * voxel_m_)) + e.centre;
          const Vec3 p = back * (at - shift_);
          for (const double c : {p.x, p.y, p.z}) put(points, c);
          ++count;
        }
      const auto index = [&](int d, int a) {
        if (d == 0) return first;
        if (d == down) return count - 1;
        return first + 1 + static_cast<std::uint32_t>((d - 1) * around + a % around);
      };
      const auto face = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        put(faces, std::uint8_t{3});
        for (const std::uint32_t v : e.hollow ? std::array{a, c, b} : std::array{a, b, c}) put(faces, v);
        ++triangles;
      };
      for (int d = 0; d < down; ++d)
        for (int a = 0; a < around; ++a) {
          if (d > 0) face(index(d, a), index(d + 1, a), index(d, a + 1));
          if (d + 1 < down) face(index(d, a + 1), index(d + 1, a), index(d + 1, a + 1));
        }
    }
    return format(
               "ply\nformat binary_little_endian 1.0\nelement vertex %u\nproperty double x\nproperty double y\n"
               "property double z\nelement face %u\nproperty list uchar uint vertex_indices\nend_header\n",
               count, triangles) +
           points + faces;
  }

  std::vector<Ellipsoid> bodies_;
  std::vector<Marker> markers_;
  ct::Scanner scanner_;
  double voxel_m_ = 3e-4, photons_ = 1e5;
  bool glass_ = true;
  Mat3 turn_;
  Vec3 shift_;
  std::uint64_t noise_seed_ = 0;
  mutable ct::Projections paths_;
  mutable double sigma_ = 0, scale_ = 0, offset_voxels_ = 0;
  mutable Sizes told_;                                      // as simulated last
  mutable std::vector<std::pair<Sizes, Numbers>> scanned_;  // the perfect one first
};

}  // namespace

std::unique_ptr<World> tomograph_world() {
  return std::make_unique<Tomograph>();
}

}  // namespace gonio::sealed
