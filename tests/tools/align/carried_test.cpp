// A lamp on a robot's tool: align finds it at every pose of the tool, handeye --light finds where it sits on the tool.
// One process: AlignCarried.*
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <iostream>

#include "base/text.h"
#include "manifest/sections/alignment.h"
#include "manifest/sections/light.h"
#include "manifest/sections/light_position.h"
#include "manifest/sections/mounting.h"
#include "wedge_scene.h"

namespace gonio::tests {
namespace {

class AlignCarried : public WedgeScene {
 protected:
  static constexpr int poses = 6;
  const Rigid<frame::World, frame::Base> world_from_base_{quaternion_of_rotation_vector({0, 0, 0.4}), {0.5, 0.2, -0.1}};
  const Vec3 light_in_tool_{0.03, -0.02, 0.1};

  Rigid<frame::Base, frame::Tool> base_from_tool(int k) const {
    const double turn = 2 * pi * k / poses;
    const Quaternion rotation =
        quaternion_of_rotation_vector({0.7 * std::sin(turn), 0.6 * std::cos(2 * turn), 0.5 * k});
    const Vec3 lamp{0.26 * std::cos(turn + 0.3), 0.24 * std::sin(turn + 0.3), 0.38 + 0.03 * (k % 3)};
    const Vec3 in_base = inverse(world_from_base_) * lamp;
    return {rotation, in_base - matrix_of(rotation) * light_in_tool_};
  }
  // Where from a lamp's shadow is seen, not hidden behind the wedge.
  static constexpr std::array<std::size_t, 6> beside{0, 1, 0, 0, 1, 1};
  // The scene with photographs, from two places, at these poses of the tool, of which masks are known; binary ones, as
  // somebody would paint them. The pose of image `without` is not told.
  std::string carried(const std::vector<int>& at = {0, 1, 2, 3, 4, 5}, std::size_t without = 99) {
    truth_.stations.push_back(
        {{quaternion_of_rotation_vector({0, 0, -pi / 2}) * quaternion_of_rotation_vector({-130 * pi / 180, 0, 0}),
          {-0.5, 0, 0.42}},
         0});
    truth_.lamps_m.clear();
    std::string images, outlines, files = R"("files": {"mesh": {"path": "wedge.ply"})";
    for (std::size_t lamp = 0; lamp < at.size(); ++lamp) {
      const int k = at[lamp];
      const std::size_t station = beside[static_cast<std::size_t>(k)];
      truth_.lamps_m.push_back(world_from_base_ * (base_from_tool(k) * light_in_tool_));
      const std::string id = format("v%zu", lamp), between = lamp > 0 ? ",\n" : "";
      images += between + R"({"id": ")" + id +
                R"(", "camera": "c", "light": "a", "robot": "arm", "world_from_camera": )" +
                text_of(truth_.stations[station].world_from_camera) +
                (lamp == without ? "" : R"(, "base_from_tool": )" + text_of(base_from_tool(k))) + "}";
      for (const std::string kind : {"object", "shadow"}) {
        write_binary(id + kind, kind == "object" ? alignment::RimSubject{station, 0, {}}
                                                 : alignment::RimSubject{station, 0, lamp});
        files += R"(, ")" + id + kind + R"(": {"path": ")" + id + kind + R"(.exr"})";
        outlines += (outlines.empty() ? "" : ",\n") + (R"({"image": ")" + id) + R"(", "object": "wedge", "kind": ")" +
                    kind + R"(", "mask": ")" + id + kind + R"("})";
      }
    }
    std::string text = scene();
    const auto first = text.find(R"("files")"), cameras = text.find(R"("cameras")");
    text.replace(first, cameras - first, files + R"(}, "robots": {"arm": {"model": "ur5"}},)" + "\n ");
    return text.substr(0, text.find(R"("images")")) + R"("images": [)" + images + "],\n \"outlines\": [" + outlines +
           "]}";
  }
  template <class Motion>
  static std::string text_of(const Motion& m) {
    return format(R"({"rotation": [%.17g, %.17g, %.17g, %.17g], "translation_m": [%.17g, %.17g, %.17g]})", m.rotation.w,
                  m.rotation.x, m.rotation.y, m.rotation.z, m.translation_m.x, m.translation_m.y, m.translation_m.z);
  }
  void write_binary(const std::string& name, const alignment::RimSubject& subject) {
    io::Image mask = mask_of(subject);
    for (float& share : mask.data) share = share > 0.5F ? 1.0F : 0.0F;
    io::write_picture(folder_ / (name + ".exr"), mask);
  }
};

