// A projector of pictures: a small lens, or a disc of radius_m, before a picture that is a pinhole camera's turned
// round. In its own frame x lies to the right, y down, z along `direction`, as a camera in its place would see the
// scene: the rig's entry of a projector is this light with direction = R (0, 0, 1) and up = R (0, -1, 0). Pixel (u, v),
// centres at integers, shines along
//   ((u - cx_px) / fx_px, (v - cy_px) / fy_px, 1),    I = watt_per_sr shown^gamma,
// bilinear in light between the centres, as a lens blurs that resolves no better than its pixels; constant over the
// outer half of those at the border, and dark beyond.
//
// With a radius every place a = (a_x, a_y, 0) of the disc sends the picture through the plane z = focus_m, where all of
// them agree: towards d it shows the pixel at f (a / focus_m + d / d_z) + c, as bright as light/aimed.h has a disc of
// this intensity. Out of focus a pixel is a disc of f radius_m |1 / focus_m - 1 / z| px.
//
// Photons: pixels by their light within the solid angle cos^3 / (fx fy), places in them uniformly.
#include <algorithm>
#include <cmath>

#include "geom/luminance.h"
#include "light/aimed.h"
#include "light/distribution.h"
#include "light/emitting_picture.h"
#include "light/warp.h"

namespace gonio::light {
namespace {

enum : std::size_t {
  position_index,
  direction_index,
  up_index,
  fx_index,
  fy_index,
  cx_index,
  cy_index,
  intensity_index,
  gamma_index,
  radius_index,
  focus_index
};

// What the picture makes of the light, bilinear between the pixels' centres.
class ShownLight {
 public:
  ShownLight(const EmittingPicture& picture, double gamma) : columns_(picture.columns()), rows_(picture.rows()) {
    light_.reserve(columns_ * rows_);
    for (std::size_t y = 0; y < rows_; ++y)
      for (std::size_t x = 0; x < columns_; ++x) {
        const Rgb shown = picture.radiance(x, y);
        light_.push_back(
            gamma == 1 ? shown : Rgb{std::pow(shown.x, gamma), std::pow(shown.y, gamma), std::pow(shown.z, gamma)});
      }
  }
  std::size_t columns() const { return columns_; }
  std::size_t rows() const { return rows_; }
  Rgb at(Vec2 pixel) const {
    if (!(std::abs(pixel.x + 0.5 - 0.5 * width()) <= 0.5 * width() &&
          std::abs(pixel.y + 0.5 - 0.5 * height()) <= 0.5 * height()))
      return {};
    const double x = std::clamp(pixel.x, 0.0, width() - 1), y = std::clamp(pixel.y, 0.0, height() - 1);
    const auto column = static_cast<std::size_t>(x), row = static_cast<std::size_t>(y);
    const double right = x - static_cast<double>(column), down = y - static_cast<double>(row);
    const std::size_t beside = std::min(column + 1, columns_ - 1), below = std::min(row + 1, rows_ - 1);
    return (of(column, row) * (1 - right) + of(beside, row) * right) * (1 - down) +
           (of(column, below) * (1 - right) + of(beside, below) * right) * down;
  }
  // Luminance over the square of a pixel: the mean of the above.
  double over(std::size_t column, std::size_t row) const {
    Rgb sum;
    for (int j = -1; j <= 1; ++j)
      for (int i = -1; i <= 1; ++i) {
        const std::size_t x = beside(column, i, columns_), y = beside(row, j, rows_);
        sum += of(x, y) * ((i == 0 ? 0.75 : 0.125) * (j == 0 ? 0.75 : 0.125));
      }
    return luminance_of(sum);
  }

 private:
  static std::size_t beside(std::size_t at, int step, std::size_t count) {
    if (step < 0) return at > 0 ? at - 1 : 0;
    return std::min(at + static_cast<std::size_t>(step), count - 1);
  }
  double width() const { return static_cast<double>(columns_); }
  double height() const { return static_cast<double>(rows_); }
  const Rgb& of(std::size_t x, std::size_t y) const { return light_[y * columns_ + x]; }

