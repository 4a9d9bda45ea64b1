// Environment from a latitude-longitude picture (equirectangular), infinitely far away.
//
// Orientation: the top row looks up, +z. The centre of the picture looks along +x, its left quarter along +y: the
// picture is seen from inside, azimuth phi runs against the columns. With continuous pixel coordinates x, y (corners
// at integers) in a picture of W x H:
//   phi = rotation_rad + pi - 2 pi x / W
//   theta = pi y / H, from +z
//   direction = (sin(theta) cos(phi), sin(theta) sin(phi), cos(theta))
// rotation_rad turns the surroundings about +z, counter-clockwise seen from above.
//
// A pixel is a patch of constant radiance and solid angle 2 pi / W (cos(theta_top) - cos(theta_bottom)); the patches
// tile the sphere. Sampling: row, then column, by luminance times solid angle (Pharr, Jakob & Humphreys 2016, section
// 14.2.4), then uniformly in phi and cos(theta) inside the patch: pdf = share / solid angle, proportional to
// luminance. Nothing is interpolated, so that sampled and looked-up radiance are the same function.
#include <algorithm>
#include <cmath>
#include <vector>

#include "light/distribution.h"
#include "light/emitting_picture.h"
#include "light/light.h"

namespace gonio::light {
namespace {

enum : std::size_t { scale_index, rotation_index };

class LatLong final : public Emitter {
 public:
  LatLong(EmittingPicture picture, double rotation_rad)
      : picture_(std::move(picture)),
        rotation_rad_(rotation_rad),
        edges_(edge_cosines(picture_.rows())),
        cells_(weights(), picture_.columns()) {}

  Sample sample(Vec3, Vec2 u) const override {
    const auto [y, x, inside] = cells_.draw(u);
    const double top = edges_[y], bottom = edges_[y + 1];
    const double z = top + (bottom - top) * inside.y, r = std::sqrt(std::max(0.0, 1 - z * z));
    const double phi = rotation_rad_ + pi - 2 * pi * (static_cast<double>(x) + inside.x) / width();
    const double density = pdf(x, y);
    if (!(density > 0)) return {};
    return {{r * std::cos(phi), r * std::sin(phi), z},
            std::numeric_limits<double>::infinity(),
            picture_.radiance(x, y) / density,
            density,
            false,
            true};
  }
  Hit hit(Vec3, Vec3 direction) const override {
    double turns = (rotation_rad_ + pi - std::atan2(direction.y, direction.x)) / (2 * pi);
    turns -= std::floor(turns);
    const double theta = std::acos(std::clamp(direction.z, -1.0, 1.0));
    const std::size_t x = std::min(static_cast<std::size_t>(turns * width()), columns() - 1);
    const std::size_t y = std::min(static_cast<std::size_t>(theta / pi * height()), rows() - 1);
    return {std::numeric_limits<double>::infinity(), picture_.radiance(x, y), pdf(x, y)};
  }
  bool infinite() const override { return true; }

 private:
  std::size_t columns() const { return picture_.columns(); }
  std::size_t rows() const { return picture_.rows(); }
  double width() const { return static_cast<double>(columns()); }
  double height() const { return static_cast<double>(rows()); }
  static std::vector<double> edge_cosines(std::size_t rows) {
    std::vector<double> cosines;
    for (std::size_t row = 0; row <= rows; ++row)
      cosines.push_back(std::cos(pi * static_cast<double>(row) / static_cast<double>(rows)));
    return cosines;
  }
  double solid_angle(std::size_t row) const { return 2 * pi / width() * (edges_[row] - edges_[row + 1]); }
  double pdf(std::size_t x, std::size_t y) const { return cells_.share(y, x) / solid_angle(y); }
  std::vector<double> weights() const {
    std::vector<double> all;
    for (std::size_t y = 0; y < rows(); ++y)
      for (std::size_t x = 0; x < columns(); ++x) all.push_back(picture_.importance(x, y) * solid_angle(y));
    return all;
  }

  EmittingPicture picture_;
  double rotation_rad_;
  std::vector<double> edges_;  // cosines of the rows' edges
  Distribution2 cells_;
};

class LatLongModel final : public Model {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{
        .family = manifest::Family::light,
        .id = "lat-long",
        .sentence =
            "Surroundings from a latitude-longitude picture of linear radiance; its top row looks up, along +z.",
        .source = "Pharr, Jakob & Humphreys 2016, section 14.2.4",
        .parameters =
            {{.name = "scale",
              .unit = "W/(m^2 sr)",
              .components = 3,
              .rgb = true,
              .preset = 1,
              .lower = 0,
              .meaning = "radiance of a picture value of one, of linear red, green and blue"},
             {.name = "rotation_rad",
              .unit = "rad",
              .preset = 0,
              .lower = -2 * pi,
              .upper = 2 * pi,
              .meaning = "turn about +z, counter-clockwise seen from above; at 0 the picture's centre looks along +x"}},
        .attachment = manifest::Attachment::picture,
        .attachment_meaning = "the picture, latitude-longitude",
        .takes_environment = true,
    };
    return info;
  }
  std::unique_ptr<Emitter> prepare(const manifest::Parameters& parameters, const Attachment& file,
                                   const std::string& place) const override {
    const auto values = manifest::values_of(info(), parameters, place);
    return std::make_unique<LatLong>(EmittingPicture(file, values[scale_index], place), values[rotation_index].x);
  }
};

}  // namespace

const Model& lat_long() {
  static const LatLongModel model;
  return model;
}

}  // namespace gonio::light
