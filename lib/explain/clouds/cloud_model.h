// What points should be off by: the forward model of the clouds problem. Private to clouds/.
#pragma once
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "explain/clouds/clouds_problem.h"
#include "explain/clouds/indirect_light.h"
#include "scan/told_place.h"

namespace gonio::explain {

// What a parameter moves. `device`: 0 the first camera, 1 the second device.
struct CloudRole {
  enum class Part {
    shape,
    pose,
    drift,
    lens,
    focal,
    principal,
    thermal,
    gamma,
    depth,
    along,
    albedo,
    spread,
    spot,
    exit_depth,
    scatter
  } part = Part::shape;
  std::size_t index = 0;  // shape, pose, drift: of its numbers; lens: term; principal: x or y; thermal: focal, x, y;
                          // along: cloud
  std::size_t device = 1;
  std::size_t group = static_cast<std::size_t>(-1);  // shape
  bool by_time = false;                              // drift, thermal: per second, else per kelvin
};

// A point, and what of the stated rig the prediction is linear about.
struct CloudRow {
  Vec2 pixel;                  // of the first camera
  Vec3 origin, direction;      // its ray as stated, rig frame
  Vec2 told;                   // pixel of the second device
  Vec2 along;                  // unit: where that goes as the point goes along the ray
  Vec2 expected;               // told by the shape where it was fitted
  double metre_per_px = 0;     // off the shape, per pixel along `along`
  double sigma_m = 0;          // along the normal, as the cloud states
  double px_per_metre = 0;     // of `along`, by the point's way along the ray
  std::array<Vec2, 2> across;  // of the second device, by a pixel of the first along its x and its y
  Vec3 normal;                 // of the shape there, towards the first camera
  // Along the shape, of a projector: derivatives of log irradiance, 1/m, and of the pixels that it lights with, px/m,
  // px/m^2 (xx, xy, yy). Not known: all zero.
  Vec2 lit;
  std::array<Vec2, 2> told_slope;
  std::array<std::array<double, 3>, 2> told_bend{};
  const equation::Neighbours* bright = nullptr;  // none: not known
  Vec2 slope;                                    // of the logarithm of brightness, per pixel of the first camera
  double incidence_rad = 0, depth_m = 0;
  std::size_t point = 0;
};

class CloudModel {
 public:
  explicit CloudModel(const CloudsInput& input);
  const CloudsInput& input() const { return input_; }
  // Of the views; what they are held against has rows of its own beside them.
  const std::vector<CloudRow>& rows(std::size_t group) const { return sides_[0][group].rows; }
  const IndirectLight& indirect(std::size_t group) const { return sides_[0][group].indirect; }
  // How far a point lies off the shape, or off what the other cloud saw, metres along the normal, behind it positive.
  double value_m(std::size_t group, std::size_t row) const;
  // Of a row's value: its own noise and that of what it is held against.
  double sigma_m(std::size_t group, std::size_t row) const;
  const scan::ToldPlace& told_place(scan::Axis axis) const { return told_[static_cast<std::size_t>(axis)]; }
  // Which axis' pixel says most of where the points lie.
  scan::Axis telling() const { return telling_; }

  // Metres along the normal, row by row.
  void predict(std::span<const CloudRole> roles, std::span<const double> values, std::size_t group,
               std::span<double> prediction) const;

 private:
  struct State;
  struct Side {
    const CloudView* view = nullptr;
    std::vector<CloudRow> rows;
    IndirectLight indirect;
  };
  State state_of(std::span<const CloudRole> roles, std::span<const double> values, std::size_t side,
                 std::size_t group) const;
  std::array<Vec2, 2> across(const CloudShape& shape, const CloudRow& row) const;
  void differentiate(const CloudShape& shape, CloudRow& row) const;
  void add_group(std::size_t group);
  void light_themselves();
  std::optional<CloudRow> row_of(const CloudView& view, std::size_t point) const;
  std::optional<Vec2> pixel_told(const State& state, const Side& side, std::size_t row) const;
  double turned_px(const State& state, const Side& side, std::size_t row, std::size_t axis) const;
  static double covered(const CloudRow& row, std::size_t axis);
  double rad_per_px(std::size_t axis, double periods) const;
  double scattered(const CloudRow& row, std::size_t axis, double periods, double spread_m) const;
  Vec2 phase_slope(const CloudRow& row, std::size_t axis, double periods) const;

  const CloudsInput& input_;
  std::array<scan::ToldPlace, 2> told_;
  std::array<std::vector<Side>, 2> sides_;  // views, and what they are held against
  scan::Axis telling_ = scan::Axis::column;
};

}  // namespace gonio::explain
