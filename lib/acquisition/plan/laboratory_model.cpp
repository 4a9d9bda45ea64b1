// See laboratory_model.h. An arm's nodes stand on the axes of its joints, at their points nearest to the base: the
// frames of a calibrated arm lie hundreds of metres away (robot/ur_calibration.h), and what reads the model reads
// single precision. With q the joints' angles, frame i of Denavit and Hartenberg is base_from_axis_1 Rz(q_1)
// axis_1_from_axis_2 Rz(q_2) ... axis_i_from_frame_i, whose factors between the turns are those of the arm with all
// joints at zero: frame i - 1 there, moved along its z, is axis i.
#include "acquisition/plan/laboratory_model.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "acquisition/plan/drawn_shapes.h"
#include "camera/camera_model.h"
#include "manifest/document.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/laboratory.h"
#include "manifest/sections/light.h"

namespace gonio::acquisition {
namespace {

using Placement = Rigid<frame::Object, frame::Object>;

constexpr double sight_m = 0.15, frame_rod_m = 0.004, lamp_radius_m = 0.018, dial_m = 0.1;
constexpr double usual_half_width = 0.4, usual_half_height = 0.3;  // of a picture at 1 m, where no lens is described

const std::vector<std::array<float, 3>> palette{
    {0.74f, 0.76f, 0.78f},                                                                       // surroundings
    {0.46f, 0.62f, 0.78f}, {0.85f, 0.63f, 0.42f}, {0.55f, 0.74f, 0.60f}, {0.76f, 0.60f, 0.74f},  // arms
    {0.38f, 0.41f, 0.45f},                                                                       // carried
    {0.00f, 0.36f, 0.60f},                                                                       // cameras
    {0.55f, 0.51f, 0.38f}, {1.00f, 0.83f, 0.10f},                                                // lamps
    {0.36f, 0.30f, 0.52f},                                                                       // turntables
    {0.24f, 0.35f, 0.45f},                                                                       // screens
    {0.34f, 0.71f, 0.91f}, {0.00f, 0.48f, 0.34f}, {0.84f, 0.37f, 0.00f}};                        // views

template <class To, class From>
Placement placement(const Rigid<To, From>& pose) {
  return {pose.rotation, pose.translation_m};
}

class Builder {
 public:
  Builder(const manifest::Document& document, const Laboratory& laboratory)
      : document_(document), laboratory_(laboratory), section_(document.laboratory.entry.front()) {
    model().palette = palette;
  }

  LaboratoryModel build() {
    int number = 0;
    for (const auto& [name, arm] : laboratory_.arms) add_arm(arm, number++);
    for (const Solid& solid : laboratory_.obstacles)
      out_.solids.push_back(add({.name = solid.name,
                                 .placed = placement(solid.placed),
                                 .mesh = shape_of(solid),
                                 .colour = static_cast<int>(Tint::surroundings),
                                 .surroundings = true}));
    for (const auto& [name, camera] : section_.cameras) add_camera(name, camera);
    for (const auto& [name, lamp] : section_.lamps) add_lamp(name, lamp);
    for (const auto& [name, table] : section_.turntables) add_turntable(name, table);
    for (const auto& [name, screen] : section_.screens) add_screen(name, screen);
    name_obstacles();
    model().keys = {{0, hinge_angles(document_, laboratory_, {}, {})}};
    return std::move(out_);
  }

 private:
  io::MovingModel& model() { return out_.model; }
  int add(io::ModelNode node) {
    model().nodes.push_back(std::move(node));
    return static_cast<int>(model().nodes.size()) - 1;
  }
  int add_mesh(io::TriangleMesh mesh) {
    model().meshes.push_back(std::move(mesh));
    return static_cast<int>(model().meshes.size()) - 1;
  }
  // Arms of one model have the same solids: their shapes are kept once.
  int shape_of(const Solid& solid) {
    if (solid.shape == Solid::Shape::mesh) return add_mesh(drawn_solid(solid));
    const std::tuple key{solid.shape, solid.sides_m.x, solid.sides_m.y, solid.sides_m.z};
    const auto [at, is_new] = known_.try_emplace(key, -1);
    if (is_new) at->second = add_mesh(drawn_solid(solid));
    return at->second;
  }

