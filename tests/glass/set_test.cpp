#include "glass/set.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ranges>
#include <set>

#include "base/atomic_file.h"
#include "base/error.h"
#include "data.h"
#include "glass/gather.h"
#include "glass/make_cell.h"
#include "glass/tensors.h"
#include "io/csv.h"
#include "io/npz.h"
#include "io/picture.h"
#include "manifest/sections/file.h"
#include "manifest/sections/image.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"
#include "scene/checks.h"
#include "scene/scene.h"

namespace gonio::glass {
namespace {

namespace fs = std::filesystem;

// Of this process alone: tests of one fixture run beside each other.
fs::path empty_folder(const std::string& name) {
  static const tests::ScratchFolder mine;
  fs::create_directories(mine / name);
  return mine / name;
}

SetWish small(std::size_t objects, std::size_t views) {
  SetWish wish;
  wish.objects = objects, wish.views = views, wish.width_px = wish.height_px = 32;
  wish.most_spp = 16, wish.relative_error = 1;
  return wish;
}

// Whoever asks, in whatever order and folder: the same names. All differ.
TEST(GlassSet, CellsDependOnTheirNumbersAlone) {
  const GlassSet one(small(6, 3), empty_folder("set-one")), other(small(6, 3), empty_folder("set-other"));
  std::set<std::string> names;
  for (std::size_t n = 0; n < one.cells(); ++n) names.insert(one.cell(n).name);
  EXPECT_EQ(names.size(), 18u);
  for (const std::size_t n : {17u, 3u, 4u, 0u}) EXPECT_EQ(other.cell(n).name, one.cell(n).name) << n;
  SetWish wish = small(6, 3);
  wish.relative_error = 0.5;
  EXPECT_NE(GlassSet(wish, other.folder()).cell(3).name, one.cell(3).name);
  EXPECT_THROW(one.cell(18), Error);
  EXPECT_THROW(GlassSet(small(0, 3), one.folder()), Error);
}

// Views of an object are in one share; of 40 objects 4 are tests and 4 are for validation.
TEST(GlassSet, IsSplitByObject) {
  SetWish wish = small(40, 2);
  wish.forms = {"lathe"};
  const GlassSet set(wish, empty_folder("set-split"));
  std::map<Share, std::size_t> count;
  for (std::size_t n = 0; n < set.cells(); n += 2) {
    const Share share = set.cell(n).share;
    EXPECT_EQ(set.cell(n + 1).share, share);
    ++count[share];
  }
  EXPECT_EQ(count[Share::test], 4u);
  EXPECT_EQ(count[Share::validation], 4u);
  EXPECT_EQ(count[Share::training], 32u);
}

// Each form is in each share as often as any other, but for one. 203 objects: forms and shares of uneven sizes.
TEST(GlassSet, IsSplitByForm) {
  const GlassSet set(small(203, 1), empty_folder("set-forms"));
  std::map<Share, std::map<std::string, std::size_t>> count;
  const std::vector<std::string>& forms = set.wish().forms;
  for (std::size_t n = 0; n < set.cells(); ++n) ++count[set.share_of(n)][forms[n % forms.size()]];
  std::map<Share, std::size_t> whole;
  for (const auto& [share, of_form] : count) {
    EXPECT_EQ(of_form.size(), forms.size());
    const auto [least, most] = std::ranges::minmax(of_form | std::views::values);
    EXPECT_LE(most - least, 1u) << name_of(share);
    for (const std::size_t n : of_form | std::views::values) whole[share] += n;
  }
  EXPECT_EQ(whole[Share::test], 20u);
  EXPECT_EQ(whole[Share::validation], 20u);
}

// Twenty files of ten contents: what is the same stays together.
TEST(GlassSet, FilesOfOneContentStayTogether) {
  const fs::path folder = empty_folder("set-files");
  SetWish wish = small(20, 1);
  for (std::size_t i = 0; i < 20; ++i) {
    wish.meshes.push_back(folder / ("body-" + std::to_string(i) + ".ply"));
    io::write_ply(wish.meshes.back(), drawn_body(*find_form("lathe"), 1, i % 10).body.mesh);
  }
  std::ranges::sort(wish.meshes);  // as the set takes them
  const GlassSet set(wish, folder);
  std::map<int, std::set<Share>> shares;  // by content
  std::size_t training = 0;
  for (std::size_t n = 0; n < 20; ++n) {
    const Share share = set.cell(n).share;
    shares[std::stoi(wish.meshes[n].stem().string().substr(5)) % 10].insert(share);
    training += share == Share::training ? 1 : 0;
  }
  EXPECT_EQ(shares.size(), 10u);
  for (const auto& [content, in] : shares) EXPECT_EQ(in.size(), 1u) << content;
  EXPECT_EQ(training, 16u);  // one content of ten is for tests, one for validation
}

// Scenes are such as scene(1) finds nothing to say about, but for bodies that look through each other on purpose.
TEST(GlassSet, ScenesAreSound) {
  const GlassSet set(small(10, 1), empty_folder("set-sound"));
  for (std::size_t n = 0; n < set.cells(); ++n) {
    const scene::Scene scene = scene::build_scene(set.cell(n).scene);
    for (const scene::Finding& f : scene::check_scene(scene)) {
      const bool meant = f.pointer.find("filling") != std::string::npos || f.what.find("overlap") != std::string::npos;
      EXPECT_TRUE(meant) << n << ": " << f.pointer << ' ' << f.what << ": " << f.consequence;
    }
  }
}

// A slab is crossed twice, a hollow body in its middle four times; the object's pixels and no others are counted.
TEST(RayDepth, CountsSurfaces) {
  SetWish wish = small(1, 1);
  wish.forms = {"blown"};
  const fs::path folder = empty_folder("set-depth");
  const GlassSet set(wish, folder);
  Cell cell = set.cell(0);
  std::erase_if(cell.scene.objects, [](const manifest::Object& o) { return o.id.starts_with("bubble"); });
  const RayDepth hollow = ray_depth(cell);
  EXPECT_GT(hollow.count[4], 10u);
  EXPECT_GT(hollow.count[0], hollow.count[4]);
  io::TriangleMesh slab;
  for (int k = 0; k < 8; ++k)
    slab.positions_m.push_back({k & 1 ? 0.05 : -0.05, k & 2 ? 0.005 : -0.005, k & 4 ? 0.1 : 0.0});
  slab.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  io::write_ply(folder / "slab.ply", slab);
  cell.scene.meshes["object"].file = manifest::add_file(cell.scene, folder / "slab.ply", "slab");
  cell.scene.meshes["object"].normals = "flat";
  for (manifest::Object& object : cell.scene.objects)
    if (object.id == "object") object.world_from_object->rotation = {};
  const RayDepth flat = ray_depth(cell);
  EXPECT_GT(flat.count[2], 0.9 * (32 * 32 - static_cast<double>(flat.count[0])));
}

// One cell, made: its tensors against its own rendering.
class OneCell : public testing::Test {
 protected:
  static const GlassSet& set() {
    static const GlassSet made = [] {
      SetWish wish = small(1, 1);
      wish.forms = {"bottle"}, wish.most_spp = 64, wish.seed = 4;
      return GlassSet(wish, empty_folder("set-cell"));
    }();
    return made;
  }
  static const Cell& cell() {
    static const Cell made = [] {
      Cell c = set().cell(0);
      EXPECT_TRUE(make_cell(set(), c));
      EXPECT_FALSE(make_cell(set(), c));
      return c;
    }();
    return made;
  }
};

TEST_F(OneCell, TensorsAreWhatTheyAreCalled) {
  const auto tensors = tensors_of(set(), cell());
  constexpr std::size_t n = 32 * 32;
  ASSERT_EQ(tensors.size(), tensor_names().size());
  for (const auto& [name, channels] : tensor_names()) EXPECT_EQ(tensors.at(name).size(), channels * n) << name;
  const std::vector<float>&mask = tensors.at("mask"), &front = tensors.at("front"), &back = tensors.at("back");
  std::size_t met = 0, towards = 0, away = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const auto length = [&](const std::vector<float>& v) { return std::hypot(v[i], v[n + i], v[2 * n + i]); };
    EXPECT_NEAR(length(front), mask[i], 1e-5);
    EXPECT_NEAR(length(back), mask[i], 1e-5);
    if (mask[i] == 0) continue;
    ++met;
    towards += front[2 * n + i] < 0 ? 1 : 0, away += back[2 * n + i] > 0 ? 1 : 0;
    EXPECT_GT(tensors.at("depth")[i], 0.3f);
    EXPECT_LT(tensors.at("depth")[i], 0.8f);
  }
  EXPECT_GT(met, n / 10);
  EXPECT_GT(towards, met * 9 / 10);
  EXPECT_GT(away, met * 8 / 10);
}

// s0 as developed is R, G, B's luminance as rendered, within the sensor's noise and the interpolation's error: in the
// mean of the picture by 2 %. Intensities of a super-pixel pair up: I0 + I90 = I45 + I135, likewise.
TEST_F(OneCell, PolarizationIsTheRenderings) {
  const auto tensors = tensors_of(set(), cell());
  constexpr std::size_t n = 32 * 32;
  const std::vector<float>&rgb = tensors.at("rgb-lit"), &stokes = tensors.at("stokes-lit");
  const std::vector<float>& behind = tensors.at("intensities-lit");
  double light = 0, s0 = 0, level_upright = 0, diagonal = 0;
  for (std::size_t i = 0; i < n; ++i) {
    light += 0.2126 * rgb[i] + 0.7152 * rgb[n + i] + 0.0722 * rgb[2 * n + i], s0 += stokes[i];
    level_upright += behind[i] + behind[2 * n + i], diagonal += behind[n + i] + behind[3 * n + i];
  }
  EXPECT_NEAR(s0 / light, 1, 0.02);
  EXPECT_NEAR(level_upright / light, 1, 0.03);
  EXPECT_NEAR(diagonal / light, 1, 0.03);
}

TEST_F(OneCell, IsGathered) {
  cell();
  const Gathered gathered = gather(set(), set().folder(), [] {});
  ASSERT_EQ(gathered.rows.size(), 1u);
  EXPECT_EQ(gathered.tensors.size(), tensor_names().size());
  io::NpyArray array;
  const std::string bytes = read_file(set().folder() / "tensors" / "training-front.npy");
  EXPECT_EQ(bytes.find('\n') % 64, 63u);  // numbers begin on a line of the cache
  ASSERT_TRUE(io::parse_npy(bytes, "front", array));
  EXPECT_EQ(array.size, (std::vector<std::size_t>{1, 3, 32, 32}));
  const io::Csv table = io::parse_csv(table_of(gathered), "cells.csv");
  EXPECT_EQ(table.rows.size(), 1u);
  fs::remove(set().folder_of(cell()) / "cell.json");
  EXPECT_THROW(gather(set(), set().folder(), [] {}), Error);
  EXPECT_TRUE(make_cell(set(), cell()));
}

}  // namespace
}  // namespace gonio::glass
