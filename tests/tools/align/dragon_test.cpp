// align on a printed dragon in a cluttered room (align/visp_dragon): masks by its colour, sensor depth as a witness
// that had no part in it. One process: RecordedDragon.*
//
// The set's poses are for (x, -z, y) of its mesh. Reached over one and the same mask, beside the peer's published poses
// (which have 0.887, 0.908, 0.901 over a mask of their own); depth is the sensor's over the model's: median, and 1.4826
// and 1.4826 of the median deviation from it:
//
//   frame   IoU start / found / peer   depth off, mm        scatter, mm
//   0       0.831  0.886  0.882        10.4   8.5   9.8     3.8   2.2   2.1
//   12      0.401  0.882  0.876        16.4   9.6  10.4     6.6   2.2   2.5
//   24      0.625  0.904  0.902         7.1   9.6   9.1     2.8   2.1   2.2
//
// On the tags' plane the sensor is off by -0.4 to 2.6 % (SOURCE.md), -2 to 13 mm here: what depth tells is the scatter,
// which a wrong turn raises; its offset only within that.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "alignment/coverage.h"
#include "alignment/model_rim.h"
#include "base/atomic_file.h"
#include "base/text.h"
#include "data.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "manifest/sections/alignment.h"
#include "manifest/sections/object.h"
#include "manifest/value.h"
#include "mesh/obj_file.h"
#include "mesh/triangle_tree.h"
#include "process.h"

namespace gonio::tests {
namespace {

using Pose = Rigid<frame::World, frame::Object>;
constexpr int width = 640, height = 480;
constexpr alignment::Lens lens{607.178466796875, 607.2342529296875, 321.39129638671875, 241.91822814941406};

std::vector<float> silhouette(const alignment::Shape& shape, const Pose& pose) {
  alignment::Setting setting;
  setting.lenses = {lens}, setting.stations = {{}}, setting.bodies = {{&shape, pose, {1, 1, 1}}};
  const alignment::ModelRim rim(setting, {0, 0, {}});
  std::vector<alignment::Side> sides;
  for (const auto& p : rim.pieces()) sides.push_back({p.from, p.to});
  return alignment::coverage_of(sides, width, height);
}

// What is yellow within `margin` pixels of the start's box, its largest connected part: the picture alone says where.
io::Image yellow(const io::Image& picture, const std::vector<float>& start, int margin) {
  int left = width, right = 0, top = height, bottom = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      if (start[static_cast<std::size_t>(y * width + x)] > 0.5F)
        left = std::min(left, x), right = std::max(right, x), top = std::min(top, y), bottom = std::max(bottom, y);
  std::vector<int> part(picture.pixels(), -1);
  std::vector<std::size_t> largest;
  const auto is_yellow = [&](int x, int y) {
    if (x < left - margin || x > right + margin || y < top - margin || y > bottom + margin) return false;
    const float r = picture.at(x, y, 0), g = picture.at(x, y, 1), b = picture.at(x, y, 2);
    return r > 0.35F && g > 0.70F * r && b < 0.52F * r;
  };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      if (!is_yellow(x, y) || part[static_cast<std::size_t>(y * width + x)] >= 0) continue;
      std::vector<std::size_t> members{static_cast<std::size_t>(y * width + x)};
      part[members[0]] = 1;
      for (std::size_t k = 0; k < members.size(); ++k) {
        const int px = static_cast<int>(members[k]) % width, py = static_cast<int>(members[k]) / width;
        for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
          const int qx = px + dx, qy = py + dy;
          if (qx < 0 || qy < 0 || qx >= width || qy >= height || !is_yellow(qx, qy)) continue;
          const auto q = static_cast<std::size_t>(qy * width + qx);
          if (part[q] < 0) part[q] = 1, members.push_back(q);
        }
      }
      if (members.size() > largest.size()) largest = std::move(members);
    }
  io::Image mask(width, height, {"Y"});
  for (const std::size_t p : largest) mask.data[p] = 1;
  return mask;
}

double overlap(const std::vector<float>& share, const io::Image& mask) {
  double both = 0, either = 0;
  for (std::size_t i = 0; i < share.size(); ++i) {
    const bool a = share[i] > 0.5F, b = mask.data[i] > 0.5F;
    both += a && b, either += a || b;
  }
  return both / either;
}

double median(std::vector<double> v) {
  std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2), v.end());
  return v[v.size() / 2];
}

struct Depth {  // sensor's over the model's
  double off_m = 0, scatter_m = 0;
  std::size_t pixels = 0;
};
// Where the model covers all pixels within two of it: at rims the sensor mixes near and far.
Depth depth_of(const io::TriangleMesh& mesh, const std::vector<float>& share, const Pose& pose,
               const io::Image& sensor_codes) {
  std::vector<Vec3> seen;
  for (const Vec3& p : mesh.positions_m) seen.push_back(pose * p);
  const mesh::TriangleTree tree(seen, mesh.triangles);
  std::vector<double> off;
  for (int y = 2; y < height - 2; ++y)
    for (int x = 2; x < width - 2; ++x) {
      bool inside = true;
      for (int dy = -2; dy <= 2; ++dy)
        for (int dx = -2; dx <= 2; ++dx)
          inside = inside && share[static_cast<std::size_t>((y + dy) * width + x + dx)] > 0.5F;
      const double metres = 65.535 * static_cast<double>(sensor_codes.at(x, y, 0));  // 16 bits of mm
      if (!inside || !(metres > 0)) continue;
      const auto hit = tree.first_hit({}, {(x - lens.cx_px) / lens.fx_px, (y - lens.cy_px) / lens.fy_px, 1}, 0.01);
      if (hit) off.push_back(metres - hit->t);
    }
  Depth d{median(off), 0, off.size()};
  for (double& o : off) o = std::abs(o - d.off_m);
  d.scatter_m = 1.4826 * median(off);
  return d;
}