  void add_arm(const LaboratoryArm& arm, int number) {
    const std::vector<double> zeros(arm.links.size(), 0.0);
    std::vector<Placement> frames;  // of Denavit and Hartenberg, all joints at zero
    for (const robot::LinkFrame& f : robot::link_frames(arm.links, zeros))
      frames.push_back({quaternion_of(f.rotation), f.origin_m});
    int above = add({.name = arm.name, .placed = placement(arm.world_from_base), .label = arm.name});
    std::vector<int> nodes{above};
    std::vector<Placement> axes{Placement{}};
    for (std::size_t i = 0; i < arm.links.size(); ++i) {
      Placement axis = frames[i];
      const Vec3 along = axis.rotate({0, 0, 1});
      axis.translation_m = axis.translation_m - along * dot(along, axis.translation_m);
      above = add({.name = arm.name + "/joint-" + std::to_string(i + 1),
                   .parent = above,
                   .placed = inverse(axes.back()) * axis,
                   .hinge = hinges_++});
      nodes.push_back(above), axes.push_back(axis);
    }
    for (const Solid& solid : arm.solids) {
      const auto link = static_cast<std::size_t>(solid.link);
      const int colour =
          solid.carried ? static_cast<int>(Tint::carried) : static_cast<int>(Tint::first_arm) + number % 4;
      out_.solids.push_back(add({.name = solid.name,
                                 .parent = nodes[link],
                                 .placed = inverse(axes[link]) * frames[link] * placement(solid.placed),
                                 .mesh = shape_of(solid),
                                 .colour = colour}));
    }
    tools_[arm.name] = add({.name = arm.name + "/tool",
                            .parent = above,
                            .placed = inverse(axes.back()) * frames.back() * placement(arm.last_from_tool)});
  }

  io::ModelLens lens_of(const std::string& name) const {
    const std::vector<Vec3> c = picture_corners(document_, name, 1);
    io::ModelLens lens;
    lens.aspect = norm(c[1] - c[0]) / norm(c[2] - c[1]);
    lens.half_height_m = norm(c[2] - c[1]) / 2;
    lens.yfov_rad = 2 * std::atan(lens.half_height_m);
    const auto section = document_.cameras.find(name);
    lens.orthographic = section != document_.cameras.end() && section->second.model == "orthographic";
    return lens;
  }

  void add_camera(const std::string& name, const manifest::LaboratoryCamera& camera) {
    io::ModelNode node{.name = name, .colour = static_cast<int>(Tint::camera), .label = name};
    if (!camera.robot.empty()) {
      const auto held = tool_from_camera(document_, name);
      if (!held || !tools_.contains(camera.robot)) return;
      node.parent = tools_.at(camera.robot), node.placed = placement(*held);
    } else {
      if (!camera.world_from_camera) return;
      node.placed = placement(*camera.world_from_camera);
    }
    node.lens = lens_of(name);
    node.mesh = add_mesh(pyramid_frame(picture_corners(document_, name, sight_m), frame_rod_m));
    out_.cameras[name] = add(std::move(node));
  }

  void add_lamp(const std::string& name, const manifest::LaboratoryLamp& lamp) {
    io::ModelNode node{.name = name, .colour = static_cast<int>(Tint::lamp), .label = name};
    const auto light = document_.lights.find(lamp.light.empty() ? name : lamp.light);
    if (!lamp.robot.empty()) {
      if (lamp.in_tool_m.size() != 3 || !tools_.contains(lamp.robot)) return;
      node.parent = tools_.at(lamp.robot);
      node.placed.translation_m = {lamp.in_tool_m[0], lamp.in_tool_m[1], lamp.in_tool_m[2]};
    } else {
      const bool lit_from_somewhere =
          light != document_.lights.end() && light->second.parameters.contains("position_m");
      if (lamp.in_world_m.empty() && !lit_from_somewhere) return;
      node.placed.translation_m = lamp_position(document_, laboratory_, name, {});
    }
    node.watt_per_sr = Vec3{1, 1, 1};
    if (light != document_.lights.end())
      if (const auto at = light->second.parameters.find("watt_per_sr"); at != light->second.parameters.end())
        node.watt_per_sr = at->second.vector();
    if (lamp_ball_ < 0) lamp_ball_ = add_mesh(ball_mesh(lamp_radius_m));
    node.mesh = lamp_ball_;
    out_.lamps[name] = add(std::move(node));
  }

  void add_turntable(const std::string& name, const manifest::LaboratoryTurntable& table) {
    io::ModelNode node{.name = name, .colour = static_cast<int>(Tint::turntable), .label = name};
    if (table.world_from_table) node.placed = placement(*table.world_from_table);
    node.hinge = hinges_++;
    node.mesh = add_mesh(dial(dial_m, frame_rod_m));
    out_.turntables[name] = add(std::move(node));
  }

