// Two pieces with markers glued to them, scanned by a tomograph and put back into a scene of calibrated cameras: a body
// with a spout, whose pose was estimated from these photographs, and a lid, whose pose was known beforehand. Both stand
// in a bowl of glass; through its wall some views see some markers. Where the light really goes is found by Fermat's
// principle on the bowl's two spheres, not by refraction at planes. Glue is 20 % thicker here than there, the
// tomograph's centres and the cameras' poses have errors of the size that is stated.
#include <array>
#include <cmath>

#include "geom/vector.h"
#include "sealed/camera_chain.h"
#include "sealed/recording.h"
#include "sealed/worlds.h"

namespace gonio::sealed {
namespace {

constexpr int width = 4000, height = 3000;

Vec3 turned_about(Vec3 v, Vec3 p) {  // Rodrigues
  const double angle = norm(v);
  if (angle < 1e-14) return p;
  const Vec3 k = v / angle;
  return p * std::cos(angle) + cross(k, p) * std::sin(angle) + k * (dot(k, p) * (1 - std::cos(angle)));
}
Vec3 direction_of(Random& random) {
  return normalized(Vec3{random.normal(), random.normal(), random.normal()});
}

struct Place {
  Vec3 turn, shift;
  Vec3 operator()(Vec3 p) const { return turned_about(turn, p) + shift; }
};
struct Marker {
  int piece = 0;
  Vec3 at, normal, scanned;  // truth and the tomograph's
  double glue = 1;           // of the mean thickness
};
struct Camera {
  Vec3 right, down, forward, eye;  // truth
  std::array<double, 9> rotation{};
  Vec3 believed;  // eye
  int sitting = 0;
};
struct Seen {
  std::size_t camera = 0, marker = 0;
  double sigma_px = 0.1;
  bool glass = false;
};
struct Bowl {
  Vec3 centre;
  double outer_m = 0.14, wall_m = 4e-3, rim_z = 0.05;
};

// First crossing of the line from `eye` along unit `d` with a sphere; negative: none.
double reach(Vec3 eye, Vec3 d, Vec3 centre, double radius) {
  const Vec3 o = eye - centre;
  const double b = dot(o, d), c = dot(o, o) - radius * radius, root = b * b - c;
  return root < 0 ? -1 : -b - std::sqrt(root);
}

// The point of the bowl's outer sphere through which light from `marker` goes to `eye`: the optical path over a point
// of each sphere, both in the plane of eye, centre and marker, is stationary. Newton from the straight line.
Vec3 first_point(const Bowl& bowl, Vec3 eye, Vec3 marker, double eta) {
  const Vec3 e1 = normalized(eye - bowl.centre), m = marker - bowl.centre;
  const Vec3 across = m - e1 * dot(m, e1);
  const Vec3 e2 = norm(across) > 1e-9 ? normalized(across) : Vec3{};
  const double inner_m = bowl.outer_m - bowl.wall_m;
  const auto on = [&](double radius, double angle) {
    return bowl.centre + (e1 * std::cos(angle) + e2 * std::sin(angle)) * radius;
  };
  const auto along = [&](double angle) { return e2 * std::cos(angle) - e1 * std::sin(angle); };
  const auto slope = [&](std::array<double, 2> a) {  // of the optical path
    const Vec3 p = on(bowl.outer_m, a[0]), q = on(inner_m, a[1]), pq = normalized(q - p);
    return std::array<double, 2>{dot(normalized(p - eye) - pq * eta, along(a[0])),
                                 dot(pq * eta + normalized(q - marker), along(a[1]))};
  };
  const Vec3 d = normalized(marker - eye);
  const auto start = [&](double radius) {
    const Vec3 p = eye + d * reach(eye, d, bowl.centre, radius) - bowl.centre;
    return std::atan2(dot(p, e2), dot(p, e1));
  };
  std::array<double, 2> a{start(bowl.outer_m), start(inner_m)};
  for (int round = 0; round < 30; ++round) {
    constexpr double h = 1e-6;
    const auto f = slope(a), fx = slope({a[0] + h, a[1]}), fy = slope({a[0], a[1] + h});
    const double xx = (fx[0] - f[0]) / h, xy = (fy[0] - f[0]) / h, yx = (fx[1] - f[1]) / h, yy = (fy[1] - f[1]) / h;
    const double det = xx * yy - xy * yx;
    a[0] -= (f[0] * yy - f[1] * xy) / det;
    a[1] -= (f[1] * xx - f[0] * yx) / det;
  }
  return on(bowl.outer_m, a[0]);
}

class MarkersWorld final : public World {
 public:
  std::vector<EffectKind> effects() const override {
    std::vector<EffectKind> k;
    const auto add = [&](EffectKind kind) -> EffectKind& { return k.emplace_back(std::move(kind)).as_drawn(); };
    const std::vector<std::string> geometry{"geometry", "pose"}, scanner{"tomograph", "geometry"};
    const std::vector<std::string> normal{"surface.exitance-angle"}, moved{"marker.height", "surface.exitance-angle"};
    add({"glue", "marker.offset", geometry, normal, 1e-4, 5e-4}).means({"thickness_m"});
    add({"wrong voxels", "ct.scale", scanner, {"marker.distance-from-origin", "volume.height"}, 1.5e-3, 6e-3})
        .of_either_sign()
        .means({"scale"});
    add({"bent light", "marker.refracted", geometry, {"glass.path", "glass.incidence"}, 0.46, 0.75}).nearly("eta");
    k.back().values = [](const Numbers& size) {
      return std::vector<TrueValue>{{"marker.refracted", "eta", 1 + size[0]}};
    };
    add({"moved lid", "geometry.pose", geometry, moved, 1e-4, 5e-4})
        .of_either_sign()
        .of_parts(3)
        .means({"shift_x_m", "shift_y_m", "shift_z_m"});
    add({"nudged lid", "geometry.pose", geometry, moved, 1e-4, 5e-4}).of_either_sign().of_parts(3);
    add({"sunk lid", "geometry.contact", geometry, {"marker.height"}, 1e-4, 6e-4})
        .means({"depth_m"})
        .only_for("resting lid");
    add({"bent body", "", geometry, {}, 1e-2, 4e-2}).of_either_sign();
    return k;
  }

