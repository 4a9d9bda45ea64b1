// Scenes of prove-align for other programs, and what align() finds in them with what those programs are given: masks of
// the object alone and cameras that are known, but no shadow, no lamp and no ground.
//
//   export-align-scenes SCENES SEED FOLDER
//
// Scene k goes to FOLDER/k: mesh.ply; 0.png, 1.png, ... masks as 8-bit pictures, 0 or 255; scene.json. Its poses take
// coordinates of their second frame to the first: p_camera = camera_from_world * p_world, rotations as quaternions with
// w first, lengths in metres. The centre of the top-left pixel is (0, 0), x to the right, y downwards, z into the
// picture. `answers` has what align() found from the start and, to compare conventions, from the truth; `first_view`
// with the first mask alone.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "alignment/align_bodies.h"
#include "alignment/alignment_world.h"
#include "base/error.h"
#include "io/codes.h"
#include "io/ply.h"
#include "manifest/value.h"

using namespace gonio;
using namespace gonio::alignment;
using namespace gonio::alignment::testing;
using gonio::manifest::Value;

namespace {

template <class To, class From>
Value value_of(const Rigid<To, From>& pose) {
  const Quaternion q = pose.rotation;
  const Vec3 t = pose.translation_m;
  Value v = Value::object();
  v["rotation_wxyz"] = std::vector<double>{q.w, q.x, q.y, q.z};
  v["translation_m"] = std::vector<double>{t.x, t.y, t.z};
  return v;
}

// The object's masks and nothing else.
AlignmentInput with_masks_alone(World world, const WorldWish& wish, std::vector<Labels>& masks) {
  AlignmentInput& in = world.input;
  in.rims.clear(), in.question.sightings.clear(), in.question.contacts.clear();
  std::mt19937_64 random(wish.seed + 500000);
  for (std::size_t v = 0; v < in.stated.stations.size(); ++v) {
    masks.push_back(photographed(world.truth, v, 0, wish, random));
    add_rims(world, masks.back(), v, 0, wish);
  }
  std::erase_if(in.rims, [](const SeenRim& rim) { return rim.outline == shadow; });
  std::erase_if(in.question.sightings, [](const Sighting& s) { return s.subject.lamp.has_value(); });
  std::erase_if(in.question.freedoms, [](const Freedom& f) { return f.block == Block::lamp_shift; });
  in.lamps.clear(), in.lamp_stated.clear(), in.stated.lamps_m.clear(), in.stated.ground.reset();
  in.question.stated = in.stated;
  return std::move(in);
}

Value answer_of(AlignmentInput in, const Rigid<frame::World, frame::Object>& start, bool first_view) {
  in.stated.bodies[0].world_from_object = in.question.stated.bodies[0].world_from_object = start;
  if (first_view) {
    in.rims.resize(1), in.question.sightings.resize(1);
    in.stated.stations.resize(1), in.question.stated.stations.resize(1);
  }
  AlignWish how;
  how.from = AlignWish::From::stated;
  Value answer = Value::object();
  const auto begun = std::chrono::steady_clock::now();
  try {
    const Aligned found = align_bodies(in, how).front();
    answer = value_of(found.fitted.setting.bodies[0].world_from_object);
    answer["verdict"] = word_of(found.verdict);
  } catch (const Error& error) {
    answer = value_of(start);
    answer["verdict"] = error.what();
  }
  answer["seconds"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  return answer;
}

// Turns after which a solid looks the same: of the brick half a turn about each axis; the vase may turn about z as it
// likes.
void add_symmetry(Value& scene, const std::string& solid) {
  scene["same_turned_by_wxyz"] = Value::array();
  scene["same_turned_by_wxyz"].push_back(std::vector<double>{1, 0, 0, 0});
  if (solid == "brick")
    for (std::size_t axis = 1; axis < 4; ++axis) {
      std::vector<double> turn(4, 0);
      turn[axis] = 1;
      scene["same_turned_by_wxyz"].push_back(turn);
    }
  scene["turns_freely_about_z"] = solid == "vase";
}

void export_views(Value& scene, const AlignmentInput& in, const std::vector<Labels>& masks, int size,
                  const std::filesystem::path& folder) {
  const Lens& lens = in.stated.lenses[0];
  for (std::size_t v = 0; v < masks.size(); ++v) {
    io::Image picture(size, size, {"Y"});
    for (std::size_t i = 0; i < picture.data.size(); ++i) picture.data[i] = masks[v].of[i] == object ? 1.0F : 0.0F;
    const std::string name = std::to_string(v) + ".png";
    io::write_png(folder / name, picture, 8);
    Value view = Value::object();
    view["mask"] = name;
    view["fx_fy_cx_cy_px"] = std::vector<double>{lens.fx_px, lens.fy_px, lens.cx_px, lens.cy_px};
    view["camera_from_world"] = value_of(inverse(in.stated.stations[v].world_from_camera));
    scene["views"].push_back(view);
  }
}

void export_scene(const WorldWish& wish, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  World world = world_of(wish);
  const Solid& solid = solids()[wish.solid];
  const auto truth = world.truth.bodies[0].world_from_object;
  std::vector<Labels> masks;
  const AlignmentInput in = with_masks_alone(std::move(world), wish, masks);
  const auto start = in.stated.bodies[0].world_from_object;
  io::write_ply(folder / "mesh.ply", {.positions_m = solid.positions_m, .triangles = solid.triangles});
  Value scene = Value::object();
  scene["solid"] = solid.name;
  const Vec3 middle = in.shapes.front().centre_m();
  scene["middle_of_mesh_m"] = std::vector<double>{middle.x, middle.y, middle.z};
  add_symmetry(scene, solid.name);
  export_views(scene, in, masks, wish.size_px, folder);
  scene["true_world_from_object"] = value_of(truth);
  scene["start_world_from_object"] = value_of(start);
  scene["answers"]["all_views"] = answer_of(in, start, false);
  scene["answers"]["first_view"] = answer_of(in, start, true);
  scene["answers"]["all_views_from_truth"] = answer_of(in, truth, false);
  scene["answers"]["first_view_from_truth"] = answer_of(in, truth, true);
  std::ofstream(folder / "scene.json") << manifest::print_json(scene) << '\n';
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) return std::fprintf(stderr, "usage: export-align-scenes SCENES SEED FOLDER\n"), 64;
  const auto scenes = static_cast<std::size_t>(std::atoll(argv[1]));
  const auto seed = static_cast<std::uint64_t>(std::atoll(argv[2]));
  for (std::size_t k = 0; k < scenes; ++k)  // one after the other, as their seconds count
    export_scene({.solid = k % 8,
                  .views = 1 + static_cast<int>(k / 8 % 4),
                  .lamps = 1 + static_cast<int>(k / 32 % 4),
                  .seed = 1000 * seed + k},
                 std::filesystem::path(argv[3]) / std::to_string(k));
  return 0;
}