  // A panel whose front is its frame's z = 0; a projector as a pyramid of light.
  void add_screen(const std::string& name, const manifest::LaboratoryScreen& screen) {
    if (!screen.world_from_screen) return;
    io::ModelNode node{.name = name,
                       .placed = placement(*screen.world_from_screen),
                       .colour = static_cast<int>(Tint::screen),
                       .label = name};
    const double pixel = screen.pixel_m.value_or(0.3 / static_cast<double>(screen.width_px));
    const double w = pixel * static_cast<double>(screen.width_px) / 2,
                 h = pixel * static_cast<double>(screen.height_px) / 2;
    if (screen.kind == "projector") {
      const double depth = 2 * w;
      node.mesh =
          add_mesh(pyramid_frame({{-w, -h, depth}, {w, -h, depth}, {w, h, depth}, {-w, h, depth}}, frame_rod_m));
    } else {
      io::TriangleMesh panel;
      for (const double z : {-0.01, 0.0})
        panel.positions_m.insert(panel.positions_m.end(), {{-w, -h, z}, {w, -h, z}, {w, h, z}, {-w, h, z}});
      panel.triangles = {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}, {0, 1, 5}, {0, 5, 4},
                         {1, 2, 6}, {1, 6, 5}, {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};
      node.mesh = add_mesh(std::move(panel));
    }
    out_.screens[name] = add(std::move(node));
  }

  // An obstacle of a lamp's or screen's name stands for it: one name is enough.
  void name_obstacles() {
    for (std::size_t k = out_.solids.size() - laboratory_.obstacles.size(); k < out_.solids.size(); ++k) {
      io::ModelNode& node = model().nodes[static_cast<std::size_t>(out_.solids[k])];
      const std::string& name = node.name;
      if (!out_.lamps.contains(name) && !out_.screens.contains(name) && !out_.turntables.contains(name) &&
          !out_.cameras.contains(name))
        node.label = name;
    }
  }

  const manifest::Document& document_;
  const Laboratory& laboratory_;
  const manifest::Laboratory& section_;
  LaboratoryModel out_;
  int hinges_ = 0, lamp_ball_ = -1;
  std::map<std::string, int> tools_;
  std::map<std::tuple<Solid::Shape, double, double, double>, int> known_;
};

}  // namespace

LaboratoryModel laboratory_model(const manifest::Document& document, const Laboratory& laboratory) {
  return Builder(document, laboratory).build();
}

std::vector<double> hinge_angles(const manifest::Document& document, const Laboratory& laboratory, const State& state,
                                 const std::map<std::string, double>& turntables) {
  std::vector<double> angles;
  for (const auto& [name, arm] : laboratory.arms) {
    const Joints& joints = joints_of(arm, state);
    angles.insert(angles.end(), joints.begin(), joints.end());
  }
  for (const auto& [name, table] : document.laboratory.entry.front().turntables) {
    const auto at = turntables.find(name);
    angles.push_back(at == turntables.end() ? 0.0 : at->second);
  }
  return angles;
}

std::vector<Vec3> picture_corners(const manifest::Document& document, const std::string& camera, double depth_m) {
  const auto section = document.cameras.find(camera);
  std::vector<Vec3> corners;
  if (section == document.cameras.end()) {
    const double w = usual_half_width * depth_m, h = usual_half_height * depth_m;
    return {{-w, -h, depth_m}, {w, -h, depth_m}, {w, h, depth_m}, {-w, h, depth_m}};
  }
  const camera::CameraModel model(section->second, manifest::place(document, "/cameras/" + camera));
  const double right = model.width_px() - 0.5, down = model.height_px() - 0.5;
  for (const Vec2 pixel : {Vec2{-0.5, -0.5}, Vec2{right, -0.5}, Vec2{right, down}, Vec2{-0.5, down}}) {
    const camera::Ray ray = model.ray(pixel);
    // A fisheye's corners may look backwards: they are drawn at that distance.
    const double length = depth_m / std::max(ray.direction.z, 0.2);
    corners.push_back(ray.origin_m + ray.direction * length);
  }
  return corners;
}

report::MeshView view_of(io::MovingModel model) {
  report::MeshView view;
  view.name = "the laboratory";
  // From the front, a little from the right and from above.
  view.turn = {0.829038, 0.559193, 0, -0.231894, 0.343796, 0.909961, 0.508844, -0.754392, 0.414693};
  view.moving = std::move(model);
  return view;
}

}  // namespace gonio::acquisition