  void design(Random& random, const std::string& variant) override {
    variant_ = variant;
    ball_ = variant == "ball";
    sigma_scan_m_ = random.uniform(5e-6, 15e-6);
    sigma_turn_ = random.uniform(1e-5, 3e-5), sigma_eye_m_ = random.uniform(1e-5, 4e-5);
    noise_px_ = random.uniform(0.05, 0.2);
    focal_px_ = random.uniform(3500, 5000);
    bowl_.wall_m = random.uniform(2.5e-3, 6e-3);
    bowl_.outer_m = random.uniform(0.13, 0.16);
    bowl_.centre = Vec3{random.uniform(-0.01, 0.01), random.uniform(-0.01, 0.01), random.uniform(0.06, 0.08)};
    bowl_.rim_z = bowl_.centre.z + random.uniform(0.04, 0.1);
    for (Place& p : believed_)
      p = {direction_of(random) * random.uniform(0, 0.5), {random.normal() * 5e-3, random.normal() * 5e-3, 0.04}};
    believed_[1].shift.z = 0.1;
    glue_on(random);
    stand_cameras(random);
    look(random);
    body_ = {random.normal() * 2e-4, random.normal() * 2e-4, random.normal() * 2e-4,
             random.normal() * 1e-3, random.normal() * 1e-3, random.normal() * 1e-3};
    lid_ = {0, 0, 0, 0, 0, 0};
    if (variant == "free lid" || variant == "resting lid")
      for (std::size_t i = 0; i < 6; ++i)
        if (free_of_lid(i)) lid_[i] = random.normal() * (i < 3 ? 2e-4 : 1e-3);
  }

  // By how much the body (and the lid, where it is free) stands otherwise than the manifest says.
  Numbers base() const override {
    Numbers b = body_;
    for (std::size_t i = 0; i < 6; ++i)
      if (free_of_lid(i)) b.push_back(lid_[i]);
    return b;
  }
  Numbers base_steps() const override { return Numbers(base().size(), 1e-5); }

