// A plan as glTF: what the specification demands of an animated file, and that what another program shows at any time
// is where the bodies of the plan are. Read here by the specification alone (Khronos Group, glTF 2.0, 2021;
// sections 3.6, 3.11, 4.4, appendix C).
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>

#include "acquisition/laboratories.h"
#include "acquisition/motion/body.h"
#include "acquisition/plan/plan_model.h"
#include "acquisition/plan/planner.h"
#include "acquisition/plan/view_steps.h"
#include "base/random.h"
#include "geom/angle.h"
#include "manifest/value.h"
#include "scene/exchange/moving_gltf.h"

namespace gonio::acquisition {
namespace {

using manifest::Value;

std::uint32_t word(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, 4);
  return value;
}

struct Glb {
  explicit Glb(const std::string& file) {
    EXPECT_EQ(file.substr(0, 4), "glTF");
    EXPECT_EQ(word(file, 4), 2U);
    EXPECT_EQ(word(file, 8), file.size());
    const std::size_t length = word(file, 12), next = 20 + length;
    EXPECT_EQ(length % 4, 0U);
    EXPECT_EQ(file.substr(16, 4), "JSON");
    EXPECT_EQ(word(file, next) % 4, 0U);
    EXPECT_EQ(file.substr(next + 4, 4), std::string("BIN\0", 4));
    EXPECT_EQ(next + 8 + word(file, next), file.size());
    root = manifest::parse_json(file.substr(20, length), "glb");
    chunk = file.substr(next + 8);
  }
  const Value& entry(const char* list, std::int64_t i) const {
    return root.find(list)->as_array().at(static_cast<std::size_t>(i));
  }
  std::vector<float> floats(std::int64_t accessor) const {
    const Value& a = entry("accessors", accessor);
    const Value& view = entry("bufferViews", a.find("bufferView")->as_integer());
    std::vector<float> values(static_cast<std::size_t>(view.find("byteLength")->as_integer()) / 4);
    std::memcpy(values.data(), chunk.data() + view.find("byteOffset")->as_integer(), 4 * values.size());
    return values;
  }
  Value root;
  std::string chunk;
};

std::vector<double> numbers(const Value& v) {
  std::vector<double> all;
  for (const Value& n : v.as_array()) all.push_back(n.as_number());
  return all;
}

void expect_sound(const Glb& file) {
  const std::int64_t length = file.entry("buffers", 0).find("byteLength")->as_integer();
  EXPECT_LE(static_cast<std::size_t>(length), file.chunk.size());
  EXPECT_LT(file.chunk.size(), static_cast<std::size_t>(length) + 4);
  const std::map<std::string, std::int64_t> columns{{"SCALAR", 1}, {"VEC3", 3}, {"VEC4", 4}};
  std::int64_t covered = 0;
  for (std::size_t i = 0; i < file.root.find("accessors")->as_array().size(); ++i) {
    const Value& a = file.entry("accessors", static_cast<std::int64_t>(i));
    const Value& view = file.entry("bufferViews", a.find("bufferView")->as_integer());
    const std::int64_t wide = columns.at(a.find("type")->as_string()), count = a.find("count")->as_integer();
    EXPECT_EQ(view.find("byteLength")->as_integer(), 4 * wide * count);
    EXPECT_EQ(view.find("byteOffset")->as_integer() % 4, 0);
    covered += view.find("byteLength")->as_integer();
    if (a.find("min") == nullptr) continue;
    const auto values = file.floats(static_cast<std::int64_t>(i));
    std::vector<double> low(values.begin(), values.begin() + wide), high(low);
    for (std::size_t k = 0; k < values.size(); ++k) {
      const std::size_t c = k % static_cast<std::size_t>(wide);
      low[c] = std::min<double>(low[c], values[k]), high[c] = std::max<double>(high[c], values[k]);
    }
    EXPECT_EQ(numbers(*a.find("min")), low);
    EXPECT_EQ(numbers(*a.find("max")), high);
  }
  EXPECT_EQ(covered, length);
}

Quaternion quaternion(const std::vector<double>& v) {
  return {v[3], v[0], v[1], v[2]};
}

// Section 3.11 and appendix C.4: spherical interpolation between the keys about a time.
Quaternion sampled(const std::vector<float>& times, const std::vector<float>& turns, double t) {
  std::size_t k = 0;
  while (k + 2 < times.size() && times[k + 1] <= t) ++k;
  const auto at = [&](std::size_t i) {
    return Quaternion{turns[4 * i + 3], turns[4 * i], turns[4 * i + 1], turns[4 * i + 2]};
  };
  const Quaternion a = at(k), b = at(k + 1);
  const double share = std::clamp((t - times[k]) / (double{times[k + 1]} - times[k]), 0.0, 1.0);
  const double cosine = a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z;
  EXPECT_GT(cosine, 0);  // the shorter way is the one that is meant
  const double angle = std::acos(std::min(1.0, std::abs(cosine)));
  const double u = angle > 1e-9 ? std::sin((1 - share) * angle) / std::sin(angle) : 1 - share;
  const double v = angle > 1e-9 ? std::sin(share * angle) / std::sin(angle) : share;
  return normalized({u * a.w + v * b.w, u * a.x + v * b.x, u * a.y + v * b.y, u * a.z + v * b.z});
}

using Pose = Rigid<frame::Object, frame::Object>;

// Of every node, y up.
std::vector<Pose> world_transforms(const Glb& file, double t) {
  const auto& nodes = file.root.find("nodes")->as_array();
  std::vector<Pose> local(nodes.size()), world(nodes.size());
  std::vector<std::size_t> parent(nodes.size(), nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (const Value* q = nodes[i].find("rotation")) local[i].rotation = quaternion(numbers(*q));
    if (const Value* p = nodes[i].find("translation")) {
      const auto v = numbers(*p);
      local[i].translation_m = {v[0], v[1], v[2]};
    }
    if (const Value* children = nodes[i].find("children"))
      for (const Value& child : children->as_array()) parent[static_cast<std::size_t>(child.as_integer())] = i;
  }
  if (file.root.find("animations") != nullptr) {
    const Value& animation = file.entry("animations", 0);
    for (const Value& channel : animation.find("channels")->as_array()) {
      const Value& sampler =
          animation.find("samplers")->as_array().at(static_cast<std::size_t>(channel.find("sampler")->as_integer()));
      const auto node = static_cast<std::size_t>(channel.find("target")->find("node")->as_integer());
      local[node].rotation = sampled(file.floats(sampler.find("input")->as_integer()),
                                     file.floats(sampler.find("output")->as_integer()), t);
    }
  }
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    world[i] = local[i];
    for (std::size_t p = parent[i]; p < nodes.size(); p = parent[p]) world[i] = local[p] * world[i];
  }
  return world;
}

