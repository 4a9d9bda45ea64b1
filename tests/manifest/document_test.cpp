// Reading, checking and writing of the manifest: the contract of gonio-manifest(5).
#include "manifest/document.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/atomic_file.h"
#include "base/error.h"
#include "data.h"
#include "manifest/sections/board.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/image.h"
#include "manifest/sections/surface.h"

namespace gonio::manifest {
namespace {

using testing::HasSubstr;

Document parse(const std::string& text) {
  return parse_document(text, "rig.json", ".");
}

std::string refusal(const std::string& text, Exit code = Exit::data) {
  try {
    parse(text);
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), code) << e.what();
    return e.what();
  }
  ADD_FAILURE() << "accepted: " << text;
  return {};
}

TEST(Document, SaysWhoIsInASection) {
  Document d;
  d.cameras["left"].model = "fisheye";
  d.cameras["right"];
  d.images.resize(2);
  d.images[0].id = "second";
  d.images[1].id = "first";
  EXPECT_THAT(names_in(d, "cameras"), testing::ElementsAre("left", "right"));
  EXPECT_THAT(names_in(d, "images"), testing::ElementsAre("second", "first"));
  EXPECT_THAT(names_in(d, "boards"), testing::IsEmpty());
  EXPECT_THROW(names_in(d, "camera"), Error);  // a name that is none of the manifest's
  EXPECT_TRUE(has_entry(d, "images", "first"));
  EXPECT_FALSE(has_entry(d, "cameras", "first"));
  ASSERT_NE(find_camera(d, "left"), nullptr);
  EXPECT_EQ(find_camera(d, "left")->model, "fisheye");
  EXPECT_EQ(find_camera(d, "middle"), nullptr);
}

TEST(Document, CopiesAndMovesCarryTheSections) {
  Document d;
  d.cameras["c"].width_px = 7;
  d.images.emplace_back().id = "i";
  Document copy = d;
  copy.cameras["c"].width_px = 8;
  EXPECT_EQ(d.cameras.at("c").width_px, 7);
  const Document moved = std::move(copy);
  EXPECT_EQ(moved.cameras.at("c").width_px, 8);
  EXPECT_EQ(moved.images.at(0).id, "i");
}

TEST(Document, PracticeManifestsReadAndAreWrittenAsTheyWere) {
  GONIO_NEEDS_DATA("recordings");
  for (int i = 1; i <= 6; ++i) {
    const auto path = tests::data("recordings") / ("practice-" + std::to_string(i) + ".json");
    const Document d = read_document(path);
    EXPECT_EQ(d.images.size(), 9u);
    EXPECT_TRUE(d.surfaces.at("bunny").parameters.at("albedo").free);
    EXPECT_EQ(canonical_json(to_value(d, d.folder)), canonical_json(parse_json(read_file(path), "again")));
  }
}

TEST(Document, UntouchedEntriesKeepTheirFormAndOwnKeys) {
  const std::string text =
      R"({"gonio":1,"x-note":"mine","cameras":{"c":{"fx_px":{"value":5,"free":true},"width_px":4,"x-lens":"25 mm"}},)"
      R"("images":[{"id":"a","world_from_camera":{"matrix":[[1,0,0,0.10000000000000001],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}}]})";
  Document d = parse(text);
  d.boards["b"].kind = "checkerboard";
  d.boards["b"].square_m = 0.025;
  Value expected = parse_json(text, "");
  expected["boards"] = parse_json(R"({"b":{"kind":"checkerboard","square_m":0.025}})", "");
  EXPECT_EQ(canonical_json(to_value(d, ".")), canonical_json(expected));
  d.cameras["c"].height_px = 3;  // a changed entry is written anew, its x- keys stay
  const Value changed = to_value(d, ".");
  EXPECT_EQ(changed.find("cameras")->find("c")->find("x-lens")->as_string(), "25 mm");
  EXPECT_EQ(changed.find("cameras")->find("c")->find("height_px")->as_integer(), 3);
}

TEST(Document, RefusalsNamePlaceValueAndRemedy) {
  EXPECT_THAT(refusal(R"({"gonio":1,"camera":{}})"),
              HasSubstr("rig.json#/camera: is not a key that gonio knows; did you mean \"cameras\"?"));
  EXPECT_THAT(refusal(R"({"gonio":1,"cameras":{"c":{"fx":3}}})"), HasSubstr("rig.json#/cameras/c/fx"));
  EXPECT_THAT(refusal(R"({"gonio":1,"cameras":{"c":{"fx_px":-3}}})"), HasSubstr("is -3 px, more than 0 px is needed"));
  EXPECT_THAT(refusal(R"({"gonio":1,"images":[{"id":"a","camera":"c"}]})"),
              HasSubstr("rig.json#/images/0/camera: names \"c\""));
  EXPECT_THAT(refusal(R"({"gonio":1,"images":[{"id":"a"},{"id":"a"}]})"), HasSubstr("stands twice"));
  EXPECT_THAT(refusal(R"({"gonio":1,"gonio":1})"), HasSubstr("stands twice"));
  EXPECT_THAT(refusal(R"({"gonio":2})"), HasSubstr("rig.json#/gonio"));
  EXPECT_THAT(refusal(R"({})"), HasSubstr("is not a gonio manifest"));
  EXPECT_THAT(
      refusal(
          R"({"gonio":1,"images":[{"id":"a","world_from_camera":{"rotation":[1,0.1,0,0],"translation_m":[0,0,0]}}]})"),
      HasSubstr("1 within 1e-6"));
  EXPECT_THAT(
      refusal(
          R"({"gonio":1,"images":[{"id":"a","world_from_camera":{"matrix":[[1,0.03,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}}]})"),
      HasSubstr("rotation is not orthonormal (|R'R - I| = 0.03, limit 1e-6); re-export with 7 digits"));
  EXPECT_THAT(refusal(R"({"gonio":1,"images":[{"id":"a","world_from_camera":{"translation_m":[NaN,0,0]}}]})"),
              HasSubstr("parse error"));
  EXPECT_THAT(refusal(R"({"gonio":1,"images":[{"id":"a","world_from_camera":{"translation_m":[1e999,0,0]}}]})"),
              HasSubstr("rig.json"));
  EXPECT_THAT(refusal(R"({"gonio":1,"lights":{"l":{"model":"pont"}}})"), HasSubstr("did you mean \"point\"?"));
  EXPECT_THAT(refusal("{\"gonio\":1,"), HasSubstr("is not JSON"));
}

TEST(Document, ContentIdLeavesOutTimeAndHost) {
  Document a = parse(R"({"gonio":1})"), b = a;
  Step step{.program = "render",
            .version = "1",
            .options = Value::object({{"spp", 4}}),
            .input_hashes = {"ff"},
            .input_id = ""};
  record_step(a, step);
  record_step(b, step);
  b.provenance["runs"]["any"] = Value::object({{"time", "another day"}, {"host", "another host"}});
  EXPECT_EQ(content_id(a), content_id(b));
  step.options["spp"] = 5;
  Document c = parse(R"({"gonio":1})");
  record_step(c, step);
  EXPECT_NE(content_id(a), content_id(c));
}

}  // namespace
}  // namespace gonio::manifest
