// Links of frames that contradict each other are refused, those that agree within what they state are taken.
#include "manifest/frame_loops.h"
#include "manifest/sections/frame_link.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "base/random.h"
#include "base/text.h"

namespace gonio::manifest {
namespace {

using testing::AllOf;
using testing::HasSubstr;

struct AnyFrame {};
using Motion = Rigid<AnyFrame, AnyFrame>;

// "" where it is accepted.
std::string refusal(const std::vector<Link>& links) {
  Document d;
  d.name = "rig.json";
  d.frames = links;
  try {
    check_frames(d);
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), Exit::data);
    EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
    return e.what();
  }
  return {};
}

Link link(const std::string& to, const std::string& from, const Motion& m) {
  return {to, from, m.rotation, m.translation_m, {}};
}
Link with_sigma(Link l, double rotation_rad, double translation_m) {
  l.sigma = PoseSigma{{rotation_rad}, {translation_m}};
  return l;
}

Motion some_motion(Random& random) {
  const auto number = [&] { return random.uniform(-1, 1); };
  return {quaternion_of_rotation_vector({3 * number(), number(), 2 * number()}), {number(), 2 * number(), number()}};
}

// base <- column <- tool <- camera, and base <- camera: a loop that closes.
std::vector<Link> closed_loop(std::uint64_t seed = 1) {
  Random random(seed);
  const Motion a = some_motion(random), b = some_motion(random), c = some_motion(random);
  return {link("base", "column", a), link("camera", "tool", inverse(c)), link("column", "tool", b),
          link("base", "camera", a * b * c)};
}

TEST(FrameLoops, ChainsAndLoopsThatCloseAreTaken) {
  EXPECT_EQ(refusal({}), "");
  for (std::uint64_t seed = 0; seed < 50; ++seed) EXPECT_EQ(refusal(closed_loop(seed)), "");
}

TEST(FrameLoops, AContradictionIsNamedWithItsSize) {
  std::vector<Link> links = closed_loop();
  links[3].translation_m.y += 0.005;
  EXPECT_THAT(refusal(links),
              AllOf(HasSubstr("rig.json#/frames/3: \"base\" from \"camera\" contradicts the way by column, tool "
                              "(/frames/0, /frames/2, /frames/1): off by 5 mm and "),
                    HasSubstr("(limits 0.0"), HasSubstr("; correct one of these links, or state their sigma")));
  links = closed_loop();
  links[3].rotation = quaternion_of_rotation_vector({0, 0, 2 * pi / 180}) * links[3].rotation;
  EXPECT_THAT(refusal(links), HasSubstr("off by 0 mm and 2 degrees"));
}

// The same loop, whichever link comes last and whichever way round the links stand.
TEST(FrameLoops, EveryOrderAndDirectionFindsIt) {
  std::vector<Link> links = closed_loop();
  links[3].translation_m.y += 0.005;
  std::vector<std::size_t> order{0, 1, 2, 3};
  do {
    for (int turned = 0; turned < 16; ++turned) {
      std::vector<Link> shown;
      for (const std::size_t k : order) {
        const Motion m{links[k].rotation, links[k].translation_m};
        shown.push_back((turned >> k & 1) != 0 ? link(links[k].from, links[k].to, inverse(m)) : links[k]);
      }
      EXPECT_THAT(refusal(shown), HasSubstr("off by 5 mm and "));
    }
  } while (std::ranges::next_permutation(order).found);
}

TEST(FrameLoops, DigitsThatAreWrittenClose) {
  std::vector<Link> links = closed_loop();
  for (Link& l : links) {
    const auto rounded = [](double v, double step) { return std::round(v / step) * step; };
    l.translation_m = {rounded(l.translation_m.x, 1e-5), rounded(l.translation_m.y, 1e-5),
                       rounded(l.translation_m.z, 1e-5)};
    l.rotation = {rounded(l.rotation.w, 1e-6), rounded(l.rotation.x, 1e-6), rounded(l.rotation.y, 1e-6),
                  rounded(l.rotation.z, 1e-6)};
  }
  EXPECT_EQ(refusal(links), "");
}

// Noise as the links state it, of every shape: none of 300 loops is refused, and a misfit of nine deviations is.
TEST(FrameLoops, WhatIsStatedDecides) {
  Random random(5);
  int refused = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    std::vector<Link> links = closed_loop(seed);
    for (std::size_t k = 0; k < links.size(); ++k) {
      const double turn = k % 2 == 0 ? 1e-3 : 1e-4, shift = k < 2 ? 2e-3 : 1e-4;
      const Vec3 d{turn * random.normal(), turn * random.normal(), turn * random.normal()};
      links[k].rotation = quaternion_of_rotation_vector(d) * links[k].rotation;
      links[k].translation_m += Vec3{shift * random.normal(), shift * random.normal(), shift * random.normal()};
      links[k] = with_sigma(links[k], turn, shift);
    }
    EXPECT_EQ(refusal(links), "") << seed;
    links[3].translation_m += {0.1, 0, 0};
    refused += !refusal(links).empty();
  }
  EXPECT_EQ(refused, 300);
}

