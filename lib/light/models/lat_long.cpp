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

#include "base/error.h"
#include "light/distribution.h"
#include "light/light.h"

namespace gonio::light {
namespace {

enum : std::size_t { scale_index, rotation_index };

class LatLong final : public Emitter {
 public:
  LatLong(std::shared_ptr<const io::Image> picture, Rgb scale, double rotation_rad)
      : picture_(std::move(picture)), scale_(scale), rotation_rad_(rotation_rad), rows_(row_weights()) {}

  Sample sample(Vec3, Vec2 u) const override {
    const std::size_t y = rows_.draw(u.x), x = columns_[y].draw(u.y);
    const double top = edge_cosine(y), bottom = edge_cosine(y + 1);
    const double z = top + (bottom - top) * u.x, r = std::sqrt(std::max(0.0, 1 - z * z));
    const double phi = rotation_rad_ + pi - 2 * pi * (static_cast<double>(x) + u.y) / width();
    const double density = pdf(x, y);
    if (!(density > 0)) return {};
    return {{r * std::cos(phi), r * std::sin(phi), z},
            std::numeric_limits<double>::infinity(),
            radiance(x, y) / density,
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
    return {std::numeric_limits<double>::infinity(), radiance(x, y), pdf(x, y)};
  }
  bool infinite() const override { return true; }

 private:
  std::size_t columns() const { return static_cast<std::size_t>(picture_->width); }
  std::size_t rows() const { return static_cast<std::size_t>(picture_->height); }
  double width() const { return picture_->width; }
  double height() const { return picture_->height; }
  double edge_cosine(std::size_t row) const { return std::cos(pi * static_cast<double>(row) / height()); }
  double solid_angle(std::size_t row) const { return 2 * pi / width() * (edge_cosine(row) - edge_cosine(row + 1)); }
  double pdf(std::size_t x, std::size_t y) const { return rows_.share(y) * columns_[y].share(x) / solid_angle(y); }

  Rgb radiance(std::size_t x, std::size_t y) const {
    const std::size_t channels = picture_->channels.size();
    const float* pixel = picture_->data.data() + (y * columns() + x) * channels;
    return channels >= 3 ? Rgb{pixel[0], pixel[1], pixel[2]} * scale_ : scale_ * double{pixel[0]};
  }
  double importance(std::size_t x, std::size_t y) const {  // Rec. 709 luminance
    const Rgb value = radiance(x, y);
    const double luminance = 0.2126 * value.x + 0.7152 * value.y + 0.0722 * value.z;
    return luminance > 0 ? luminance : mean(value);
  }
  std::vector<double> row_weights() {
    std::vector<double> weights(rows()), row(columns());
    columns_.reserve(rows());
    for (std::size_t y = 0; y < rows(); ++y) {
      for (std::size_t x = 0; x < columns(); ++x) row[x] = importance(x, y);
      columns_.emplace_back(row);
      weights[y] = columns_.back().total * solid_angle(y);
    }
    return weights;
  }

  std::shared_ptr<const io::Image> picture_;
  Rgb scale_;
  double rotation_rad_;
  std::vector<Distribution> columns_;
  Distribution rows_;
};

void check(const io::Image* picture, const std::string& place) {
  if (!picture)
    throw Error(Exit::data, place, "environment without a picture", "name a latitude-longitude picture as \"file\"");
  const auto& names = picture->channels;
  const bool rgb = names.size() >= 3 && names[0] == "R" && names[1] == "G" && names[2] == "B";
  if (picture->pixels() == 0 || !(rgb || names.size() == 1))
    throw Error(Exit::data, place + "/file", "picture without channels R, G, B or Y", "convert it to linear RGB");
  for (const float v : picture->data)
    if (!(v >= 0) || !std::isfinite(v))
      throw Error(Exit::data, place + "/file", "radiance is negative or not finite", "repair the picture");
}

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
    };
    return info;
  }
  std::unique_ptr<Emitter> prepare(const manifest::Parameters& parameters, const Attachment& file,
                                   const std::string& place) const override {
    check(file.picture.get(), place);
    const auto values = manifest::values_of(info(), parameters, place);
    return std::make_unique<LatLong>(file.picture, values[scale_index], values[rotation_index].x);
  }
};

}  // namespace

const Model& lat_long() {
  static const LatLongModel model;
  return model;
}

}  // namespace gonio::light