  Numbers simulate(const Numbers& b, const Sizes& sizes) const override {
    std::array<double, 6> lid{};
    for (std::size_t i = 0, n = 6; i < 6; ++i)
      if (free_of_lid(i)) lid[i] = b[n++];
    const std::array<Place, 2> off{Place{{b[3], b[4], b[5]}, {b[0], b[1], b[2]}},
                                   Place{{lid[3], lid[4], lid[5]}, {lid[0], lid[1], lid[2]}}};
    Numbers pixels;
    for (const Seen& s : seen_) {
      const Marker& m = markers_[s.marker];
      const Camera& c = cameras_[s.camera];
      Vec3 x = m.at / (1 + size_of(sizes, "wrong voxels")) + m.normal * (size_of(sizes, "glue") * m.glue);
      if (m.piece == 0) x.x += size_of(sizes, "bent body") * x.z * x.z / 0.05;
      const Place& place = believed_[static_cast<std::size_t>(m.piece)];
      const Place& moved = off[static_cast<std::size_t>(m.piece)];
      Vec3 world = turned_about(moved.turn, place(x) - place.shift) + place.shift + moved.shift;
      if (m.piece == 1) {
        world.z -= size_of(sizes, "sunk lid");
        for (const char* name : {"moved lid", "nudged lid"})
          if (name[0] == 'm' || c.sitting == 1)
            world += Vec3{size_of(sizes, name, 0), size_of(sizes, name, 1), size_of(sizes, name, 2)};
      }
      const double eta = 1 + size_of(sizes, "bent light");
      const Vec3 towards = (s.glass && eta > 1 ? first_point(bowl_, c.eye, world, eta) : world) - c.eye;
      const double z = dot(towards, c.forward);
      pixels.push_back(0.5 * (width - 1) + focal_px_ * dot(towards, c.right) / z);
      pixels.push_back(0.5 * (height - 1) + focal_px_ * dot(towards, c.down) / z);
    }
    return pixels;
  }
  Numbers sigma(const Numbers&) const override {
    Numbers s;
    for (const Seen& row : seen_) s.insert(s.end(), {row.sigma_px, row.sigma_px});
    return s;
  }
  Numbers noisy(const Numbers& clean, Random& random) const override {
    const Numbers s = sigma(clean);
    Numbers values = clean;
    for (std::size_t i = 0; i < values.size(); ++i) values[i] += s[i] * random.normal();
    return values;
  }
  Numbers norm(const Numbers& observed) const override { return Numbers(observed.size(), 0.5); }
  bool relative() const override { return false; }
  bool knows_floor() const override { return false; }  // the tomograph's and the cameras' errors are fitted as well

  void write(const Numbers& observed, const Numbers& stated, Case& into) const override {
    const std::vector<Column> columns = table_of(observed, stated);
    into.files["table.csv"] = csv(columns);
    Value m = Value::object();
    m["cameras"]["c"] = Value::object({{"model", "pinhole"},
                                       {"width_px", width},
                                       {"height_px", height},
                                       {"fx_px", focal_px_},
                                       {"fy_px", focal_px_},
                                       {"cx_px", 0.5 * (width - 1)},
                                       {"cy_px", 0.5 * (height - 1)}});
    m["images"] = images();
    add_pieces(m);
    m["tables"]["t"] = table_section("markers", columns, {"u_px", "v_px"}, {"u_sigma_px", "v_sigma_px"});
    if (variant_ == "resting lid") m["tables"]["t"]["parameters"]["2/shift_z_m"] = Value(0.0);
    finish(m, into);
  }