// A stated turn acts through the lever of what lies behind it: by simulation, the loop's scatter is what is predicted.
TEST(FrameLoops, TheLimitIsTheScatterOfTheLoopsEnd) {
  Random random(7);
  std::vector<Link> links = closed_loop(3);
  links[0] = with_sigma(links[0], 2e-3, 1e-5);
  links[1] = with_sigma(links[1], 1e-3, 1e-5);
  double beyond = 0;
  constexpr int draws = 4000;
  for (int i = 0; i < draws; ++i) {
    std::vector<Link> drawn = links;
    for (const std::size_t k : {0u, 1u}) {
      const double turn = links[k].sigma->rotation_rad[0] * 2.5, shift = links[k].sigma->translation_m[0] * 2.5;
      const Vec3 d{turn * random.normal(), turn * random.normal(), turn * random.normal()};
      drawn[k].rotation = quaternion_of_rotation_vector(d) * drawn[k].rotation;
      drawn[k].translation_m += Vec3{shift * random.normal(), shift * random.normal(), shift * random.normal()};
    }
    beyond += !refusal(drawn).empty();
  }
  // 2.5 times the stated noise: the turn alone, three normal numbers, exceeds 5.5 / 2.5 deviations in 18.2 % of draws;
  // the shift adds less than as much again.
  EXPECT_GT(beyond / draws, 0.16);
  EXPECT_LT(beyond / draws, 0.37);
}

TEST(FrameLoops, ALinkToItselfIsRefused) {
  EXPECT_EQ(refusal({link("base", "base", {})}),
            "rig.json#/frames/0: is a link from \"base\" to itself; name two frames, or leave it out");
}

TEST(FrameLoops, ALinkThatStandsTwiceMustSayTheSame) {
  std::vector<Link> links = closed_loop();
  links.push_back(links[1]);
  EXPECT_EQ(refusal(links), "");
  Quaternion& q = links[4].rotation;
  q = {-q.w, -q.x, -q.y, -q.z};  // the same rotation
  EXPECT_EQ(refusal(links), "");
  links[4].translation_m.z += 0.001;
  EXPECT_THAT(refusal(links),
              HasSubstr("rig.json#/frames/4: \"camera\" from \"tool\" stands twice with different values "
                        "(/frames/1): off by 1 mm and "));
  for (Link& l : links) l = with_sigma(l, 0.01, 0.01);  // which of the two holds, a sigma does not say
  EXPECT_THAT(refusal(links), HasSubstr("stands twice with different values"));
}

TEST(FrameLoops, TheInverseOfALinkMustSayTheSame) {
  Random random(2);
  const Motion m = some_motion(random);
  std::vector<Link> links{link("world", "base", m), link("base", "world", inverse(m))};
  EXPECT_EQ(refusal(links), "");
  links[1].translation_m.x += 0.01;
  EXPECT_THAT(refusal(links), HasSubstr("rig.json#/frames/1: \"base\" from \"world\" contradicts what the other link "
                                        "says (/frames/0): off by 10 mm and "));
  EXPECT_EQ(refusal({with_sigma(links[0], 0, 0.003), links[1]}), "");
}

TEST(FrameLoops, ManyFramesAreNoBurden) {
  std::vector<Link> links;
  for (int i = 0; i < 4000; ++i)
    links.push_back(link(format("f%d", i), format("f%d", i + 1), {{1, 0, 0, 0}, {1e-3, 0, 0}}));
  EXPECT_EQ(refusal(links), "");
  links.push_back(link("f0", "f4000", {{1, 0, 0, 0}, {4, 0, 0}}));
  EXPECT_EQ(refusal(links), "");
  links.back().translation_m.x = 5;
  EXPECT_THAT(refusal(links), HasSubstr("off by 1000 mm"));
}

TEST(FrameLoops, AManifestIsRefusedWhenItIsRead) {
  const auto text = [](double x) {
    return format(R"({"gonio": 1, "frames": [
      {"to": "world", "from": "base", "rotation": [1, 0, 0, 0], "translation_m": [0, 0, 1]},
      {"to": "base", "from": "board", "rotation": [1, 0, 0, 0], "translation_m": [0.5, 0, 0]},
      {"to": "world", "from": "board", "rotation": [1, 0, 0, 0], "translation_m": [%g, 0, 1]}]})",
                  x);
  };
  EXPECT_NO_THROW(parse_document(text(0.5), "rig.json", "."));
  try {
    parse_document(text(0.4), "rig.json", ".");
    FAIL() << "was accepted";
  } catch (const Error& e) {
    EXPECT_THAT(e.what(),
                HasSubstr("rig.json#/frames/2: \"world\" from \"board\" contradicts the way by base (/frames/0, "
                          "/frames/1): off by 100 mm and 0 degrees (limits 0.0"
                          "13 mm, 0.0011 degrees); correct one"));
  }
}

}  // namespace
}  // namespace gonio::manifest
