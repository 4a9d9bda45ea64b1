// The list of images for those who do not see its fields: who is in it, where files lie, entering and leaving.
#include "manifest/image_list.h"

#include <gmock/gmock.h>

#include "base/atomic_file.h"
#include "base/error.h"
#include "data.h"
#include "manifest/document.h"
#include "manifest/value.h"

namespace gonio::manifest {
namespace {

using testing::ElementsAre;

constexpr const char* three = R"({"gonio": 1, "files": {"p": {"path": "p.exr"}, "m": {"path": "m.png"}},
  "cameras": {"left": {}, "right": {}},
  "images": [{"id": "b", "camera": "left", "file": "p", "mask": "m", "x-note": "kept"},
             {"id": "a", "camera": "right", "file": "p"}, {"id": "c"}]})";

TEST(ImageList, SaysWhoIsInItAndWhichCameraTookIt) {
  const Document d = parse_document(three, "t", ".");
  EXPECT_EQ(index_of_image(d, "a"), 1U);
  EXPECT_EQ(index_of_image(d, "d"), std::nullopt);
  EXPECT_EQ(camera_of_image(d, 1), "right");
  EXPECT_EQ(camera_of_image(d, 2), "");
}

TEST(ImageList, SaysWhereFilesLie) {
  const tests::ScratchFolder folder;
  const Document d = parse_document(three, "t", folder.path());
  EXPECT_THROW(picture_path(d, 1), Error);  // it is not there
  for (const char* name : {"p.exr", "m.png"}) write_file(folder / name, "-");
  const auto picture = folder / "p.exr", mask = folder / "m.png";
  EXPECT_EQ(picture_path(d, 0), picture);
  EXPECT_EQ(mask_path(d, 0), mask);
  EXPECT_EQ(mask_path(d, 1), "");
  EXPECT_THAT(files_of_image(d, 0), ElementsAre(picture, mask));
  EXPECT_THAT(files_of_image(d, 1), ElementsAre(picture));
  EXPECT_TRUE(files_of_image(d, 2).empty());
  try {
    picture_path(d, 2);
    ADD_FAILURE() << "an image without a file";
  } catch (const Error& error) {
    EXPECT_EQ(error.place(), "t#/images/2/file");
  }
}

TEST(ImageList, PlannedImagesAreEnteredAsTheyArePlanned) {
  Document d = parse_document(
      R"({"gonio": 1, "cameras": {"c": {}}, "lights": {"lamp": {"model": "uniform", "radiance": [1, 1, 1]}}})", "t",
      ".");
  enter_image(d, {.id = "bare", .camera = "c"});
  enter_image(d, {.id = "whole",
                  .camera = "c",
                  .world_from_camera = {{{0, 1, 0, 0}, {1, 2, 3}}, PoseSigma{{1e-3}, {1e-4}}},
                  .light = {"lamp"},
                  .noise = Noise{.gain = 100, .read = 0.5},
                  .group = "before"});
  const Value images = *to_value(d, ".").find("images");
  EXPECT_EQ(print_json(images.as_array().at(0), -1),
            R"({"id":"bare","camera":"c",)"
            R"("world_from_camera":{"rotation":[1.0,0.0,0.0,0.0],"translation_m":[0.0,0.0,0.0]}})");
  EXPECT_EQ(print_json(images.as_array().at(1), -1),
            R"({"id":"whole","camera":"c","world_from_camera":{"rotation":[0.0,1.0,0.0,0.0],)"
            R"("translation_m":[1.0,2.0,3.0],"sigma":{"rotation_rad":[0.001],"translation_m":[1e-04]}},)"
            R"("light":"lamp","noise":{"gain":100.0,"read":0.5},"group":"before"})");
}

TEST(ImageList, ThoseThatAreKeptStayAsTheyWereInTheirOrder) {
  Document d = parse_document(three, "t", ".");
  keep_images(d, {"a", "b", "not there"});
  EXPECT_THAT(names_in(d, "images"), ElementsAre("b", "a"));
  EXPECT_NE(to_value(d, ".").find("images")->as_array().at(0).find("x-note"), nullptr);
  keep_images(d, {});
  EXPECT_TRUE(names_in(d, "images").empty());
}

}  // namespace
}  // namespace gonio::manifest
