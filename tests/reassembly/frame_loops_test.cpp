// Every mistake with a name is found under its name, in graphs without symmetry; graphs whose links are true pass as
// often as stated.
#include "reassembly/frame_loops.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/random.h"
#include "manifest/sections/frame_link.h"
#include "manifest/sections/image.h"
#include "manifest/sections/object.h"
#include "manifest/sections/rig.h"
#include "stats/intervals.h"

namespace gonio::reassembly {
namespace {

using manifest::FrameEdge;
using manifest::FrameMistake;
using manifest::Motion;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr double turn_sd = 1e-3, shift_sd = 1e-3;

Motion any_motion(Random& random) {
  const auto number = [&] { return random.uniform(-1, 1); };
  return {quaternion_of_rotation_vector({2 * number(), 2 * number(), 2 * number()}), {number(), number(), number()}};
}

// Where each frame stands in the first, and links between them with noise as stated.
struct Laboratory {
  std::vector<Motion> place;
  std::vector<FrameEdge> edges;
  Random random;

  Laboratory(std::size_t frames, std::uint64_t seed) : place(frames), random(seed, 220) {
    for (std::size_t k = 1; k < frames; ++k) place[k] = any_motion(random);
  }
  static std::string name(std::size_t k) {
    return std::array{"world", "left", "right", "board", "piece", "tool", "lamp", "stand"}.at(k);
  }
  void link(std::size_t to, std::size_t from, double noise = 1) {
    FrameEdge e{name(to), name(from), inverse(place[to]) * place[from], {}, "#/" + std::to_string(edges.size())};
    const auto number = [&](double sd) { return noise * sd * random.normal(); };
    const Vec3 d{number(turn_sd), number(turn_sd), number(turn_sd)};
    e.to_from.rotation = quaternion_of_rotation_vector(d) * e.to_from.rotation;
    e.to_from.translation_m += Vec3{number(shift_sd), number(shift_sd), number(shift_sd)};
    e.covariance = covariance_of(manifest::PoseSigma{{turn_sd}, {shift_sd}});
    edges.push_back(e);
  }
  // Each frame is reached by three ways and more: every link stands in two loops that share nothing else.
  void link_all() {
    for (std::size_t to = 0; to < place.size(); ++to)
      for (std::size_t from = to + 1; from < place.size(); ++from) link(to, from);
  }
};

struct Mistake {
  FrameMistake made;
  char axis;
  const char* words;
};

class NamedMistake : public testing::TestWithParam<Mistake> {};

// mended() undoes a mistake; made twice, or the other way round, it is the mistake.
Motion spoiled(const Motion& m, const Mistake& mistake) {
  switch (mistake.made) {
    case FrameMistake::millimetres: return mended(m, FrameMistake::metres, ' ');
    case FrameMistake::metres: return mended(m, FrameMistake::millimetres, ' ');
    case FrameMistake::scalar_last: return {{m.rotation.x, m.rotation.y, m.rotation.z, m.rotation.w}, m.translation_m};
    default: return mended(m, mistake.made, mistake.axis);
  }
}

TEST_P(NamedMistake, IsFoundByNameInWhicheverLink) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    Laboratory lab(5, seed);
    lab.link_all();
    ASSERT_EQ(check_loops(lab.edges).sentence, "");
    for (std::size_t e = 0; e < lab.edges.size(); ++e) {
      std::vector<FrameEdge> wrong = lab.edges;
      wrong[e].to_from = spoiled(wrong[e].to_from, GetParam());
      const manifest::LoopCheck check = check_loops(wrong);
      ASSERT_EQ(check.faults.size(), 1u) << check.sentence;
      EXPECT_EQ(check.faults[0].edge, e);
      EXPECT_EQ(check.faults[0].mistake, GetParam().made);
      EXPECT_EQ(check.faults[0].axis, GetParam().axis);
      EXPECT_THAT(check.sentence, HasSubstr("\"" + wrong[e].to + "\" from \"" + wrong[e].from + "\" (#/" +
                                            std::to_string(e) + ") " + GetParam().words));
      EXPECT_THAT(check.sentence, Not(HasSubstr("; or ")));
    }
  }
}
INSTANTIATE_TEST_SUITE_P(
    All, NamedMistake,
    testing::Values(Mistake{FrameMistake::inverted, ' ', "is inverted, or the names of its two frames are swapped"},
                    Mistake{FrameMistake::rotation_inverted, ' ', "has its rotation inverted"},
                    Mistake{FrameMistake::mirrored, 'x', "is left-handed: x counts"},
                    Mistake{FrameMistake::mirrored, 'y', "is left-handed: y counts"},
                    Mistake{FrameMistake::mirrored, 'z', "is left-handed: z counts"},
                    Mistake{FrameMistake::flipped_from, 'x', "has axes of"},
                    Mistake{FrameMistake::flipped_from, 'y', "has axes of"},
                    Mistake{FrameMistake::flipped_from, 'z', "has axes of"},
                    Mistake{FrameMistake::flipped_to, 'x', "has axes of"},
                    Mistake{FrameMistake::flipped_to, 'y', "has axes of"},
                    Mistake{FrameMistake::flipped_to, 'z', "has axes of"},
                    Mistake{FrameMistake::millimetres, ' ', "has its translation in millimetres"},
                    Mistake{FrameMistake::metres, ' ', "has a translation a thousand times too small"},
                    Mistake{FrameMistake::scalar_last, ' ', "has its quaternion written x, y, z, w"}));

