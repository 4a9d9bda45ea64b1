// Calibration boards before a camera: corners as a detector finds them. The lens is a polynomial of the ray's tangent,
// a traced singlet, or none; boards bend to arcs that keep their length; rows are read one after the other.
// Designs: "three colours" (corners sought in red, green and blue), "two ranges", "turned pictures" (every picture
// searched as it is and turned by half a turn), "warm-up" (boards on stands, photographed again as the camera warms
// up).
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

struct Stand {
  Vec3 turn, origin;  // rotation vector; of the board's first corner, in the camera
};
struct View {
  std::size_t stand = 0;
  double direction = 0;  // of the board's motion over the image
  double warmer = 0;     // K above the first
};
struct Sight {  // one corner of one view, sought in one colour of the picture as it is or turned
  int column = 0, row = 0, channel = 1;
  double turned = 0;
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

// Mean over the band of a colour filter; what the lens bends in green has been taken out.
double magnified(int channel, double t, double dispersion) {
  if (channel == 1 || dispersion == 0) return 1;
  const Singlet lens{.stop_m = 2e-3, .index = crown_glass(0.54)};
  double sum = 0;
  for (int k = 0; k < 5; ++k) {
    const double um = (channel == 0 ? 0.59 : 0.44) + 0.01 * k;
    sum += colour_ratio(lens, lens.index + dispersion * (crown_glass(um) - lens.index), t) / 5;
  }
  return sum;
}

// A diverging front lens, as wide-angle lenses have one: how far the pupil has moved, per metre of focal length.
double pupil_moved(double t) {
  static constexpr double unit = 7.3e-3;
  return pupil_shift({.stop_m = 1e-3, .front_m = -8e-3, .back_m = 8e-3}, t) / unit;
}

Vec2 through_lens(Vec2 p, int channel, const Sizes& sizes) {
  const double t2 = dot(p, p), t = std::sqrt(t2), theta = std::atan(t);
  double scale = 1 + part(sizes, "radial") * t2;
  scale += part(sizes, "any radial", 0) * t2 + part(sizes, "any radial", 1) * t2 * t2 +
           part(sizes, "any radial", 2) * t2 * t2 * t2;
  if (const double stop = part(sizes, "traced lens"); stop > 0) scale *= image_height_ratio({.stop_m = stop}, t);
  scale *= magnified(channel, t, part(sizes, "coloured lens"));
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
    add({"stretched print", "board.scale", {"board"}, {"board.roll", "board.x", "board.y"}, 0.001, 0.01})
        .of_either_sign()
        .means({"scale_x"});
    add({"fisheye", "lens.fisheye", lens, radius, 0.05, 0.6}).only_for("where asked");
    add({"coloured lens", "lens.lateral-colour", lens, {"camera.image-radius-by-channel", "camera.channel"}, 0.03, 0.6})
        .of_either_sign()
        .of_parts(1, 4)
        .only_for("three colours");
    add({"moving pupil",
         "lens.non-central",
         lens,
         {"camera.image-radius-over-distance", "camera.distance", "camera.image-radius"},
         0.02,
         0.2})
        .only_for("two ranges")
        .values = [](const Numbers& size) {
      return std::vector<TrueValue>{
          {"lens.non-central", "pupil_m", size[0] * pupil_moved(0.35) * (1 + 1 / (0.35 * 0.35)), false}};
    };
    add({"other pixel centre", "board.corner-bias", {"sensor"}, {"camera.turned"}, 0.1, 0.5})
        .of_either_sign()
        .of_parts(2)
        .means({"bias_x_px", "bias_y_px"})
        .only_for("turned pictures");
    add({"cold start",
         "camera.thermal",
         {"sensor", "lens"},
         {"camera.temperature", "camera.temperature-in-x", "camera.temperature-in-y"},
         0.02,
         0.2})
        .of_either_sign()
        .of_parts(2, 3)
        .means({"x_px_per_K", "y_px_per_K"})
        .only_for("warm-up");
    add({"any radial", "lens.radial", lens, radius, 0.05, 0.2}).of_either_sign().of_parts(3).only_for("a rival");
    add({"periodic error of the columns", "", {"sensor"}, {"camera.image-x"}, 0.15, 0.6});
    add({"dog-ear", "board.shape", {"board"}, board, 1e-3, 5e-3}).of_either_sign();
    return k;
  }
  void design(Random& random, const std::string& variant) override {
    noise_px_ = random.uniform(0.05, 0.15);
    const bool frontal = variant == "frontal", two_ranges = variant == "two ranges";
    warms_ = variant == "warm-up";
    const std::size_t stands = warms_ ? 5 : 10 + random.below(6);
    while (stands_.size() < stands) {
      Stand s;
      const double tilt = frontal ? 0.03 : 0.6;
      double z = frontal ? 0.42 : random.uniform(0.28, 0.5);
      if (two_ranges) z = stands_.size() % 2 == 0 ? random.uniform(0.24, 0.3) : random.uniform(0.7, 0.9);
      s.turn = {random.uniform(-tilt, tilt), random.uniform(-tilt, tilt), random.uniform(-0.4, 0.4)};
      const Vec3 middle{random.uniform(-0.22, 0.22) * z, random.uniform(-0.15, 0.15) * z, z};
      s.origin = middle - turned(s.turn, half_board);
      if (whole(s)) stands_.push_back(s);
    }
    // The housing warms up exponentially; boards are photographed in turn.
    for (std::size_t v = 0; v < (warms_ ? 6 : 1) * stands; ++v)
      views_.push_back({v % stands, random.uniform(0, 2 * pi), warms_ ? 14 * (1 - std::exp(-0.09 * v)) : 0.0});
    const bool coloured = variant == "three colours", twice = variant == "turned pictures";
    for (int k = 0; k < rows * columns; ++k)
      for (int n = 0; n < (coloured ? 3 : twice ? 2 : 1); ++n)
        sights_.push_back({k % columns, k / columns, coloured ? n : 1, twice ? n * pi : 0.0});
    for (const View& v : views_) warm_mean_ += v.warmer / static_cast<double>(views_.size());
  }
  Numbers base() const override {
    Numbers b{focal, 1.001 * focal, 0.5 * width + 2, 0.5 * height - 2};
    for (const Stand& s : stands_) b.insert(b.end(), {0, 0, 0, s.origin.x, s.origin.y, s.origin.z});
    return b;
  }
  Numbers base_steps() const override {
    Numbers s{0.1, 0.1, 0.1, 0.1};
    for (std::size_t v = 0; v < stands_.size(); ++v) s.insert(s.end(), {1e-4, 1e-4, 1e-4, 1e-5, 1e-5, 1e-5});
    return s;
  }
  Numbers simulate(const Numbers& b, const Sizes& sizes) const override {
    Numbers pixels;
    for (const View& view : views_) {
      const double* own = &b[4 + 6 * view.stand];
      const Vec3 more{own[0], own[1], own[2]}, origin{own[3], own[4], own[5]};
      for (const Sight& sight : sights_) {
        const Vec3 on = on_board(sight.column, sight.row, sizes);
        const Vec2 seen = seen_at(turned(more, turned(stands_[view.stand].turn, on)) + origin, view, sight, b, sizes);
        pixels.push_back(seen.x);
        pixels.push_back(seen.y);
      }
    }
    return pixels;
  }
  Numbers sigma(const Numbers& clean) const override {  // grows with obliqueness, as of a detector that sees less
    Numbers s(clean.size());
    for (std::size_t i = 0; i < s.size(); ++i) {
      const Vec3 normal = turned(stands_[views_[i / (2 * sights_.size())].stand].turn, {0, 0, 1});
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
    std::vector<Value> poses;
    for (const Stand& s : stands_) poses.push_back(nearly(s, random));
    Value images = Value::array(), lines = Value::array();
    std::size_t i = 0;
    for (std::size_t v = 0; v < views_.size(); ++v) {
      const std::string id = "view" + std::to_string(v);
      Value image = Value::object({{"id", id}, {"camera", "c"}, {"board", "b"}});
      image["camera_from_board"] = poses[views_[v].stand];
      if (warms_) image["temperature_K"] = 296.5 + views_[v].warmer;
      images.push_back(image);
      for (const Sight& s : sights_) {
        Value line = Value::array();
        line.push_back(id);
        line.push_back(s.row * columns + s.column);
        for (const double v : {s.column * square, s.row * square, observed[i], observed[i + 1], stated[i]})
          line.push_back(v);
        if (sights_[0].channel == 0) line.push_back(s.channel);
        if (sights_.back().turned > 0) line.push_back(s.turned);
        lines.push_back(line);
        i += 2;
      }
    }
    Value table = Value::object({{"model", "camera"}, {"camera", "c"}, {"board", "b"}});
    table["columns"] = Value::object({{"image", ""},
                                      {"corner", "1"},
                                      {"board_x_m", "m"},
                                      {"board_y_m", "m"},
                                      {"u_px", "px"},
                                      {"v_px", "px"},
                                      {"sigma_px", "px"}});
    if (sights_[0].channel == 0) table["columns"]["channel"] = "1";
    if (sights_.back().turned > 0) table["columns"]["turned_rad"] = "rad";
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
  static Value nearly(const Stand& stand, Random& random) {
    const Vec3 off{0.004 * random.normal(), 0.004 * random.normal(), 0};
    std::vector<double> matrix(9);
    for (int k = 0; k < 3; ++k) {
      const Vec3 axis = turned(off, turned(stand.turn, {k == 0 ? 1.0 : 0, k == 1 ? 1.0 : 0, k == 2 ? 1.0 : 0}));
      for (int j = 0; j < 3; ++j) matrix[static_cast<std::size_t>(3 * j + k)] = axis[j];
    }
    const Vec3 o = stand.origin * (1 + 0.002 * random.normal());
    return pose(matrix, o.x, o.y, o.z);
  }
  Vec2 tangents(Vec3 p, const Sizes& sizes) const {
    const double moved = part(sizes, "moving pupil"), across = std::hypot(p.x, p.y);
    double nearer = 0;
    for (int step = 0; step < (moved == 0 ? 0 : 8); ++step) nearer = moved * pupil_moved(across / (p.z - nearer));
    return {p.x / (p.z - nearer), p.y / (p.z - nearer)};
  }
  // The board moves while rows are read; the moment is found by stepping, as the shutter does.
  Vec2 seen_at(Vec3 p, const View& view, const Sight& sight, const Numbers& b, const Sizes& sizes) const {
    const double way = part(sizes, "rolling shutter") * stands_[view.stand].origin.z / focal;
    const Vec3 velocity{way * std::cos(view.direction), way * std::sin(view.direction), 0};
    const double warm = view.warmer - warm_mean_, x_rate = part(sizes, "cold start", 0),
                 y_rate = part(sizes, "cold start", 1), longer = x_rate != 0 ? 1 + 1.2e-5 * warm : 1;
    Vec2 pixel;
    double moment = 0;
    for (int step = 0; step < (way == 0 ? 1 : 6); ++step) {
      const Vec2 image = through_lens(tangents(p + velocity * moment, sizes), sight.channel, sizes);
      pixel = {b[0] * longer * image.x + b[2] + x_rate * warm, b[1] * longer * image.y + b[3] + y_rate * warm};
      moment = (pixel.y + 0.5) / height - 0.5;
    }
    pixel.x += part(sizes, "periodic error of the columns") * std::sin(pixel.x / 22.0);
    const double way_up = std::cos(sight.turned);  // a detector's error turns with the picture
    pixel.x += way_up * part(sizes, "other pixel centre", 0), pixel.y += way_up * part(sizes, "other pixel centre", 1);
    return pixel;
  }
  bool whole(const Stand& v) const {
    for (int r = 0; r < rows; ++r)
      for (int c = 0; c < columns; ++c) {
        const Vec3 p = turned(v.turn, {c * square, r * square, 0}) + v.origin;
        const double u = focal * p.x / p.z, w = focal * p.y / p.z;
        if (std::abs(u) > 0.5 * width - 30 || std::abs(w) > 0.5 * height - 30) return false;
      }
    return true;
  }
  std::vector<Stand> stands_;
  std::vector<View> views_;
  std::vector<Sight> sights_;
  bool warms_ = false;
  double noise_px_ = 0.1, warm_mean_ = 0;
};

}  // namespace

std::unique_ptr<World> boards_world() {
  return std::make_unique<Boards>();
}

}  // namespace gonio::sealed