 private:
  std::vector<Column> table_of(const Numbers& observed, const Numbers& stated) const {
    std::vector<Column> columns;
    for (const char* name : {"image", "piece", "marker"}) columns.push_back({name, "", {}});
    for (const char* name : {"x_m", "y_m", "z_m", "centre_sigma_m"}) columns.push_back({name, "m", {}});
    for (const char* name : {"nx", "ny", "nz"}) columns.push_back({name, "1", {}});
    for (const char* name : {"u_px", "v_px", "u_sigma_px", "v_sigma_px"}) columns.push_back({name, "px", {}});
    for (const char* name : {"glass_path_m", "glass_behind_m"}) columns.push_back({name, "m", {}});
    for (const char* side : {"in", "out"})
      for (const char* axis : {"_x", "_y", "_z"}) columns.push_back({std::string("glass_") + side + axis, "1", {}});
    for (std::size_t r = 0; r < seen_.size(); ++r) {
      const Marker& m = markers_[seen_[r].marker];
      Numbers row{double(seen_[r].camera + 1),
                  double(m.piece + 1),
                  double(seen_[r].marker + 1),
                  m.scanned.x,
                  m.scanned.y,
                  m.scanned.z,
                  sigma_scan_m_,
                  m.normal.x,
                  m.normal.y,
                  m.normal.z,
                  observed[2 * r],
                  observed[2 * r + 1],
                  stated[2 * r],
                  stated[2 * r + 1]};
      const Numbers wall = wall_of(seen_[r]);
      row.insert(row.end(), wall.begin(), wall.end());
      for (std::size_t c = 0; c < row.size(); ++c) columns[c].values.push_back(row[c]);
    }
    return columns;
  }
  Value images() const {
    Value list = Value::array();
    for (std::size_t i = 0; i < cameras_.size(); ++i) {
      const Camera& c = cameras_[i];
      Value stand = pose({c.rotation.begin(), c.rotation.end()}, c.believed.x, c.believed.y, c.believed.z);
      stand["sigma"] =
          Value::object({{"rotation_rad", numbers({sigma_turn_})}, {"translation_m", numbers({sigma_eye_m_})}});
      list.push_back(Value::object({{"id", std::to_string(i + 1)},
                                    {"camera", "c"},
                                    {"group", c.sitting == 0 ? "morning" : "evening"},
                                    {"world_from_camera", stand}}));
    }
    return list;
  }
  void add_pieces(Value& m) const {
    m["objects"] = Value::array();
    m["meshes"]["ball"] = Value::object({{"sphere", Value::object({{"radius_m", 0.05}})}});
    m["surfaces"]["glass"] = Value::object({{"model", "diffuse"}, {"albedo", 0.5}});
    for (std::size_t p = 0; p < 2; ++p) {
      Numbers turn;
      const std::array<Vec3, 3> axes{turned_about(believed_[p].turn, {1, 0, 0}),
                                     turned_about(believed_[p].turn, {0, 1, 0}),
                                     turned_about(believed_[p].turn, {0, 0, 1})};
      for (int row = 0; row < 3; ++row)
        for (const Vec3& axis : axes) turn.push_back(axis[row]);
      Value stand = pose(turn, believed_[p].shift.x, believed_[p].shift.y, believed_[p].shift.z);
      if (p == 0 || free_of_lid(0))
        stand["sigma"] = Value::object({{"rotation_rad", numbers({1e-3})}, {"translation_m", numbers({2e-4})}});
      m["objects"].push_back(Value::object(
          {{"id", std::to_string(p + 1)}, {"mesh", "ball"}, {"surface", "glass"}, {"world_from_object", stand}}));
    }
  }
  bool free_of_lid(std::size_t number) const {
    return variant_ == "free lid" || (variant_ == "resting lid" && number != 2);
  }
  static Value numbers(std::initializer_list<double> list) {
    Value v = Value::array();
    for (const double x : list) v.push_back(Value(x));
    return v;
  }

  // On a ball, or on an ellipsoid with a spout (body) or a knob (lid), where the way out is not the way from the
  // middle.
  void glue_on(Random& random) {
    for (int piece = 0; piece < 2; ++piece) {
      const Vec3 radii = ball_ ? Vec3{0.05, 0.05, 0.05}
                               : Vec3{random.uniform(0.04, 0.06), random.uniform(0.04, 0.06),
                                      random.uniform(0.02, 0.05) * (piece == 0 ? 1.3 : 0.6)};
      const int count = 9 + static_cast<int>(random.below(6));
      const Vec3 spout = normalized(Vec3{1, random.normal() * 0.3, 0.5});
      for (int i = 0; i < count; ++i) {
        Marker m;
        m.piece = piece;
        Vec3 d = direction_of(random);
        d.z = std::abs(d.z);
        m.at = d * radii;
        m.normal = normalized(Vec3{d.x / radii.x, d.y / radii.y, d.z / radii.z});
        if (!ball_ && i % 3 == 0) {
          const Vec3 axis = piece == 0 ? spout : Vec3{0, 0, 1};
          const Vec3 out = normalized(cross(axis, direction_of(random)));
          const double along = piece == 0 ? random.uniform(0.05, 0.085) : random.uniform(0.03, 0.05);
          m.at = axis * along + out * 0.008;
          m.normal = out;
        }
        m.glue = ball_ ? 1 : 1 + 0.2 * random.normal();
        m.scanned = m.at + Vec3{random.normal(), random.normal(), random.normal()} * sigma_scan_m_;
        markers_.push_back(m);
      }
    }
  }

