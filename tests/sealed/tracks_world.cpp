// Points of a known body followed through frames by a camera that stands at a distance; the base model believes that it
// stands infinitely far away.
#include <array>
#include <cmath>

#include "geom/vector.h"
#include "sealed/camera_chain.h"
#include "sealed/recording.h"
#include "sealed/worlds.h"

namespace gonio::sealed {
namespace {

constexpr double px_per_m = 900;
constexpr int width = 640, height = 480;

Vec3 turned(Vec3 v, Vec3 p) {
  const double angle = norm(v);
  if (angle < 1e-12) return p;
  const Vec3 k = v / angle;
  return p * std::cos(angle) + cross(k, p) * std::sin(angle) + k * (dot(k, p) * (1 - std::cos(angle)));
}

class TracksWorld final : public World {
 public:
  std::vector<EffectKind> effects() const override {
    const std::vector<std::string> depth{"tracks.depth", "camera.depth", "track.depth"},
        stages{"camera", "lens", "tracks"};
    std::vector<EffectKind> k;
    const auto add = [&](EffectKind kind) -> EffectKind& { return k.emplace_back(std::move(kind)); };
    add({"near camera", "tracks.perspective", stages, depth, 0.05, 0.6});
    add({"slipped tracks", "tracks.outliers", stages, {"tracks.point", "tracks.identity", "point"}, 4, 20});
    add({"rows read late", "", {"sensor"}, {"camera.image-y"}, 0.3, 1.2});
    return k;
  }
  void design(Random& random, const std::string&) override {
    const int points = 30 + static_cast<int>(random.below(20));
    for (int p = 0; p < points; ++p) {
      shape_.push_back({random.uniform(-0.12, 0.12), random.uniform(-0.12, 0.12), random.uniform(-0.12, 0.12)});
      slips_.push_back(random.uniform() < 0.08 ? 6 + static_cast<int>(random.below(6)) : 1000);
    }
    slips_[3] = 7;
    for (int f = 0; f < 16; ++f) {
      const double s = f / 15.0;
      frames_.insert(frames_.end(),
                     {0.8 * std::sin(3 * s), 1.2 * s - 0.6, 0.3 * std::cos(4 * s), 0.04 * std::sin(5 * s),
                      0.03 * std::cos(3 * s), px_per_m * (1 + 0.05 * std::sin(2 * s))});
    }
    noise_px_ = random.uniform(0.15, 0.5);
    slip_ = {std::cos(points), std::sin(points), 0};
  }
  Numbers base() const override { return frames_; }
  Numbers base_steps() const override {
    Numbers s;
    for (std::size_t f = 0; f < frames_.size() / 6; ++f) s.insert(s.end(), {1e-4, 1e-4, 1e-4, 1e-5, 1e-5, 0.01});
    return s;
  }
  Numbers simulate(const Numbers& b, const Sizes& sizes) const override {
    Numbers pixels;
    const double per_distance = size_of(sizes, "near camera") / 0.24;  // depth of the body over its distance
    for (std::size_t f = 0; f < b.size() / 6; ++f)
      for (std::size_t p = 0; p < shape_.size(); ++p) {
        const double* own = &b[6 * f];
        const Vec3 at = turned({own[0], own[1], own[2]}, shape_[p]) + Vec3{own[3], own[4], 0};
        const double scale = own[5] / (1 + per_distance * at.z);
        Vec2 pixel{0.5 * width + scale * at.x, 0.5 * height + scale * at.y};
        if (static_cast<int>(f) >= slips_[p]) {
          pixel.x += size_of(sizes, "slipped tracks") * slip_.x, pixel.y += size_of(sizes, "slipped tracks") * slip_.y;
        }
        pixel.x += size_of(sizes, "rows read late") * std::sin(pixel.y / 14.0);
        pixels.push_back(pixel.x);
        pixels.push_back(pixel.y);
      }
    return pixels;
  }
  Numbers sigma(const Numbers& clean) const override { return Numbers(clean.size(), noise_px_); }
  Numbers noisy(const Numbers& clean, Random& random) const override {
    Numbers values = clean;
    for (double& v : values) v += noise_px_ * random.normal();
    return values;
  }
  Numbers norm(const Numbers& observed) const override { return Numbers(observed.size(), 0.5); }
  bool relative() const override { return false; }
  void write(const Numbers& observed, const Numbers& stated, Case& into) const override {
    std::vector<Column> columns{{"frame", "1", {}}, {"point", "1", {}}, {"x_m", "m", {}},   {"y_m", "m", {}},
                                {"z_m", "m", {}},   {"u_px", "px", {}}, {"v_px", "px", {}}, {"sigma_px", "px", {}}};
    for (std::size_t i = 0; i < observed.size(); i += 2) {
      const std::size_t p = (i / 2) % shape_.size();
      const std::array<double, 8> row{static_cast<double>(i / 2 / shape_.size()),
                                      static_cast<double>(p),
                                      shape_[p].x,
                                      shape_[p].y,
                                      shape_[p].z,
                                      observed[i],
                                      observed[i + 1],
                                      stated[i]};
      for (std::size_t c = 0; c < row.size(); ++c) columns[c].values.push_back(row[c]);
    }
    into.files["table.csv"] = csv(columns);
    Value m = Value::object();
    m["cameras"]["c"] = Value::object({{"model", "orthographic"},
                                       {"width_px", width},
                                       {"height_px", height},
                                       {"px_per_m", px_per_m},
                                       {"cx_px", 0.5 * width},
                                       {"cy_px", 0.5 * height}});
    m["tables"]["t"] = table_section("tracks", columns, {"u_px", "v_px"}, {"sigma_px", "sigma_px"});
    m["tables"]["t"]["camera"] = "c";
    finish(m, into);
  }

 private:
  std::vector<Vec3> shape_;
  std::vector<int> slips_;
  Numbers frames_;
  Vec3 slip_{};
  double noise_px_ = 0.3;
};

}  // namespace

std::unique_ptr<World> tracks_world() {
  return std::make_unique<TracksWorld>();
}

}  // namespace gonio::sealed