TEST(NamedMistakes, LeftForRightIsFoundWhereverItStands) {
  for (std::uint64_t seed = 0; seed < 4; ++seed)
    for (const std::size_t seen : {0u, 3u, 4u}) {  // from the world, the board, the piece
      Laboratory lab(5, seed);
      lab.link_all();
      const auto index = [&](std::size_t camera) {
        return static_cast<std::size_t>(
            std::ranges::find_if(lab.edges,
                                 [&](const FrameEdge& e) {
                                   return (e.to == lab.name(seen) && e.from == lab.name(camera)) ||
                                          (e.from == lab.name(seen) && e.to == lab.name(camera));
                                 }) -
            lab.edges.begin());
      };
      const std::size_t left = index(1), right = index(2);
      std::swap(lab.edges[left].to_from, lab.edges[right].to_from);
      const manifest::LoopCheck check = check_loops(lab.edges);
      ASSERT_EQ(check.faults.size(), 1u) << check.sentence;
      EXPECT_EQ(check.faults[0].mistake, FrameMistake::exchanged);
      EXPECT_THAT(check.sentence, HasSubstr("are exchanged: left for right"));
      EXPECT_EQ(std::minmax(check.faults[0].edge, check.faults[0].other), std::minmax(left, right));
    }
}

// One loop cannot say on which side of a frame its axes were flipped: both are named.
TEST(NamedMistakes, WhatOneLoopCannotTellApartIsNamedTogether) {
  Laboratory lab(3, 1);
  lab.link_all();
  lab.edges[0].to_from = mended(lab.edges[0].to_from, FrameMistake::flipped_from, 'x');
  const manifest::LoopCheck check = check_loops(lab.edges);
  EXPECT_THAT(check.sentence,
              HasSubstr("\"world\" from \"left\" (#/0) has axes of \"left\" flipped: half a turn about x"));
  EXPECT_THAT(check.sentence,
              HasSubstr("\"left\" from \"right\" (#/2) has axes of \"left\" flipped: half a turn about x"));
}

TEST(NamedMistakes, WhatHasNoNameIsSaidToHaveNone) {
  Laboratory lab(5, 2);
  lab.link_all();
  lab.edges[3].to_from.translation_m.y += 0.05;
  const manifest::LoopCheck check = check_loops(lab.edges);
  EXPECT_THAT(check.faults, IsEmpty());
  EXPECT_THAT(check.sentence, HasSubstr("no single mistake explains it; look at "));
  EXPECT_THAT(check.sentence, HasSubstr("off by 5"));
  EXPECT_THAT(check.sentence, HasSubstr(lab.edges[3].place));
}

TEST(TrueFrames, AGraphWithoutLoopsSaysSo) {
  Laboratory lab(4, 1);
  lab.link(0, 1), lab.link(0, 2), lab.link(3, 2);
  const manifest::LoopCheck check = check_loops(lab.edges);
  EXPECT_EQ(check.sentence, "");
  EXPECT_EQ(check.remark, "the frames make no loop: nothing checks their 3 links");
  lab.link(3, 0);
  EXPECT_EQ(check_loops(lab.edges).remark, "");
}