  void stand_cameras(Random& random) {
    const std::size_t count = 12 + random.below(10);
    for (std::size_t i = 0; i < count; ++i) {
      const double azimuth = 2 * pi * (static_cast<double>(i) + random.uniform(-0.3, 0.3)) / static_cast<double>(count);
      const double rise = random.uniform(0.1, 1.1), distance = random.uniform(0.8, 1.2);
      Camera c;
      c.believed =
          Vec3{std::cos(azimuth) * std::cos(rise), std::sin(azimuth) * std::cos(rise), std::sin(rise)} * distance;
      c.forward = normalized(Vec3{random.normal() * 0.01, random.normal() * 0.01, 0.07} - c.believed);
      c.right = normalized(cross(c.forward, {0, 0, 1}));
      c.down = cross(c.forward, c.right);
      c.rotation = {c.right.x,   c.down.x,  c.forward.x, c.right.y,  c.down.y,
                    c.forward.y, c.right.z, c.down.z,    c.forward.z};
      const Vec3 turn = Vec3{random.normal(), random.normal(), random.normal()} * sigma_turn_;
      for (Vec3* axis : {&c.right, &c.down, &c.forward}) *axis = turned_about(turn, *axis);
      c.eye = c.believed + Vec3{random.normal(), random.normal(), random.normal()} * sigma_eye_m_;
      c.sitting = i % 2 == 0 ? 0 : 1;
      cameras_.push_back(c);
    }
  }

  Vec3 believed_place(const Seen& s) const {
    const Marker& m = markers_[s.marker];
    return believed_[static_cast<std::size_t>(m.piece)](m.scanned);
  }
  void look(Random& random) {
    for (std::size_t c = 0; c < cameras_.size(); ++c)
      for (std::size_t m = 0; m < markers_.size(); ++m) {
        Seen s{c, m, noise_px_ * random.uniform(0.8, 1.6), false};
        const Place& place = believed_[static_cast<std::size_t>(markers_[m].piece)];
        const Vec3 at = believed_place(s), sight = normalized(at - cameras_[c].believed);
        if (dot(turned_about(place.turn, markers_[m].normal), sight) > -0.25 || random.uniform() < 0.1) continue;
        const double to_wall = reach(cameras_[c].believed, sight, bowl_.centre, bowl_.outer_m);
        const Vec3 in = cameras_[c].believed + sight * to_wall;
        const bool within = gonio::norm(at - bowl_.centre) < bowl_.outer_m - bowl_.wall_m - 5e-3;
        s.glass = within && to_wall > 0 && in.z < bowl_.rim_z;
        seen_.push_back(s);
      }
  }
  // Where the straight line goes through the bowl.
  Numbers wall_of(const Seen& s) const {
    if (!s.glass) return Numbers(8, 0.0);
    const Vec3 eye = cameras_[s.camera].believed, at = believed_place(s), sight = normalized(at - eye);
    const double in = reach(eye, sight, bowl_.centre, bowl_.outer_m),
                 out = reach(eye, sight, bowl_.centre, bowl_.outer_m - bowl_.wall_m);
    const Vec3 n_in = normalized(eye + sight * in - bowl_.centre), n_out = normalized(bowl_.centre - eye - sight * out);
    return {out - in, gonio::norm(at - eye) - out, n_in.x, n_in.y, n_in.z, n_out.x, n_out.y, n_out.z};
  }

  std::string variant_;
  bool ball_ = false;
  double sigma_scan_m_ = 0, sigma_turn_ = 0, sigma_eye_m_ = 0, noise_px_ = 0.1, focal_px_ = 4000;
  Bowl bowl_;
  std::array<Place, 2> believed_;
  std::vector<Marker> markers_;
  std::vector<Camera> cameras_;
  std::vector<Seen> seen_;
  Numbers body_, lid_;
};

}  // namespace

std::unique_ptr<World> markers_world() {
  return std::make_unique<MarkersWorld>();
}

}  // namespace gonio::sealed
