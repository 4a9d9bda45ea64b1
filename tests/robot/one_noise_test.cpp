// One robot, one recording, one figure: handeye states the noise of the robot's poses, and explain, which is handed its
// manifest, states the same one, printed and in the manifest. Both programs are those of GONIO_BIN.
#include "robot/one_noise.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "camera/corner_table.h"
#include "manifest/document.h"
#include "manifest/sections/board.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/image.h"
#include "robot/handeye_world.h"

namespace gonio::robot {
namespace {

template <class To, class From>
manifest::Pose<To, From> stated(const Rigid<To, From>& rigid) {
  manifest::Pose<To, From> pose;
  pose.rotation = rigid.rotation;
  pose.translation_m = rigid.translation_m;
  return pose;
}

// What calib-charuco and a controller would say of this world.
std::string manifest_of(const tests::HandEyeWorld& world, std::uint64_t seed) {
  manifest::Document d;
  const handeye::Setup setup = world.setup();
  manifest::Camera& camera = d.cameras["camera"];
  camera.width_px = setup.width_px, camera.height_px = setup.height_px;
  camera.fx_px = setup.lens.fx_px, camera.fy_px = setup.lens.fy_px;
  camera.cx_px = setup.lens.cx_px, camera.cy_px = setup.lens.cy_px;
  camera.model = "radial-tangential";
  camera.distortion = {{"k1", setup.lens.distortion[0]}};
  camera.sigma = {{"fx_px", {0.5}}, {"fy_px", {0.5}}, {"cx_px", {0.5}}, {"cy_px", {0.5}}};
  manifest::Board& board = d.boards["board"];
  board.kind = "checkerboard";
  board.inner_corners = {world.columns, world.rows};
  board.square_m = world.square_m;
  camera::CornerTable table{"camera", "board", {}};
  for (const handeye::View& view : world.views(seed)) {
    manifest::ImageEntry image;
    image.id = view.image;
    image.camera = "camera", image.board = "board";
    image.base_from_tool = stated(view.base_from_tool);
    image.camera_from_board = stated(view.camera_from_board);
    d.images.push_back(image);
    camera::ImageCorners corners{view.image, {}};
    for (const handeye::SeenCorner& c : view.corners)
      corners.corners.push_back({static_cast<int>(corners.corners.size()), c.board_m, c.pixel, c.sigma_px});
    table.images.push_back(corners);
  }
  camera::write_corners(table, "corners", {}, d);
  return manifest::print_document(d, ".");
}

TEST(OneNoise, OfASimulatedRobotWithTheCameraInItsHandAndBesideIt) {
  tests::HandEyeWorld world;
  world.poses = 24;
  for (const auto kind : {handeye::Kind::eye_in_hand, handeye::Kind::eye_to_hand}) {
    world.kind = kind;
    const tests::Ended handeye =
        tests::run({"handeye", "--kind", std::string(handeye::name_of(kind))}, {}, manifest_of(world, 4));
    ASSERT_EQ(handeye.status, 0) << handeye.err;
    const tests::BothNoises b = tests::both_noises(handeye);
    EXPECT_TRUE(b.outliers.empty());
    EXPECT_NEAR(b.handeye.robot_m, world.robot_m, 0.3 * world.robot_m);
    tests::expect_one_figure(b, 0.03);
  }
}

}  // namespace
}  // namespace gonio::robot