struct Planned {
  Planned() {
    PatternScene scene;
    scene.camera = "eye", scene.lamps = {"led"};
    const ViewPattern& pattern = find_view_pattern("hemisphere", "--pattern");
    const auto steps = pattern.make(
        scene, pattern_numbers(pattern, {{"radius", 0.3}, {"step", 45 * degree}, {"lowest", 45 * degree}}, ""));
    plan = make_plan(document, laboratory, steps, "a few", {});
    times = times_of(document, laboratory, plan);
    lab = plan_model(document, laboratory, plan, times);
  }
  manifest::Document document = tests::laboratory_document(tests::two_ur5_text());
  Laboratory laboratory = believed_laboratory(document);
  manifest::Plan plan;
  PlanTimes times;
  LaboratoryModel lab;
};

TEST(PlanGltf, TheFileIsAsTheSpecificationDemands) {
  const Planned planned;
  const Glb file(scene::gltf_of(planned.lab.model, true));
  EXPECT_EQ(file.root.find("asset")->find("version")->as_string(), "2.0");
  expect_sound(file);
  std::map<std::int64_t, int> parents;
  for (const Value& node : file.root.find("nodes")->as_array()) {
    if (const Value* q = node.find("rotation")) {
      const auto v = numbers(*q);
      EXPECT_NEAR(v[0] * v[0] + v[1] * v[1] + v[2] * v[2] + v[3] * v[3], 1, 1e-12);
    }
    if (const Value* children = node.find("children"))
      for (const Value& child : children->as_array()) ++parents[child.as_integer()];
  }
  EXPECT_EQ(parents.size() + 1, file.root.find("nodes")->as_array().size());
  for (const auto& [node, count] : parents) EXPECT_EQ(count, 1) << node;
  const Value& animation = file.entry("animations", 0);
  EXPECT_EQ(animation.find("channels")->as_array().size(), 6U);  // the arm that holds the lamp stays at home
  for (const Value& sampler : animation.find("samplers")->as_array()) {
    const auto times = file.floats(sampler.find("input")->as_integer());
    EXPECT_EQ(file.floats(sampler.find("output")->as_integer()).size(), 4 * times.size());
    EXPECT_GE(times.front(), 0);
    for (std::size_t k = 1; k < times.size(); ++k) EXPECT_GT(times[k], times[k - 1]);
    EXPECT_NEAR(times.back(), planned.times.end_s(), 1e-5 * planned.times.end_s());
  }
  EXPECT_EQ(file.entry("scenes", 0).find("extras")->find("gonio")->find("stops")->as_array().size(),
            planned.plan.steps.size());
}

