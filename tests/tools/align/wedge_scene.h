// A wedge on a table, its masks and its manifest, for runs of align.
#pragma once
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "alignment/coverage.h"
#include "alignment/model_rim.h"
#include "base/atomic_file.h"
#include "data.h"
#include "io/picture.h"
#include "io/ply.h"
#include "manifest/document.h"
#include "process.h"

namespace gonio::tests {

// A wedge with a step: no two sides alike.
inline io::TriangleMesh wedge() {
  io::TriangleMesh m;
  m.positions_m = {{0, 0, 0},        {0.09, 0, 0},     {0.09, 0.05, 0},       {0, 0.06, 0},
                   {0, 0, 0.03},     {0.05, 0, 0.03},  {0.05, 0.05444, 0.03}, {0, 0.06, 0.03},
                   {0.05, 0, 0.055}, {0.09, 0, 0.045}, {0.09, 0.05, 0.06},    {0.05, 0.05444, 0.05}};
  m.triangles = {{0, 3, 2}, {0, 2, 1},  {4, 5, 6},  {4, 6, 7},  {8, 9, 10}, {8, 10, 11}, {0, 4, 7},
                 {0, 7, 3}, {1, 2, 10}, {1, 10, 9}, {5, 8, 11}, {5, 11, 6}, {0, 1, 5},   {0, 5, 4},
                 {1, 9, 5}, {5, 9, 8},  {3, 7, 6},  {3, 6, 2},  {2, 6, 10}, {6, 11, 10}};
  return m;
}

class WedgeScene : public ::testing::Test {
 protected:
  using Setting = alignment::Setting;
  using Words = Process::Words;
  static constexpr int width = 240, height = 200;
  void SetUp() override {
    const io::TriangleMesh mesh = wedge();
    io::write_ply(folder_ / "wedge.ply", mesh);
    shape_ = alignment::Shape(mesh.positions_m, mesh.triangles);
    truth_.bodies = {{&shape_, {quaternion_of_rotation_vector({0, 0, 0.5}), {-0.03, -0.04, 0}}, {1, 1, 1}}};
    truth_.lenses = {{420, 420, 119.5, 99.5}};
    truth_.stations = {{{quaternion_of_rotation_vector({-130 * pi / 180, 0, 0}), {0, -0.5, 0.42}}, 0}};
    truth_.lamps_m = {{0.25, -0.15, 0.4}};
    truth_.ground = alignment::Ground{};
    write_mask("object.exr", {0, 0, {}}), write_mask("shadow.exr", {0, 0, 0});
  }
  io::Image mask_of(const alignment::RimSubject& subject) const {
    std::vector<alignment::Side> sides;
    const alignment::ModelRim rim(truth_, subject);
    for (const auto& p : rim.pieces()) sides.push_back({p.from, p.to});
    io::Image mask(width, height, {"Y"});
    mask.data = alignment::coverage_of(sides, width, height);
    return mask;
  }
  void write_mask(const char* name, const alignment::RimSubject& subject) {
    io::write_picture(folder_ / name, mask_of(subject));
  }
  // The scene as somebody believes it, 4 degrees and a centimetre off; `change` is replaced by `to`.
  std::string scene(const std::string& change = "", const std::string& to = "") const {
    std::string text =
        R"({"gonio": 1,
 "files": {"mesh": {"path": "wedge.ply"}, "o": {"path": "object.exr"}, "s": {"path": "shadow.exr"}},
 "cameras": {"c": {"model": "pinhole", "width_px": 240, "height_px": 200, "fx_px": 420, "fy_px": 420,
                   "cx_px": 119.5, "cy_px": 99.5}},
 "meshes": {"wedge": {"file": "mesh"}, "table": {"plane": {"size_m": [2, 2]}}},
 "surfaces": {"clay": {"model": "diffuse", "albedo": [0.5, 0.3, 0.2]}},
 "lights": {"a": {"model": "point", "position_m": [0.27, -0.17, 0.41], "watt_per_sr": [1, 1, 1]}},
 "objects": [{"id": "wedge", "mesh": "wedge", "surface": "clay",
   "world_from_object": {"rotation": [1, 0, 0, 0], "translation_m": [-0.03, -0.04, 0]}},
  {"id": "table", "mesh": "table", "surface": "clay"}],
 "images": [{"id": "v", "camera": "c", "light": "a", "world_from_camera": {"matrix": [[1, 0, 0, 0],
   [0, -0.6427876096865394, 0.766044443118978, -0.5], [0, -0.766044443118978, -0.6427876096865394, 0.42],
   [0, 0, 0, 1]]}}],
 "outlines": [{"image": "v", "object": "wedge", "kind": "object", "mask": "o"},
              {"image": "v", "object": "wedge", "kind": "shadow", "mask": "s"}]})";
    if (change.empty()) return text;
    const auto at = text.find(change);
    EXPECT_NE(at, std::string::npos) << change;
    return text.replace(at, change.size(), to);
  }
  Ended align(const std::string& text, Words more = {}) const {
    write_file(folder_ / "scene.json", text);
    Words words{"align", "-i", "scene.json"};
    words.insert(words.end(), more.begin(), more.end());
    return run(words, folder_.path());
  }
  manifest::Document document_of(const Ended& ended) const {
    return manifest::parse_document(ended.out, "aligned.json", folder_.path());
  }
  void refused(const std::string& text, int status, const char* says, Words more = {}) const {
    const Ended ended = align(text, std::move(more));
    EXPECT_EQ(ended.status, status) << ended.err;
    EXPECT_THAT(ended.err, ::testing::HasSubstr(says));
    EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
    EXPECT_EQ(ended.out, "");
  }
  ScratchFolder folder_;
  alignment::Shape shape_;
  Setting truth_;
};

}  // namespace gonio::tests
