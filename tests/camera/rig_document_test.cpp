// From pictures to the manifest: two cameras, two boards in every image, shots named by the images.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "camera/calibrate_document.h"
#include "camera/corner_table.h"
#include "data.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "manifest/sections/board.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/image.h"
#include "manifest/sections/rig.h"
#include "manifest/sections/table.h"
#include "synthetic_board.h"

namespace gonio::camera {
namespace {

constexpr int width = 400, height = 300;
const Intrinsics lens{375, 375, 199.5, 149.5, {}};
const RigPose rig_from_right{quaternion_of_rotation_vector({0, -0.08, 0}), {0.05, 0, 0}};

Board large() {
  return {BoardKind::checkerboard, 7, 5, 0.02, 0, "", {}};
}
Board small() {
  return {BoardKind::checkerboard, 4, 3, 0.02, 0, "", {}};
}

// Both boards on one white ground: the darker of the two pictures.
io::Image picture(const BoardPose& a, const BoardPose& b) {
  io::Image image = photograph(large(), lens, a, width, height, 0.002, 3);
  const io::Image other = photograph(small(), lens, b, width, height, 0.002, 3);
  for (std::size_t i = 0; i < image.data.size(); ++i) image.data[i] = std::min(image.data[i], other.data[i]);
  return image;
}

TEST(RigDocument, TwoCamerasAndTwoBoards) {
  const tests::ScratchFolder folder;
  manifest::Document document;
  document.allow_outside = true;
  document.boards["large"] = section_of(large());
  document.boards["small"] = section_of(small());
  for (int shot = 0; shot < 6; ++shot) {
    const double azimuth = 2 * pi * shot / 6;
    const BoardPose a =
        pose_at(large(), {0.45 * std::cos(azimuth), 0.45 * std::sin(azimuth), 0.1 * shot}, 0.5, {-0.6, 0.2});
    const BoardPose b = pose_at(small(), {0.4 * std::sin(azimuth), 0.4 * std::cos(azimuth), 0}, 0.5, {3.4, -0.4});
    for (const bool right : {false, true}) {
      const auto from = [&](const BoardPose& pose) {
        const PlacedBoard placed{pose.rotation, pose.translation_m};
        return right ? inverse(rig_from_right) * placed : pose;
      };
      manifest::ImageEntry entry;
      entry.camera = right ? "right" : "left";
      entry.shot = "shot" + std::to_string(shot);
      entry.id = entry.camera + std::to_string(shot);
      const std::filesystem::path path = folder / (entry.id + ".png");
      io::write_picture(path, picture(from(a), from(b)));
      entry.file = manifest::add_file(document, path, entry.id);
      entry.boards = {{"large", {}, {}, {}}, {"small", {}, {}, {}}};
      document.images.push_back(entry);
    }
  }
  document.cameras["left"].model = document.cameras["right"].model = "pinhole";
  EXPECT_EQ(calibrate_document(document, {}), Exit::done);
  const manifest::Rig& rig = document.rigs.at("rig");
  ASSERT_EQ(rig.cameras.size(), 2U);
  const auto& right = rig.cameras[1].rig_from_camera;
  ASSERT_TRUE(right.sigma);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(right.translation_m[i], rig_from_right.translation_m[i],
                4.5 * right.sigma->translation_m[static_cast<std::size_t>(i)]);
  }
  EXPECT_NEAR(document.cameras.at("left").fx_px.scalar(), 375, 3);
  for (const manifest::ImageEntry& image : document.images) {
    ASSERT_EQ(image.boards.size(), 2U);
    for (const manifest::SeenBoard& seen : image.boards) {
      EXPECT_TRUE(seen.camera_from_board) << image.id << " " << seen.board;
      EXPECT_GT(seen.weight.value(), 0);
      EXPECT_LT(seen.rms_px.value(), 0.2);
    }
  }
  EXPECT_EQ(document.tables.size(), 4U);
  EXPECT_EQ(read_corners(document, "corners-right-small").images.size(), 6U);
}

}  // namespace
}  // namespace gonio::camera