// Largest difference of the file's nodes and the collision checker's bodies, m and columns of rotations.
double error_at(const Glb& file, const LaboratoryModel& lab, const Laboratory& laboratory, const State& state,
                double t) {
  const Mat3 up{{1, 0, 0, 0, 0, 1, 0, -1, 0}};  // (x, y, z) of ours becomes (x, z, -y)
  const std::vector<Body> bodies = bodies_of(laboratory);
  const auto expected = placed(laboratory, bodies, state);
  const auto world = world_transforms(file, t);
  double worst = 0;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Pose& node = world[static_cast<std::size_t>(lab.solids[b])];
    worst = std::max(worst, norm(node.translation_m - up * expected[b].origin_m));
    for (const Vec3 axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}})
      worst = std::max(worst, norm(node.rotate(axis) - up * (expected[b].rotation * axis)));
  }
  return worst;
}

TEST(PlanGltf, EveryBodyIsAtItsPlaceAtAnyTime) {
  const Planned planned;
  const Glb file(scene::gltf_of(planned.lab.model, true));
  double worst = 0;
  for (int k = 0; k < 25; ++k) {
    const double t = planned.times.end_s() * (k + 0.37) / 25;
    worst = std::max(
        worst, error_at(file, planned.lab, planned.laboratory, state_at_time(planned.laboratory, planned.times, t), t));
  }
  EXPECT_LT(worst, 1e-5);
  RecordProperty("worst", std::to_string(worst));
}

// Both arms at once, joints that turn by up to twelve radians between two keys.
TEST(PlanGltf, AnyMotionOfAllJointsIsKept) {
  const manifest::Document document = tests::laboratory_document(tests::two_ur5_text());
  const Laboratory laboratory = believed_laboratory(document);
  LaboratoryModel lab = laboratory_model(document, laboratory);
  PlanTimes times;
  lab.model.keys.clear();
  Random random(11, 2);
  for (int k = 0; k < 12; ++k) {
    State state;
    for (const auto& [name, arm] : laboratory.arms)
      for (std::size_t j = 0; j < arm.links.size(); ++j) state[name].push_back(random.uniform(-6, 6));
    times.moments.push_back({1.5 * k, state, {}});
    lab.model.keys.push_back({1.5 * k, hinge_angles(document, laboratory, state, {})});
  }
  const Glb file(scene::gltf_of(lab.model, true));
  expect_sound(file);
  EXPECT_EQ(file.entry("animations", 0).find("channels")->as_array().size(), 12U);
  for (int k = 0; k < 40; ++k) {
    const double t = random.uniform(0, times.end_s());
    EXPECT_LT(error_at(file, lab, laboratory, state_at_time(laboratory, times, t), t), 1e-5) << t;
  }
}

