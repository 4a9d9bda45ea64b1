// The arm as a witness of what corners are said to show (explain/robot/robot_witness.h).
#include <gtest/gtest.h>

#include "base/random.h"
#include "explain/robot/robot_witness.h"
#include "explain/robot/robot_world.h"
#include "manifest/document.h"
#include "manifest/sections/image.h"

namespace gonio::explain::tests {
namespace {

// Every pose of the board turned at random by about this much.
manifest::Document shaken(manifest::Document document, double turn_rad, std::uint64_t seed) {
  Random random(seed, 1);
  for (manifest::ImageEntry& image : document.images) {
    const Vec3 turn{random.normal() * turn_rad, random.normal() * turn_rad, random.normal() * turn_rad};
    image.camera_from_board->rotation = quaternion_of_rotation_vector(turn) * image.camera_from_board->rotation;
  }
  return document;
}

bool contradicted(const manifest::Document& stated, const manifest::Document& mended) {
  const std::vector<Testimony> told = hand_eye_testimony(stated, mended);
  EXPECT_EQ(told.size(), 2u);
  return std::ranges::any_of(told, &Testimony::contradicts);
}

TEST(Witness, PosesThatScatterMoreThroughTheArmContradict) {
  const manifest::Document cell = robot_cell({}, 30, 5);
  EXPECT_TRUE(contradicted(cell, shaken(cell, 1e-3, 1)));
}

TEST(Witness, PosesThatScatterLessOrAlikeDoNot) {
  const manifest::Document cell = robot_cell({}, 30, 5);
  EXPECT_FALSE(contradicted(shaken(cell, 1e-3, 1), cell));
  EXPECT_FALSE(contradicted(cell, cell));
}

// Another draw of the same noise is no objection: of two hundred, at most two (one in a thousand by each quantity).
TEST(Witness, IsSeldomWrong) {
  std::size_t wrong = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const manifest::Document cell = robot_cell({}, 20, seed);
    wrong += contradicted(shaken(cell, 3e-4, 2 * seed + 1), shaken(cell, 3e-4, 2 * seed + 2));
  }
  EXPECT_LE(wrong, 2u);
}

}  // namespace
}  // namespace gonio::explain::tests