class RecordedDragon : public ::testing::TestWithParam<const char*> {};

TEST_P(RecordedDragon, LiesOnItsPictureAsWellAsThePeersAndOnTheSensorsDepth) {
  GONIO_NEEDS_DATA("align/visp_dragon");
  const auto root = data("align/visp_dragon");
  const std::string frame = GetParam();
  const std::string number = format("%04d", std::stoi(frame));
  io::TriangleMesh mesh = read_obj((root / "dragon.obj").c_str());
  for (Vec3& p : mesh.positions_m) p = {p.x, -p.z, p.y};
  ScratchFolder scratch;
  io::write_ply(scratch / "dragon.ply", mesh);
  const alignment::Shape shape(mesh.positions_m, mesh.triangles);
  const manifest::Value published = manifest::parse_json(read_file(root / "peer_poses.json"), "peer_poses.json");
  const manifest::Value& poses = *published.find("camera_from_mesh_zup");
  // Frame 0 begins where the set says, the others where the peer has the frame before: some 16 pixels off.
  const manifest::Value start = frame == "0" ? manifest::parse_json(read_file(root / "init_dragon.json"), "init")
                                             : *poses.find(frame == "12" ? "0" : "12");
  const auto scene = [&](const manifest::Value& pose) {
    return R"({"gonio": 1, "files": {"m": {"path": "dragon.ply"}, "k": {"path": "mask.exr"}},
 "cameras": {"c": {"width_px": 640, "height_px": 480, "fx_px": 607.178466796875, "fy_px": 607.2342529296875,
                   "cx_px": 321.39129638671875, "cy_px": 241.91822814941406}},
 "meshes": {"dragon": {"file": "m"}}, "surfaces": {"s": {"model": "diffuse", "albedo": [0.5, 0.4, 0.1]}},
 "images": [{"id": "v", "camera": "c"}],
 "outlines": [{"image": "v", "object": "dragon", "kind": "object", "mask": "k"}],
 "objects": [{"id": "dragon", "mesh": "dragon", "surface": "s", "world_from_object": {"matrix": )" +
           manifest::print_json(pose) + "}}]}";
  };
  const auto pose_in = [&](const std::string& text) -> Pose {
    return *manifest::parse_document(text, "scene.json", scratch.path()).objects[0].world_from_object;
  };
  io::write_picture(scratch / "mask.exr", io::Image(width, height, {"Y"}));
  const Pose stated = pose_in(scene(start)), peer = pose_in(scene(*poses.find(frame)));
  const io::Image mask = yellow(io::read_picture(root / ("color_" + number + ".png")), silhouette(shape, stated), 20);
  io::write_picture(scratch / "mask.exr", mask);
  write_file(scratch / "scene.json", scene(start));
  // Masks by a colour take some of the stomach behind the horns: rims are off by a pixel, robustly.
  const Ended ended = run({"align", "-i", "scene.json", "--from", "stated", "--limit", "1.5"}, scratch.path());
  ASSERT_TRUE(ended.status == 0 || ended.status == 2) << ended.err;
  const manifest::Document d = manifest::parse_document(ended.out, "aligned.json", scratch.path());
  const Pose found = *d.objects[0].world_from_object;
  const io::Image sensor = io::read_picture(root / ("depth_mm_" + number + ".png"));
  std::array<double, 3> iou{};
  std::array<Depth, 3> depth;
  const std::array<Pose, 3> all{stated, found, peer};
  const std::array<const char*, 3> names{"start", "found", "peer"};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::vector<float> share = silhouette(shape, all[k]);
    iou[k] = overlap(share, mask), depth[k] = depth_of(mesh, share, all[k], sensor);
    std::cout << format("frame %s, %s: IoU %.3f, depth off by %.1f mm, scatter %.2f mm over %zu pixels\n",
                        frame.c_str(), names[k], iou[k], 1e3 * depth[k].off_m, 1e3 * depth[k].scatter_m,
                        depth[k].pixels);
  }
  EXPECT_GT(iou[1], iou[0]);
  EXPECT_GT(iou[1], iou[2]);
  EXPECT_GT(iou[1], 0.85);
  EXPECT_LT(depth[1].scatter_m, depth[0].scatter_m);
  EXPECT_LT(depth[1].scatter_m, 0.003);
  EXPECT_GT(depth[1].off_m, -0.002);  // the sensor's own, by its tags
  EXPECT_LT(depth[1].off_m, 0.013);
}
INSTANTIATE_TEST_SUITE_P(Frames, RecordedDragon, ::testing::Values("0", "12", "24"));

}  // namespace
}  // namespace gonio::tests