  std::size_t columns_, rows_;
  std::vector<Rgb> light_;
};

struct Lens {
  Vec3 position_m;
  Basis frame;  // right, down, forward
  Vec2 f_px, c_px;
  double radius_m = 0, focus_m = 1;

  // `on_lens`: place on the disc; `local`: direction, of any length.
  Vec2 pixel(Vec2 on_lens, Vec3 local) const {
    return {f_px.x * (on_lens.x / focus_m + local.x / local.z) + c_px.x,
            f_px.y * (on_lens.y / focus_m + local.y / local.z) + c_px.y};
  }
  Vec3 direction(Vec2 on_lens, Vec2 pixel) const {
    return normalized(
        Vec3{(pixel.x - c_px.x) / f_px.x - on_lens.x / focus_m, (pixel.y - c_px.y) / f_px.y - on_lens.y / focus_m, 1});
  }
  Vec3 place(Vec2 on_lens) const { return position_m + frame.t * on_lens.x + frame.b * on_lens.y; }
};

class Projector final : public Emitter {
 public:
  Projector(const Lens& lens, Rgb watt_per_sr, ShownLight light)
      : lens_(lens),
        watt_per_sr_(watt_per_sr),
        area_m2_(pi * lens.radius_m * lens.radius_m),
        light_(std::move(light)),
        cells_(weights(), light_.columns()) {}

  Sample sample(Vec3 point_m, Vec2 u) const override {
    const bool delta = !(lens_.radius_m > 0);
    const Vec2 on_lens = delta ? Vec2{} : on_disc(u) * lens_.radius_m;
    const Vec3 arm = lens_.place(on_lens) - point_m;
    const double square = dot(arm, arm), distance = std::sqrt(square), cosine = -dot(arm, lens_.frame.n) / distance;
    if (!(cosine > least_cosine)) return {};
    const Rgb intensity = towards(on_lens, lens_.frame.to_local(-arm));
    if (delta) {
      if (intensity == Rgb{}) return {};
      return {arm / distance, distance, intensity / square, 0, true, true};
    }
    return {arm / distance, distance, intensity / square, square / (area_m2_ * cosine), false, true};
  }

  Hit hit(Vec3 origin_m, Vec3 direction) const override {
    const double cosine = -dot(direction, lens_.frame.n);
    if (!(lens_.radius_m > 0 && cosine > least_cosine)) return {};
    const double distance = dot(origin_m - lens_.position_m, lens_.frame.n) / cosine;
    const Vec3 across = lens_.frame.to_local(origin_m + direction * distance - lens_.position_m);
    const Vec2 on_lens{across.x, across.y};
    if (!(distance > 0) || dot(on_lens, on_lens) > lens_.radius_m * lens_.radius_m) return {};
    return {distance, towards(on_lens, lens_.frame.to_local(-direction)) / (area_m2_ * cosine),
            distance * distance / (area_m2_ * cosine)};
  }

  Emission emit(Vec2 u_position, Vec2 u_direction) const override {
    const Distribution2::Cell cell = cells_.draw(u_direction);
    const double share = cells_.share(cell.row, cell.column);
    if (!(share > 0) || !(cells_.total() > 0)) return {};
    const Vec2 pixel{static_cast<double>(cell.column) + cell.inside.x - 0.5,
                     static_cast<double>(cell.row) + cell.inside.y - 0.5};
    const Vec2 on_lens = on_disc(u_position) * lens_.radius_m;
    const Vec3 local = lens_.direction(on_lens, pixel);
    return {lens_.place(on_lens), lens_.frame.to_world(local),
            watt_per_sr_ * light_.at(pixel) * (solid_angle(local.z) / share), true};
  }

