// Calibration boards before a camera: corners as a detector finds them. The lens is a polynomial of the ray's tangent,
// a traced singlet, or none; boards bend to arcs that keep their length; rows are read one after the other.
#include <array>
#include <cmath>

#include "geom/vector.h"
#include "sealed/recording.h"
#include "sealed/traced_lens.h"
#include "sealed/worlds.h"

namespace gonio::sealed {
namespace {

constexpr int columns = 9, rows = 6, width = 640, height = 480;
constexpr double focal = 540, square = 0.025;
constexpr Vec3 half_board{0.5 * (columns - 1) * square, 0.5 * (rows - 1) * square, 0};

struct View {
  Vec3 turn, origin;     // rotation vector; of the board's first corner, in the camera
  double direction = 0;  // of its motion over the image
};

Vec3 turned(Vec3 v, Vec3 p) {  // Rodrigues
  const double angle = norm(v);
  if (angle < 1e-12) return p + cross(v, p);
  const Vec3 k = v / angle;
  return p * std::cos(angle) + cross(k, p) * std::sin(angle) + k * (dot(k, p) * (1 - std::cos(angle)));
}

// A strip of half length h whose middle stands `sag` above its ends, bent to an arc: (along, height) of a point at s.
std::array<double, 2> on_arc(double s, double h, double sag) {
  if (sag == 0) return {s, 0};
  const double radius = (h * h + sag * sag) / (2 * sag), angle = s / radius;
  return {radius * std::sin(angle), radius * (std::cos(angle) - std::cos(h / radius))};
}

double part(const Sizes& sizes, const char* name, std::size_t k = 0) {
  const auto found = sizes.find(name);
  return found == sizes.end() ? 0 : found->second[k];
}

Vec3 on_board(int c, int r, const Sizes& sizes) {
  const auto x = on_arc(c * square - half_board.x, half_board.x, part(sizes, "bent board", 0));
  const auto y = on_arc(r * square - half_board.y, half_board.y, part(sizes, "bent board", 1));
  Vec3 p{half_board.x + x[0] * (1 + part(sizes, "stretched print")), half_board.y + y[0], x[1] + y[1]};
  // A corner that was folded: everything beyond a diagonal stands up.
  const double beyond = c * square + r * square - 0.6 * 2 * (half_board.x + half_board.y);
  if (beyond > 0) p.z += part(sizes, "dog-ear") * beyond / (0.4 * 2 * (half_board.x + half_board.y));
  return p;
}

Vec2 through_lens(Vec2 p, const Sizes& sizes) {
  const double t2 = dot(p, p), t = std::sqrt(t2), theta = std::atan(t);
  double scale = 1 + part(sizes, "radial") * t2;
  scale += part(sizes, "any radial", 0) * t2 + part(sizes, "any radial", 1) * t2 * t2 +
           part(sizes, "any radial", 2) * t2 * t2 * t2;
  if (const double stop = part(sizes, "traced lens"); stop > 0) scale *= image_height_ratio({.stop_m = stop}, t);
  if (const double w = part(sizes, "fisheye"); t > 0) scale *= 1 + w * (theta / t - 1);
  const double p1 = part(sizes, "decentred", 0), p2 = part(sizes, "decentred", 1), s1 = part(sizes, "prism", 0),
               s3 = part(sizes, "prism", 1);
  return {p.x * scale + 2 * p1 * p.x * p.y + p2 * (t2 + 2 * p.x * p.x) + s1 * t2,
          p.y * scale + 2 * p2 * p.x * p.y + p1 * (t2 + 2 * p.y * p.y) + s3 * t2};
}

class Boards final : public World {
 public:
  std::vector<EffectKind> effects() const override {
    const std::vector<std::string> radius{"camera.image-radius"}, board{"board.radius", "board.x", "board.y"},
        image{"camera.image-azimuth", "camera.image-radius", "camera.image-x", "camera.image-y"}, lens{"lens"};
    std::vector<EffectKind> k;
    const auto add = [&](EffectKind kind) -> EffectKind& { return k.emplace_back(std::move(kind)); };
    add({"radial", "lens.radial", lens, radius, 0.01, 0.25}).of_either_sign().means({"k1"});
    add({"traced lens", "lens.radial", lens, radius, 2e-4, 1.5e-3});
    add({"decentred", "lens.tangential", lens, image, 0.001, 0.01}).of_either_sign().of_parts(2).means({"p1", "p2"});
    add({"prism", "lens.thin-prism", lens, image, 0.002, 0.02}).of_either_sign().of_parts(2);
    add({"bent board", "board.warp", {"board"}, board, 1e-4, 1e-3})
        .of_either_sign()
        .of_parts(2)
        .means({"sag_x_m", "sag_y_m"});
    add({"rolling shutter", "camera.rolling-shutter", {"sensor"}, {"camera.image-y", "camera.image-x"}, 0.5, 5})
        .of_parts(1, 24);
    add({"fisheye", "lens.fisheye", lens, radius, 0.05, 0.6}).only_for("where asked");
    add({"any radial", "lens.radial", lens, radius, 0.05, 0.2}).of_either_sign().of_parts(3).only_for("a rival");
    add({"periodic error of the columns", "", {"sensor"}, {"camera.image-x"}, 0.15, 0.6});
    add({"dog-ear", "", {"board"}, board, 1e-3, 5e-3}).of_either_sign();
    return k;
  }
  void design(Random& random, const std::string& variant) override {
    noise_px_ = random.uniform(0.05, 0.15);
    const bool frontal = variant == "frontal";
    const int views = 10 + static_cast<int>(random.below(6));
    while (static_cast<int>(views_.size()) < views) {
      View v;
      const double tilt = frontal ? 0.03 : 0.6, z = frontal ? 0.42 : random.uniform(0.28, 0.5);
      v.turn = {random.uniform(-tilt, tilt), random.uniform(-tilt, tilt), random.uniform(-0.4, 0.4)};
      const Vec3 middle{random.uniform(-0.22, 0.22) * z, random.uniform(-0.15, 0.15) * z, z};
      v.origin = middle - turned(v.turn, half_board);
      v.direction = random.uniform(0, 2 * pi);
      if (whole(v)) views_.push_back(v);
    }
    for (const View& v : views_) turns_.push_back(v.turn);
  }
  Numbers base() const override {
    Numbers b{focal, 1.001 * focal, 0.5 * width + 2, 0.5 * height - 2};
    for (const View& v : views_) b.insert(b.end(), {0, 0, 0, v.origin.x, v.origin.y, v.origin.z});
    return b;
  }
  Numbers base_steps() const override {
    Numbers s{0.1, 0.1, 0.1, 0.1};
    for (std::size_t v = 0; v < views_.size(); ++v) s.insert(s.end(), {1e-4, 1e-4, 1e-4, 1e-5, 1e-5, 1e-5});
    return s;
  }
  Numbers simulate(const Numbers& b, const Sizes& sizes) const override {
    Numbers pixels;
    for (std::size_t v = 0; v < views_.size(); ++v) {
      const double* own = &b[4 + 6 * v];
      const Vec3 more{own[0], own[1], own[2]}, origin{own[3], own[4], own[5]};
      for (int r = 0; r < rows; ++r)
        for (int c = 0; c < columns; ++c) {
          const Vec3 p = turned(more, turned(turns_[v], on_board(c, r, sizes))) + origin;
          const Vec2 seen = seen_at(p, v, b, sizes);
          pixels.push_back(seen.x);
          pixels.push_back(seen.y);
        }
    }
    return pixels;
  }
  Numbers sigma(const Numbers& clean) const override {  // grows with obliqueness, as of a detector that sees less
    Numbers s(clean.size());
    for (std::size_t i = 0; i < s.size(); ++i) {
      const Vec3 normal = turned(turns_[i / (2 * rows * columns)], {0, 0, 1});
      s[i] = noise_px_ * (0.8 + 0.2 / std::max(0.3, std::abs(normal.z)));
    }
    return s;
  }
  Numbers noisy(const Numbers& clean, Random& random) const override {
    Numbers noisy = clean;
    const Numbers s = sigma(clean);
    for (std::size_t i = 0; i < clean.size(); ++i) noisy[i] += s[i] * random.normal();
    return noisy;
  }
  Numbers norm(const Numbers& observed) const override { return Numbers(observed.size(), 0.5); }
  bool relative() const override { return false; }
  void write(const Numbers& observed, const Numbers& stated, Case& into) const override {
    Random random(into.spec.seed, 0x706f7365u);  // what a first calibration hands over is a little off
    Value images = Value::array(), lines = Value::array();
    std::size_t i = 0;
    for (std::size_t v = 0; v < views_.size(); ++v) {
      const std::string id = "view" + std::to_string(v);
      const Vec3 off{0.004 * random.normal(), 0.004 * random.normal(), 0};
      std::vector<double> matrix(9);
      for (int k = 0; k < 3; ++k) {
        const Vec3 axis = turned(off, turned(turns_[v], {k == 0 ? 1.0 : 0, k == 1 ? 1.0 : 0, k == 2 ? 1.0 : 0}));
        for (int j = 0; j < 3; ++j) matrix[static_cast<std::size_t>(3 * j + k)] = axis[j];
      }
      const Vec3 o = views_[v].origin * (1 + 0.002 * random.normal());
      images.push_back(Value::object(
          {{"id", id}, {"camera", "c"}, {"board", "b"}, {"camera_from_board", pose(matrix, o.x, o.y, o.z)}}));
      for (int r = 0; r < rows; ++r)
        for (int c = 0; c < columns; ++c, i += 2)
          lines.push_back(Value(
              Value::Array{id, r * columns + c, c * square, r * square, observed[i], observed[i + 1], stated[i]}));
    }
    Value table = Value::object({{"model", "camera"}, {"camera", "c"}, {"board", "b"}});
    table["columns"] = Value::object({{"image", ""},
                                      {"corner", "1"},
                                      {"board_x_m", "m"},
                                      {"board_y_m", "m"},
                                      {"u_px", "px"},
                                      {"v_px", "px"},
                                      {"sigma_px", "px"}});
    table["observed"] = std::vector<std::string>{"u_px", "v_px"};
    table["sigma"] = std::vector<std::string>{"sigma_px"};
    table["rows"] = lines;
    Value manifest = Value::object();
    manifest["boards"]["b"] = Value::object(
        {{"kind", "checkerboard"}, {"inner_corners", Value(Value::Array{columns, rows})}, {"square_m", square}});
    manifest["cameras"]["c"] = Value::object({{"model", "pinhole"},
                                              {"width_px", width},
                                              {"height_px", height},
                                              {"fx_px", 1.01 * focal},
                                              {"fy_px", 1.01 * focal},
                                              {"cx_px", 0.5 * width},
                                              {"cy_px", 0.5 * height}});
    manifest["images"] = images;
    manifest["tables"]["corners"] = table;
    finish(manifest, into);
  }