TEST_F(AlignCarried, EveryPlaceGoesThroughThePipeToTheLampsPlaceOnTheTool) {
  const Ended aligned = align(carried(), {"--carried", "a"});
  ASSERT_EQ(aligned.status, 0) << aligned.err;
  const manifest::Document found = document_of(aligned);
  ASSERT_EQ(found.light_positions.size(), static_cast<std::size_t>(poses)) << aligned.err;
  for (std::size_t k = 0; k < found.light_positions.size(); ++k) {
    const manifest::LightPosition& p = found.light_positions[k];
    EXPECT_EQ(p.id, format("a-v%zu", k));
    EXPECT_EQ(p.light, "a");
    EXPECT_EQ(p.robot, "arm");
    EXPECT_EQ(p.covariance_m2.size(), 9U);
    for (std::size_t i = 0; i < 3; ++i) {
      const double truth = truth_.lamps_m[k][static_cast<int>(i)];
      EXPECT_LT(std::abs(p.position_m[i] - truth), 0.05) << p.id;  // of half a metre, by one short shadow
      EXPECT_LT(std::abs(p.position_m[i] - truth), 4 * p.sigma_m[i] + 1e-4) << p.id;  // 18 numbers: 1 in 900
    }
  }
  // A lamp that moves has no one place: where it is stated stays.
  EXPECT_EQ(found.lights.at("a").parameters.at("position_m").vector(), (Vec3{0.27, -0.17, 0.41}));
  ASSERT_EQ(found.alignments[0].lights.size(), static_cast<std::size_t>(poses));
  EXPECT_EQ(found.alignments[0].lights[2].images, std::vector<std::string>{"v2"});

  const Ended mounted = run({"handeye", "--light"}, folder_.path(), aligned.out);
  ASSERT_EQ(mounted.status, 0) << mounted.err;
  const manifest::Document calibrated = document_of(mounted);
  const manifest::Mounting& m = calibrated.mountings.at("a");
  ASSERT_EQ(m.light_in_tool_m.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const double off = m.light_in_tool_m[i] - light_in_tool_[static_cast<int>(i)];
    std::cout << format("light_in_tool %zu: off by %.2f mm, sigma %.2f mm\n", i, 1e3 * off,
                        1e3 * m.sigma.at("light_in_tool_m")[i]);
    EXPECT_LT(std::abs(off), 3 * m.sigma.at("light_in_tool_m")[i]);
    EXPECT_LT(m.sigma.at("light_in_tool_m")[i], 0.02);
  }
}

TEST_F(AlignCarried, PhotographsAtOnePoseShareOnePlace) {
  const Ended aligned = align(carried({0, 0}), {"--carried", "a"});
  ASSERT_EQ(aligned.status, 0) << aligned.err;
  const manifest::Document found = document_of(aligned);
  ASSERT_EQ(found.light_positions.size(), 1U);
  EXPECT_EQ(found.alignments[0].lights[0].images, (std::vector<std::string>{"v0", "v1"}));
}

TEST_F(AlignCarried, RefusesInOneLine) {
  refused(carried(), 64, "--carried: names \"b\", which is no light of the manifest", {"--carried", "b"});
  refused(carried({0, 1, 2, 3}, 3), 65, "/images/3/base_from_tool: is missing, and a tool carries \"a\"",
          {"--carried", "a"});
}

}  // namespace
}  // namespace gonio::tests