TEST(PlanGltf, CamerasAndLampsAreWhereTheLaboratoryHasThem) {
  const Planned planned;
  const Glb file(scene::gltf_of(planned.lab.model, true));
  const std::size_t step = planned.plan.steps.size() / 2;
  const double t = planned.times.stands[step].from_s;
  const auto world = world_transforms(file, t);
  const State state = state_at(planned.laboratory, planned.plan, step);
  const auto y_up = [](Vec3 v) { return Vec3{v.x, v.z, -v.y}; };
  const auto& nodes = file.root.find("nodes")->as_array();
  int cameras = 0, lamps = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (nodes[i].find("camera") != nullptr) {
      const auto pose = world_from_camera(planned.document, planned.laboratory, "eye", state);
      EXPECT_LT(norm(world[i].translation_m - y_up(pose.translation_m)), 1e-5);
      EXPECT_LT(norm(world[i].rotate({0, 0, -1}) - y_up(pose.rotate({0, 0, 1}))), 1e-5);  // looks ahead
      EXPECT_LT(norm(world[i].rotate({0, 1, 0}) - y_up(pose.rotate({0, -1, 0}))), 1e-5);  // its top is up
      ++cameras;
    }
    if (nodes[i].find("extensions") != nullptr) {
      const Vec3 at = lamp_position(planned.document, planned.laboratory, "led", state);
      EXPECT_LT(norm(world[i].translation_m - y_up(at)), 1e-5);
      ++lamps;
    }
  }
  EXPECT_EQ(cameras, 1);
  EXPECT_EQ(lamps, 1);
  const Value& lens = *file.entry("cameras", 0).find("perspective");
  EXPECT_NEAR(lens.find("aspectRatio")->as_number(), 4.0 / 3, 1e-9);  // a usual one: none is described
}

// A turntable that turns by more than half a circle between two photographs; and nothing moves without a plan.
TEST(PlanGltf, LongTurnsGoTheirWayAround) {
  const manifest::Document document = tests::laboratory_document(tests::ur3_and_turntable_text());
  const Laboratory laboratory = believed_laboratory(document);
  LaboratoryModel lab = laboratory_model(document, laboratory);
  EXPECT_EQ(Glb(scene::gltf_of(lab.model, true)).root.find("animations"), nullptr);
  lab.model.keys = {{0, hinge_angles(document, laboratory, {}, {})},
                    {10, hinge_angles(document, laboratory, {}, {{"turntable", 5.5}})}};
  const Glb file(scene::gltf_of(lab.model, true));
  expect_sound(file);
  for (const double t : {1.0, 3.0, 6.5, 9.9}) {
    const Vec3 x =
        world_transforms(file, t)[static_cast<std::size_t>(lab.turntables.at("turntable"))].rotate({1, 0, 0});
    EXPECT_LT(norm(x - Vec3{std::cos(0.55 * t), 0, -std::sin(0.55 * t)}), 1e-5) << t;
  }
}

TEST(PlanGltf, TextHoldsTheSameInBase64) {
  const Planned planned;
  const Value root = manifest::parse_json(scene::gltf_of(planned.lab.model, false), "gltf");
  const std::string uri = root.find("buffers")->as_array().at(0).find("uri")->as_string();
  EXPECT_TRUE(uri.starts_with("data:application/octet-stream;base64,"));
  const auto length = static_cast<std::size_t>(root.find("buffers")->as_array().at(0).find("byteLength")->as_integer());
  EXPECT_EQ(uri.size() - uri.find(',') - 1, (length + 2) / 3 * 4);
}

}  // namespace
}  // namespace gonio::acquisition