// Random graphs whose links have the noise that they state: at most the stated share is called broken. 5 % of 400 with
// a margin of the binomial law's 1 in 10^5 (Bonferroni is no sharper than this); single loops' p-values are uniform.
TEST(TrueFrames, AreCalledBrokenAsRarelyAsStated) {
  constexpr int graphs = 400;
  int broken = 0, below = 0, loops = 0;
  for (std::uint64_t seed = 0; seed < graphs; ++seed) {
    Laboratory lab(3 + seed % 6, 1000 + seed);
    for (std::size_t k = 1; k < lab.place.size(); ++k) lab.link(lab.random.below(static_cast<std::uint32_t>(k)), k);
    for (int extra = 0; extra < 1 + static_cast<int>(seed % 4); ++extra) {
      const auto a = lab.random.below(static_cast<std::uint32_t>(lab.place.size()));
      const auto b = lab.random.below(static_cast<std::uint32_t>(lab.place.size()));
      if (a != b) lab.link(a, b);
    }
    const manifest::LoopCheck check = check_loops(lab.edges, 0.05);
    broken += check.broken.empty() ? 0 : 1;
    loops += static_cast<int>(check.p.size());
    for (const double p : check.p) below += p < 0.25;
  }
  EXPECT_LT(broken, 40);
  EXPECT_GT(broken, 4) << "the test can be passed";
  EXPECT_NEAR(below, 0.25 * loops, 5 * std::sqrt(0.25 * 0.75 * loops));
}

// Two cameras of a rig, a board on the stand, the stand's pose: what a scene says of itself, gathered.
manifest::Document scene() {
  Random random(9);
  const Motion left = any_motion(random), right = any_motion(random), stand = any_motion(random),
               stand_board = any_motion(random), rig_right = inverse(left) * right;
  manifest::Document d;
  d.name = "scene.json";
  const auto pose_as = [&](auto& pose, const Motion& m) {
    pose.emplace();
    pose->rotation = m.rotation;
    pose->translation_m = m.translation_m;
  };
  d.frames.push_back({"stand", "board", stand_board.rotation, stand_board.translation_m, {}});
  manifest::Object object;
  object.id = "stand";
  pose_as(object.world_from_object, stand);
  d.objects.push_back(object);
  for (const Motion* camera : {&left, &right}) {
    manifest::ImageEntry image;
    image.id = camera == &left ? "l1" : "r1";
    image.camera = camera == &left ? "left" : "right";
    image.shot = "1";
    image.board = "board";
    pose_as(image.world_from_camera, *camera);
    pose_as(image.camera_from_board, inverse(*camera) * stand * stand_board);
    d.images.push_back(image);
  }
  manifest::Rig rig;
  rig.cameras.resize(2);
  rig.cameras[0].camera = "left";
  rig.cameras[1].camera = "right";
  rig.cameras[1].rig_from_camera.rotation = rig_right.rotation;
  rig.cameras[1].rig_from_camera.translation_m = rig_right.translation_m;
  d.rigs["pair"] = rig;
  return d;
}

TEST(SceneFrames, AreGatheredAndChecked) {
  const manifest::Document d = scene();
  EXPECT_EQ(frame_edges(d).size(), 8u);
  EXPECT_EQ(manifest::check_loops(frame_edges(d)).loops.size(), 3u);
  EXPECT_EQ(frame_loop_complaint(d), "");
}

TEST(SceneFrames, MistakesAreNamedWhereTheyStand) {
  manifest::Document d = scene();
  d.images[0].world_from_camera->translation_m *= 1000;
  EXPECT_THAT(frame_loop_complaint(d), HasSubstr("\"world\" from \"camera of image l1\" "
                                                 "(scene.json#/images/0/world_from_camera) has its translation in "
                                                 "millimetres, not metres"));
  d = scene();
  std::swap(d.images[0].camera, d.images[1].camera);
  EXPECT_THAT(frame_loop_complaint(d), HasSubstr("left for right"));
  d = scene();
  static_cast<Rigid<frame::World, frame::Camera>&>(*d.images[1].world_from_camera) = {
      inverse(*d.images[1].world_from_camera).rotation, inverse(*d.images[1].world_from_camera).translation_m};
  EXPECT_THAT(frame_loop_complaint(d), HasSubstr("(scene.json#/images/1/world_from_camera) is inverted"));
  d.images[1].weight = 0;
  EXPECT_EQ(frame_loop_complaint(d), "") << "an image that does not count";
}

}  // namespace
}  // namespace gonio::reassembly
