// A liquid crystal display that shows a picture: a rectangle whose pixels are patches of constant radiance, fading to
// the sides and polarized. The picture's columns run along x = up x direction (to the right for who looks at the
// screen), its top row lies up. Towards the emission angle theta
//   L = scale picture(x, y) cos(theta)^(exponent - 1).
// Pixels are drawn by their luminance, points in them uniformly: pdf = share / (pixel's area) d^2 / cos(theta). Photons
// leave along a lobe cos^exponent: flux = 2 pi L_axis (pixel's area) / (share (exponent + 1)).
//
// Polarization: the front sheet absorbs along an axis b in the screen's plane, perpendicular to the axis
// polarization_rad that it lets pass (from x towards up). What passes towards d is polarized along b x d, at right
// angles to both: the extraordinary wave is absorbed (Fainman & Shamir 1984, equation 4); across the screen that is the
// passing axis itself.
#include <algorithm>
#include <cmath>

#include "light/aimed.h"
#include "light/distribution.h"
#include "light/emitting_picture.h"
#include "light/panel.h"
#include "light/warp.h"

namespace gonio::light {
namespace {

enum : std::size_t {
  position_index,
  direction_index,
  up_index,
  width_index,
  height_index,
  scale_index,
  exponent_index,
  angle_index,
  degree_index
};

class Screen final : public Emitter {
 public:
  Screen(const Panel& panel, EmittingPicture picture, double exponent, double polarization_rad, double degree)
      : panel_(panel),
        picture_(std::move(picture)),
        cells_(weights(), picture_.columns()),
        exponent_(exponent),
        absorbs_(panel.frame.b * std::cos(polarization_rad) - panel.frame.t * std::sin(polarization_rad)),
        degree_(degree) {}

  Sample sample(Vec3 point_m, Vec2 u) const override {
    const Distribution2::Cell cell = cells_.draw(u);
    const Vec3 arm = place(cell) - point_m;
    const double square = dot(arm, arm), distance = std::sqrt(square), cosine = -dot(arm, panel_.frame.n) / distance;
    if (!(cosine > 1e-9)) return {};
    const double density = pdf(cell.column, cell.row, square, cosine);
    if (!(density > 0)) return {};
    const Rgb radiance = picture_.radiance(cell.column, cell.row) * fading(cosine);
    return {arm / distance, distance, radiance / density, density, false, true};
  }
  Hit hit(Vec3 origin_m, Vec3 direction) const override {
    const auto met = panel_.meet(origin_m, direction);
    if (!met) return {};
    const std::size_t x = index(met->x / panel_.width_m + 0.5, picture_.columns());
    const std::size_t y = index(0.5 - met->y / panel_.height_m, picture_.rows());
    return {met->distance_m, picture_.radiance(x, y) * fading(met->cosine),
            pdf(x, y, met->distance_m * met->distance_m, met->cosine)};
  }
  Emission emit(Vec2 u_position, Vec2 u_direction) const override {
    const Distribution2::Cell cell = cells_.draw(u_position);
    const double share = cells_.share(cell.row, cell.column);
    if (!(share > 0)) return {};
    return {place(cell), panel_.frame.to_world(on_lobe(u_direction, exponent_)),
            picture_.radiance(cell.column, cell.row) * (2 * pi * pixel_m2() / (share * (exponent_ + 1))), true};
  }
  std::optional<Polarization> polarization(Vec3 travel) const override {
    const Vec3 x = cross(absorbs_, travel);
    const double length = norm(x);
    if (degree_ == 0 || !(length > 1e-9)) return {};
    return Polarization{x / length, {{1, degree_, 0, 0}}};
  }

 private:
  static std::size_t index(double share, std::size_t count) {
    const double cell = std::clamp(share * static_cast<double>(count), 0.0, static_cast<double>(count - 1));
    return static_cast<std::size_t>(cell);
  }
  double pixel_m2() const {
    return panel_.area_m2() / (static_cast<double>(picture_.columns()) * static_cast<double>(picture_.rows()));
  }
  double fading(double cosine) const { return exponent_ == 1 ? 1 : std::pow(cosine, exponent_ - 1); }
  double pdf(std::size_t x, std::size_t y, double square, double cosine) const {
    return cells_.share(y, x) / pixel_m2() * square / cosine;
  }
  Vec3 place(const Distribution2::Cell& cell) const {
    const double right = (static_cast<double>(cell.column) + cell.inside.x) / static_cast<double>(picture_.columns());
    const double down = (static_cast<double>(cell.row) + cell.inside.y) / static_cast<double>(picture_.rows());
    return panel_.at((right - 0.5) * panel_.width_m, (0.5 - down) * panel_.height_m);
  }
  std::vector<double> weights() const {
    std::vector<double> all;
    for (std::size_t y = 0; y < picture_.rows(); ++y)
      for (std::size_t x = 0; x < picture_.columns(); ++x) all.push_back(picture_.importance(x, y));
    return all;
  }

  Panel panel_;
  EmittingPicture picture_;
  Distribution2 cells_;
  double exponent_;
  Vec3 absorbs_;  // b
  double degree_;
};

class ScreenModel final : public Model {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{
        .family = manifest::Family::light,
        .id = "screen",
        .sentence = "A liquid crystal display that shows a picture; its light is polarized.",
        .source = "Fainman & Shamir 1984 (sheet polarizer); Veach 1997, section 8.2.2.2 (sampling)",
        .parameters =
            {position_info("centre of the screen, in the world frame"),
             direction_info(),
             up_info(),
             {.name = "width_m", .unit = "m", .preset = {}, .lower = 1e-6, .meaning = "width of the picture"},
             {.name = "height_m", .unit = "m", .preset = {}, .lower = 1e-6, .meaning = "height of the picture"},
             {.name = "scale",
              .unit = "W/(m^2 sr)",
              .components = 3,
              .rgb = true,
              .preset = 1,
              .lower = 0,
              .meaning = "radiance on the axis of a picture value of one, of linear red, green and blue"},
             exponent_info(1),
             {.name = "polarization_rad",
              .unit = "rad",
              .preset = 0,
              .lower = -pi,
              .upper = pi,
              .meaning = "angle of the light's electric field on the axis, from the right towards `up` for who looks "
                         "at the screen"},
             {.name = "polarization_degree",
              .unit = "1",
              .preset = 1,
              .lower = 0,
              .upper = 1,
              .meaning = "degree of linear polarization; 0 is unpolarized"}},
        .attachment = manifest::Attachment::picture,
        .attachment_meaning = "the picture that the screen shows",
    };
    return info;
  }
  std::unique_ptr<Emitter> prepare(const manifest::Parameters& parameters, const Attachment& file,
                                   const std::string& place) const override {
    const auto v = manifest::values_of(info(), parameters, place);
    const Panel panel{v[position_index], lamp_frame(v[direction_index], v[up_index], place), v[width_index].x,
                      v[height_index].x};
    return std::make_unique<Screen>(panel, EmittingPicture(file, v[scale_index], place), v[exponent_index].x,
                                    v[angle_index].x, v[degree_index].x);
  }
};

}  // namespace

const Model& screen() {
  static const ScreenModel model;
  return model;
}

}  // namespace gonio::light