 private:
  static constexpr double least_cosine = 1e-9;  // directions nearer to the lens' plane miss it
  Rgb towards(Vec2 on_lens, Vec3 local) const { return watt_per_sr_ * light_.at(lens_.pixel(on_lens, local)); }
  double solid_angle(double cosine) const {  // of a pixel
    return cosine * cosine * cosine / (lens_.f_px.x * lens_.f_px.y);
  }
  std::vector<double> weights() const {
    std::vector<double> all;
    all.reserve(light_.columns() * light_.rows());
    for (std::size_t y = 0; y < light_.rows(); ++y)
      for (std::size_t x = 0; x < light_.columns(); ++x) {
        const Vec3 axis = lens_.direction({}, {static_cast<double>(x), static_cast<double>(y)});
        all.push_back(light_.over(x, y) * solid_angle(axis.z));
      }
    return all;
  }

  Lens lens_;
  Rgb watt_per_sr_;
  double area_m2_;
  ShownLight light_;
  Distribution2 cells_;
};

manifest::ParameterInfo focal_info(const char* name, const char* meaning) {
  return {.name = name, .unit = "px", .preset = {}, .lower = 1, .meaning = meaning};
}
manifest::ParameterInfo centre_info(const char* name, const char* meaning) {
  return {.name = name, .unit = "px", .preset = {}, .meaning = meaning};
}

class ProjectorModel final : public Model {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{
        .family = manifest::Family::light,
        .id = "projector",
        .sentence =
            "A projector: each pixel of its picture shines along the ray that a pinhole camera in its place "
            "would see it on. The picture's columns run to the right along direction x up, its top row lies "
            "up.",
        .source =
            "Zhang & Huang 2006 (a projector as an inverse camera); Kolb, Mitchell & Hanrahan 1995, section 3.1 "
            "(thin lens)",
        .parameters = {position_info("the lens, in the world frame"),
                       direction_info(),
                       up_info(),
                       focal_info("fx_px", "focal length over the width of a pixel"),
                       focal_info("fy_px", "focal length over the height of a pixel"),
                       centre_info("cx_px", "column of the picture on the axis; 0 is the centre of the leftmost pixel"),
                       centre_info("cy_px", "row of the picture on the axis; 0 is the centre of the topmost pixel"),
                       intensity_info("radiant intensity of a picture value of one, of red, green and blue; the same "
                                      "in all directions"),
                       {.name = "gamma",
                        .unit = "1",
                        .preset = 1,
                        .lower = 0.1,
                        .meaning = "exponent of the light over the picture's value, which is what is sent to the "
                                   "projector"},
                       {.name = "radius_m",
                        .unit = "m",
                        .preset = 0,
                        .lower = 0,
                        .meaning = "radius of the lens' opening, which blurs what is out of focus; 0 is a point"},
                       {.name = "focus_m",
                        .unit = "m",
                        .preset = 1,
                        .lower = 1e-3,
                        .meaning = "distance along the axis at which the picture is sharp; without effect at radius_m "
                                   "0"}},
        .attachment = manifest::Attachment::picture,
        .attachment_meaning = "the picture that is sent to it, 1 the largest value that a file of whole numbers holds",
        .attachment_as_sent = true,
    };
    return info;
  }
  std::unique_ptr<Emitter> prepare(const manifest::Parameters& parameters, const Attachment& file,
                                   const std::string& place) const override {
    const auto v = manifest::values_of(info(), parameters, place);
    const Basis lamp = lamp_frame(v[direction_index], v[up_index], place);  // x to the left of who looks along it
    const Lens lens{
        v[position_index], Basis(lamp.n, -lamp.t), {v[fx_index].x, v[fy_index].x}, {v[cx_index].x, v[cy_index].x},
        v[radius_index].x, v[focus_index].x};
    return std::make_unique<Projector>(lens, v[intensity_index],
                                       ShownLight(EmittingPicture(file, {1, 1, 1}, place), v[gamma_index].x));
  }
};

}  // namespace

const Model& projector() {
  static const ProjectorModel model;
  return model;
}

}  // namespace gonio::light
