// The built-in bowl and lid, photographed, reassembled by the program, held against where they stood; and everything
// that people turn round, which is caught by name.
// One process: Reassembled.*
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>

#include "base/atomic_file.h"
#include "data.h"
#include "manifest/document.h"
#include "manifest/sections/object.h"
#include "manifest/sections/placement.h"
#include "manifest/sections/volume.h"
#include "manifest/value.h"
#include "process.h"
#include "reassembly/specimen.h"

namespace gonio::tests {
namespace {

using manifest::Value;
using testing::HasSubstr;

class Reassembled : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const manifest::Document rig = reassembly::specimen(folder().path(), {.width_px = 640, .height_px = 480, .spp = 4});
    write_file(folder() / "rig.json", manifest::print_document(rig, folder().path()));
  }
  static ScratchFolder& folder() {
    static ScratchFolder made;
    return made;
  }
  static void changed(const char* name, const char* as, const std::function<void(Value&)>& how) {
    Value document = manifest::parse_json(read_file(folder() / name), name);
    how(document);
    write_file(folder() / as, manifest::print_json(document));
  }
  static Ended reassembled(const std::string& rig, const std::string& bowl, const char* out,
                           const Process::Words& more = {}) {
    Process::Words words{"reassemble",
                         rig,
                         "--piece",
                         "bowl=" + bowl,
                         "--piece",
                         "lid=lid.json",
                         "--out",
                         out,
                         "--force",
                         "-o",
                         std::string(out) + ".json",
                         "--log-level",
                         "error"};
    words.insert(words.end(), more.begin(), more.end());
    return run(words, folder().path());
  }
  static const manifest::Placement& placement(const manifest::Document& document, const std::string& object) {
    for (const manifest::Placement& p : document.placements)
      if (p.object == object) return p;
    throw std::runtime_error("no placement of " + object);
  }
};

TEST_F(Reassembled, PiecesStandWhereTheyStood) {
  const Ended ended = reassembled("rig.json", "bowl.json", "plain",
                                  {"--marker-surface", "marker", "--background", "table.ply", "--contact", "elastic"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const manifest::Document scene = manifest::read_document(folder() / "plain.json");
  const manifest::Document truth = manifest::read_document(folder() / "truth.json");
  for (const char* name : {"bowl", "lid"}) {
    const manifest::Placement& p = placement(scene, name);
    EXPECT_EQ(p.verdict, "placed");
    EXPECT_GE(p.pairs.size(), 5U);
    const auto& there = *std::ranges::find(truth.objects, name, &manifest::Object::id)->world_from_object;
    const Vec3 off = p.world_from_object->translation_m - there.translation_m;
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_LT(std::abs(off[axis]), 4 * p.world_from_object->sigma->translation_m[static_cast<std::size_t>(axis)])
          << name << " " << axis;
    EXPECT_LT(norm(off), 3e-4) << name;
  }
  const Ended checked = run({"scene", "check", "plain.json"}, folder().path());
  EXPECT_EQ(checked.status, 0) << checked.err;
  EXPECT_EQ(checked.err, "");
}

TEST_F(Reassembled, WhatPeopleTurnRoundIsCaughtByName) {
  const auto markers = [](Value& d, const std::function<void(Value&)>& how) {
    for (Value& marker : d["markers"].as_array()) how(marker["centre_m"]);
  };
  const auto mirrored = [](std::size_t axis) {
    return [axis](Value& centre) { centre.as_array()[axis] = -centre.as_array()[axis].as_number(); };
  };
  for (const std::size_t axis : {0UL, 1UL, 2UL}) {
    changed("bowl.json", "turned.json", [&](Value& d) { markers(d, mirrored(axis)); });
    const Ended ended = reassembled("rig.json", "turned.json", "turned");
    EXPECT_EQ(ended.status, 2);
    EXPECT_THAT(ended.err, HasSubstr("mirror")) << axis;
  }
  changed("bowl.json", "turned.json", [&](Value& d) {
    markers(d, [](Value& centre) {
      for (Value& x : centre.as_array()) x = 1000 * x.as_number();
    });
    for (Value& marker : d["markers"].as_array()) {
      marker["radius_m"] = 1000 * marker["radius_m"].as_number();
      for (Value& c : marker["covariance_m2"].as_array()) c = 1e6 * c.as_number();
    }
  });
  const Ended large = reassembled("rig.json", "turned.json", "turned");
  EXPECT_EQ(large.status, 2);
  EXPECT_THAT(large.err, HasSubstr("mm"));
  EXPECT_EQ(placement(manifest::read_document(folder() / "turned.json"), "bowl").verdict, "scaled");

  // Left for right: the photographs of the two cameras are exchanged.
  changed("rig.json", "swapped.json", [](Value& d) {
    auto& images = d["images"].as_array();
    for (std::size_t i = 0; i + 1 < images.size(); i += 2) std::swap(images[i]["file"], images[i + 1]["file"]);
  });
  const Ended swapped = reassembled("swapped.json", "bowl.json", "swapped");
  EXPECT_EQ(swapped.status, 2);
  EXPECT_THAT(swapped.err, HasSubstr("left for right"));

  // Poses the other way round: camera_from_world for world_from_camera.
  changed("rig.json", "inverted.json", [](Value& d) {
    for (Value& image : d["images"].as_array()) {
      auto& q = image["world_from_camera"]["rotation"].as_array();
      for (std::size_t k = 1; k < 4; ++k) q[k] = -q[k].as_number();
    }
  });
  const Ended inverted = reassembled("inverted.json", "bowl.json", "inverted");
  EXPECT_EQ(inverted.status, 2);
  EXPECT_THAT(inverted.err, HasSubstr("not placed"));
}

}  // namespace
}  // namespace gonio::tests
