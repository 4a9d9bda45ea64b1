// See outline_model.h.
#include "explain/outlines/outline_model.h"

#include <cmath>

#include "scene/mechanisms/bend.h"

namespace gonio::explain {

using alignment::Setting;
using Part = OutlineRole::Part;
using Form = OutlineRole::Form;

struct OutlineModel::Moved {
  Setting setting;
  std::vector<std::array<double, 3>> bend;  // of bodies
  std::vector<double> offset_m;
  std::array<double, 3> ground{};
  std::vector<double> radius_m, blur_px;  // of lamps, of lenses
};

namespace {

double in_freedom(Form form, double value) {
  if (form == Form::shrinks) return std::log1p(-value);
  return form == Form::grows ? std::log1p(value) : value;
}

// The plane that stands for a ground which is bent, where it is met: higher by what it is there.
alignment::Projected shadow_on(const Setting& setting, const alignment::RimSubject& subject, Vec3 world,
                               const std::array<double, 3>& bend, const Rigid<frame::World, frame::Object>& plane) {
  alignment::Projected p = alignment::project_shadow(setting, subject.station, *subject.lamp, world);
  if (bend == std::array<double, 3>{}) return p;
  Setting here = setting;
  const Vec3 lamp = setting.lamps_m[*subject.lamp];
  for (int round = 0; round < 2; ++round) {
    const double a = here.ground->height_m(lamp), b = here.ground->height_m(world);
    const Vec3 at = inverse(plane) * ((world * a - lamp * b) / (a - b));
    here.ground->offset_m = setting.ground->offset_m + equation::bend_height_m(at.x, at.y, bend);
  }
  return alignment::project_shadow(here, subject.station, *subject.lamp, world);
}

}  // namespace

Setting OutlineModel::setting(std::span<const double> values) const {
  std::vector<double> change(alignment::numbers_of(freedoms), 0.0);
  std::vector<std::size_t> first;
  std::size_t count = 0;
  for (const alignment::Freedom& f : freedoms) first.push_back(count), count += f.size();
  for (std::size_t p = 0; p < roles.size(); ++p)
    if (roles[p].part == Part::freedom)
      change[first[roles[p].freedom] + roles[p].index] += in_freedom(roles[p].form, values[p]);
  return alignment::moved(input_.in.stated, freedoms, change);
}

double OutlineModel::offset_px(const Moved& moved, const OutlineView& view, const OutlineRow& row) const {
  const std::size_t body = view.subject.body;
  const alignment::Body& b = moved.setting.bodies[body];
  const Vec3 point = equation::bent(row.mesh_point, b.shape->centre_m(), moved.bend[body]);
  const Vec3 world = b.place_m(point) + row.outside * moved.offset_m[body];
  const alignment::Projected p =
      view.subject.lamp ? shadow_on(moved.setting, view.subject, world, moved.ground, input_.in.world_from_ground)
                        : alignment::project(moved.setting, view.subject.station, world);
  double offset = dot(p.pixel - row.pixel, row.outward);
  if (view.subject.lamp) offset += row.penumbra * std::pow(moved.radius_m[*view.subject.lamp], 2);
  return offset;
}

void OutlineModel::predict(std::span<const double> values, std::size_t group, std::span<double> prediction) const {
  double mask_px = 0;
  Moved m{setting(values), {}, {}, {}, input_.radii_m, input_.blur_px};
  m.bend.resize(m.setting.bodies.size()), m.offset_m.resize(m.setting.bodies.size(), 0.0);
  for (std::size_t p = 0; p < roles.size(); ++p) {
    const OutlineRole& r = roles[p];
    if (r.part == Part::bend) m.bend[r.which][r.index] = values[p];
    if (r.part == Part::offset) m.offset_m[r.which] = values[p];
    if (r.part == Part::ground) m.ground[r.index] = values[p];
    if (r.part == Part::radius) m.radius_m[r.which] = values[p];
    if (r.part == Part::blur) m.blur_px[r.which] = values[p];
    if (r.part == Part::mask && r.which == group) mask_px = values[p];
  }
  const OutlineView& view = input_.views[group];
  const double blur = m.blur_px[m.setting.stations[view.subject.station].lens];
  for (std::size_t i = 0; i < view.rows.size(); ++i) {
    const OutlineRow& row = view.rows[i];
    const double radius = view.subject.lamp ? m.radius_m[*view.subject.lamp] : 0;
    prediction[i] =
        row.width ? std::sqrt(blur * blur + row.lever * radius * radius / 4) : mask_px + offset_px(m, view, row);
  }
}

}  // namespace gonio::explain