 private:
  // The board moves while rows are read; the moment is found by stepping, as the shutter does.
  Vec2 seen_at(Vec3 p, std::size_t view, const Numbers& b, const Sizes& sizes) const {
    const double way = part(sizes, "rolling shutter") * views_[view].origin.z / focal;
    const Vec3 velocity{way * std::cos(views_[view].direction), way * std::sin(views_[view].direction), 0};
    Vec2 pixel;
    double moment = 0;
    for (int step = 0; step < (way == 0 ? 1 : 6); ++step) {
      const Vec3 at = p + velocity * moment;
      const Vec2 image = through_lens({at.x / at.z, at.y / at.z}, sizes);
      pixel = {b[0] * image.x + b[2], b[1] * image.y + b[3]};
      moment = (pixel.y + 0.5) / height - 0.5;
    }
    pixel.x += part(sizes, "periodic error of the columns") * std::sin(pixel.x / 22.0);
    return pixel;
  }
  bool whole(const View& v) const {
    for (int r = 0; r < rows; ++r)
      for (int c = 0; c < columns; ++c) {
        const Vec3 p = turned(v.turn, {c * square, r * square, 0}) + v.origin;
        const double u = focal * p.x / p.z, w = focal * p.y / p.z;
        if (std::abs(u) > 0.5 * width - 30 || std::abs(w) > 0.5 * height - 30) return false;
      }
    return true;
  }
  std::vector<View> views_;
  std::vector<Vec3> turns_;
  double noise_px_ = 0.1;
};

}  // namespace

std::unique_ptr<World> boards_world() {
  return std::make_unique<Boards>();
}

}  // namespace gonio::sealed
