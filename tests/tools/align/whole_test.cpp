// Whole runs of align beyond one object and given masks: several objects, masks found in photographs that render makes,
// focal lengths and ground freed, the page's figures. One process: AlignWhole.*
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "base/text.h"
#include "manifest/sections/alignment.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/file.h"
#include "manifest/sections/image.h"
#include "manifest/sections/light.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"
#include "wedge_scene.h"

namespace gonio::tests {
namespace {

using ObjectPose = manifest::Pose<frame::World, frame::Object>;

Quaternion about_z(double angle) {
  return quaternion_of_rotation_vector({0, 0, angle});
}

class AlignWhole : public WedgeScene {
 protected:
  // The wedge's scene as it is stated, seen from a second place as well (image "w"), without outlines.
  manifest::Document two_views() {
    const Quaternion turn = about_z(-pi / 2) * quaternion_of_rotation_vector({-130 * pi / 180, 0, 0});
    truth_.stations.push_back({{turn, {-0.5, 0, 0.42}}, 0});
    manifest::Document d = manifest::parse_document(scene(), "scene.json", folder_.path());
    d.outlines.clear();
    d.images.push_back(d.images[0]);
    d.images[1].id = "w";
    d.images[1].world_from_camera->rotation = turn;
    d.images[1].world_from_camera->translation_m = {-0.5, 0, 0.42};
    return d;
  }
  void add_mask(manifest::Document& d, const std::string& object, const std::string& kind, std::size_t image,
                const io::Image& mask) {
    const std::string name = d.images[image].id + object + kind;
    io::write_picture(folder_ / (name + ".exr"), mask);
    manifest::Outline outline;
    outline.image = d.images[image].id, outline.object = object, outline.kind = kind;
    outline.mask = manifest::add_file(d, folder_ / (name + ".exr"), name);
    d.outlines.push_back(outline);
  }
  // Of all bodies, as the truth has them: rims of objects and shadows in all images.
  void add_masks(manifest::Document& d, const std::vector<std::string>& bodies) {
    for (std::size_t image = 0; image < truth_.stations.size(); ++image)
      for (std::size_t b = 0; b < bodies.size(); ++b) {
        add_mask(d, bodies[b], "object", image, mask_of({image, b, {}}));
        add_mask(d, bodies[b], "shadow", image, mask_of({image, b, 0}));
      }
  }
  // A second wedge beside the first.
  void add_second(manifest::Document& d) {
    truth_.bodies.push_back({&shape_, {about_z(-1.2), {0.06, 0.1, 0}}, {1, 1, 1}});
    d.objects.push_back(d.objects[0]);
    d.objects.back().id = "second";
    d.objects.back().world_from_object->rotation = about_z(-1.27);
    d.objects.back().world_from_object->translation_m = {0.066, 0.095, 0.004};
  }
  Ended align_document(const manifest::Document& d, Words more = {}) const {
    return align(manifest::print_document(d, folder_.path()), std::move(more));
  }
  static const manifest::Object& object_of(const manifest::Document& d, const std::string& id) {
    return *std::find_if(d.objects.begin(), d.objects.end(), [&](const auto& o) { return o.id == id; });
  }
  static void shows(const std::string& page, const std::vector<std::string>& words) {
    for (const std::string& word : words) EXPECT_TRUE(page.find(word) != page.npos) << word;
  }
  void near_truth(const manifest::Document& d, const std::string& id, std::size_t body, double most_turn,
                  double most_shift_m) const {
    const ObjectPose& pose = *object_of(d, id).world_from_object;
    const alignment::Body& truth = truth_.bodies[body];
    EXPECT_LT(norm(rotation_vector_of(normalized(pose.rotation * conjugate(truth.world_from_object.rotation)))),
              most_turn)
        << id;
    EXPECT_LT(norm(pose * shape_.centre_m() - truth.centre_m()), most_shift_m) << id;
  }

  // The true scene photographed by render: image "v", or without the wedge.
  manifest::Document photographed(bool with_wedge) {
    manifest::Document d = manifest::parse_document(scene(), "scene.json", folder_.path());
    d.outlines.clear();
    d.images[0].noise = manifest::Noise{20000, 0.0005};
    d.surfaces["paper"] = d.surfaces.at("clay");
    d.surfaces.at("paper").parameters["albedo"].value = {0.6, 0.6, 0.6};
    d.objects[1].surface = "paper";
    d.lights.at("a").parameters.at("position_m").value = {truth_.lamps_m[0].x, truth_.lamps_m[0].y,
                                                          truth_.lamps_m[0].z};
    ObjectPose pose;
    pose.rotation = truth_.bodies[0].world_from_object.rotation;
    pose.translation_m = truth_.bodies[0].world_from_object.translation_m;
    d.objects[0].world_from_object = pose;
    if (!with_wedge) d.objects.erase(d.objects.begin()), d.images[0].id = "empty";
    write_file(folder_ / "truth.json", manifest::print_document(d, folder_.path()));
    const Ended ended = run(
        {"render", "truth.json", "--spp", "32", "--record", "--out", with_wedge ? "with" : "without"}, folder_.path());
    EXPECT_EQ(ended.status, 0) << ended.err;
    return manifest::parse_document(ended.out, "photographs.json", folder_.path());
  }
  // Their pictures in the scene as it is stated.
  manifest::Document stated_with(const manifest::Document& photographs) {
    manifest::Document d = photographs;
    const manifest::Document stated = manifest::parse_document(scene(), "scene.json", folder_.path());
    d.objects[0] = stated.objects[0], d.lights = stated.lights;
    return d;
  }
  manifest::Document masks_lead_to_the_wedge(const manifest::Document& stated, Words how, double most_turn,
                                             double most_shift_m) {
    Words words{"--out", "aligned", "--masks"};
    words.insert(words.end(), how.begin(), how.end());
    const Ended ended = align_document(stated, words);
    EXPECT_EQ(ended.status, 0) << ended.err;
    const manifest::Document d = document_of(ended);
    EXPECT_EQ(d.alignments.at(0).verdict, "found");
    near_truth(d, "wedge", 0, most_turn, most_shift_m);
    EXPECT_EQ(d.outlines.size(), 2u);
    for (const manifest::Outline& o : d.outlines) EXPECT_LT(*o.rms_px, 0.5) << o.kind;
    EXPECT_GT(*d.outlines.at(0).explained, 0.9);
    return d;
  }
};

TEST_F(AlignWhole, TwoObjectsAreFoundTogether) {
  manifest::Document d = two_views();
  add_second(d), add_masks(d, {"wedge", "second"});
  const Ended ended = align_document(d, {"--html", "page.html"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const manifest::Document found = document_of(ended);
  ASSERT_EQ(found.alignments.size(), 2u);
  for (const manifest::Alignment& a : found.alignments) EXPECT_EQ(a.verdict, "found") << a.object << a.why;
  near_truth(found, "wedge", 0, 2e-3, 2e-4), near_truth(found, "second", 1, 2e-3, 2e-4);
  EXPECT_LT(norm(found.lights.at("a").parameters.at("position_m").vector() - truth_.lamps_m[0]), 0.003);
  const std::string page = read_file(folder_ / "page.html");
  shows(page, {"Convergence of wedge", "Convergence of second"});
}

// What is lost pulls at nothing that it shares with what is found, and its figures are its own.
TEST_F(AlignWhole, OfTwoObjectsALostOneStaysAndSpoilsNothing) {
  manifest::Document d = two_views();
  add_second(d);
  for (std::size_t image = 0; image < 2; ++image) {
    add_mask(d, "wedge", "object", image, mask_of({image, 0, {}}));
    add_mask(d, "wedge", "shadow", image, mask_of({image, 0, 0}));
  }
  truth_.bodies[1].scale = {0.5, 1.6, 1.9};  // another shape
  for (std::size_t image = 0; image < 2; ++image) {
    add_mask(d, "second", "object", image, mask_of({image, 1, {}}));
    add_mask(d, "second", "shadow", image, mask_of({image, 1, 0}));
  }
  std::reverse(d.outlines.begin(), d.outlines.end());  // the lost one first
  const Ended ended = align_document(d, {"--from", "stated", "--html", "page.html"});
  ASSERT_EQ(ended.status, 1) << ended.err;
  const manifest::Document found = document_of(ended);
  ASSERT_EQ(found.alignments.size(), 2u);
  EXPECT_EQ(found.alignments[0].verdict, "lost");
  EXPECT_EQ(found.alignments[1].verdict, "found") << found.alignments[1].why;
  EXPECT_LT(found.alignments[1].rms_px, 0.1);
  EXPECT_GT(found.alignments[0].rms_px, 0.5);
  near_truth(found, "wedge", 0, 2e-3, 2e-4);
  EXPECT_LT(norm(found.lights.at("a").parameters.at("position_m").vector() - truth_.lamps_m[0]), 0.003);
  EXPECT_EQ(object_of(found, "second").world_from_object->translation_m, (Vec3{0.066, 0.095, 0.004}));
  for (const manifest::Outline& o : found.outlines)
    EXPECT_LT(*o.rms_px, o.object == "wedge" ? 0.1 : HUGE_VAL) << o.kind;
}

// Each shadow has a table of its own.
TEST_F(AlignWhole, OfOnePhotographUnderTwoLampsBothAreFound) {
  truth_.lamps_m.push_back({-0.2, 0.1, 0.45});
  manifest::Document d = manifest::parse_document(scene(), "scene.json", folder_.path());
  d.lights["b"] = d.lights.at("a");
  d.lights.at("b").parameters.at("position_m").value = {-0.18, 0.12, 0.43};
  d.images[0].light = {"a", "b"};
  d.outlines[1].light = "a";
  add_mask(d, "wedge", "shadow", 0, mask_of({0, 0, 1}));
  d.outlines[2].light = "b";
  const Ended ended = align_document(d, {"--out", "aligned"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const manifest::Document found = document_of(ended);
  for (const std::size_t lamp : {0, 1}) {
    const manifest::Light& light = found.lights.at(lamp == 0 ? "a" : "b");
    EXPECT_LT(norm(light.parameters.at("position_m").vector() - truth_.lamps_m[lamp]), 0.01);
  }
  EXPECT_EQ(found.files.at(found.outlines.at(1).file).path, "aligned/v-wedge-shadow-a.csv");
  EXPECT_EQ(found.files.at(found.outlines.at(2).file).path, "aligned/v-wedge-shadow-b.csv");
}

TEST_F(AlignWhole, MasksByAPictureWithoutTheObject) {
  manifest::Document d = stated_with(photographed(true));
  const manifest::Document empty = photographed(false);
  d.images.push_back(empty.images[0]);
  d.images.back().file = manifest::add_file(d, folder_ / empty.files.at(empty.images[0].file).path, "empty");
  // The wedge's dark side lies beside its shadow: of little of that can anybody tell what it is. Where that does not
  // hold the lamp, it stays.
  const manifest::Document found = masks_lead_to_the_wedge(d, {"background", "--background", "v=empty"}, 1.5e-2, 2e-3);
  const Vec3 lamp = found.lights.at("a").parameters.at("position_m").vector();
  EXPECT_LT(norm(lamp - truth_.lamps_m[0]), 0.1);
  const std::string text = manifest::print_document(d, folder_.path());
  refused(text, 64, "names no empty picture for \"v\"",
          {"--masks", "background", "--out", "o", "--background", "w=empty"});
  refused(text, 64, "names \"none\", which is not in images",
          {"--masks", "background", "--out", "o", "--background", "v=none", "--background", "empty=none"});
}

TEST_F(AlignWhole, MasksOfOnePictureAlone) {
  masks_lead_to_the_wedge(stated_with(photographed(true)), {"alone"}, 1e-2, 2e-3);
}

// Nobody can tell what the left part of the picture shows, where the shadow's rim is: no lamp follows.
TEST_F(AlignWhole, ALampThatNoRimHoldsStaysAndIsNamed) {
  const io::Image whole = mask_of({0, 0, 0});
  io::Image shadow(width, height, {"Y", "unknown"});
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) shadow.at(x, y, 0) = whole.at(x, y, 0), shadow.at(x, y, 1) = x < 95 ? 1 : 0;
  io::write_picture(folder_ / "shadow.exr", shadow);
  const Ended ended = align(scene(), {"--html", "page.html"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.err, ::testing::HasSubstr("lamp a: no rim holds its place; it stays where it is stated"));
  const manifest::Document found = document_of(ended);
  near_truth(found, "wedge", 0, 2e-2, 3e-3);
  EXPECT_EQ(found.lights.at("a").parameters.at("position_m").vector(), (Vec3{0.27, -0.17, 0.41}));
  EXPECT_TRUE(found.lights.at("a").sigma.empty());
  for (std::size_t i = 0; i < 3; ++i) EXPECT_GT(found.alignments.at(0).lights.at(0).covariance_m2.at(4 * i), 1);
  EXPECT_THAT(found.alignments.at(0).open, ::testing::Contains("the place of lamp a"));
  shows(read_file(folder_ / "page.html"), {"No rim holds the place of lamp a."});
}

TEST_F(AlignWhole, MasksByStrokes) {
  const manifest::Document d = stated_with(photographed(true));
  const io::Image body = mask_of({0, 0, {}}), shadow = mask_of({0, 0, 0});
  io::Image drawn(width, height, {"R", "G", "B"});
  // Whole within so many pixels.
  const auto all = [&](const io::Image& mask, int x, int y, float share, int reach) {
    for (int v = y - reach; v <= y + reach; ++v)
      for (int u = x - reach; u <= x + reach; ++u)
        if (u < 0 || v < 0 || u >= width || v >= height || mask.at(u, v, 0) != share) return false;
    return true;
  };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const bool free = all(body, x, y, 0, 3);
      if (y % 6 < 2 && all(body, x, y, 1, 3)) drawn.at(x, y, 0) = 1;
      if (free && all(shadow, x, y, 1, 2)) drawn.at(x, y, 2) = 1;
      if (y % 20 < 2 && free && all(shadow, x, y, 0, 6)) drawn.at(x, y, 1) = 1;
    }
  io::write_picture(folder_ / "drawn.png", drawn);
  masks_lead_to_the_wedge(d, {"strokes", "--strokes", "v=drawn.png"}, 2e-2, 3e-3);
  refused(manifest::print_document(d, folder_.path()), 64, "are missing for \"v\"",
          {"--masks", "strokes", "--out", "o", "--strokes", "w=drawn.png"});
}

TEST_F(AlignWhole, AFocalLengthIsFoundWithinItsInterval) {
  manifest::Document d = two_views();
  add_second(d);
  add_masks(d, {"wedge", "second"});
  d.cameras.at("c").fx_px = d.cameras.at("c").fy_px = 428.0;
  const Ended ended = align_document(d, {"--free", "focal", "--html", "page.html"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const manifest::Document found = document_of(ended);
  const manifest::AlignedCamera& camera = found.alignments.at(0).cameras.at(0);
  const double sigma = camera.sigma.at("focal_factor").at(0);
  EXPECT_LT(sigma, 0.005);
  EXPECT_NEAR(*camera.focal_factor, 420.0 / 428, 3 * sigma);
  EXPECT_NEAR(found.cameras.at("c").fx_px.scalar(), 420, 3 * 428 * sigma);
  EXPECT_NEAR(found.cameras.at("c").sigma.at("fx_px").at(0), 420 * sigma, 1);
  shows(read_file(folder_ / "page.html"), {"focal lengths of c"});
}

TEST_F(AlignWhole, TheGroundIsFoundWithinItsIntervalAndWritten) {
  // Tilted by a degree, and three millimetres lower than stated; the wedge stands on it.
  const Vec3 tilt{0.010, -0.014, 0};
  const Vec3 normal = normalized(matrix_of(quaternion_of_rotation_vector(tilt)) * Vec3{0, 0, 1});
  truth_.ground = alignment::Ground{normal, -0.003};
  auto& pose = truth_.bodies[0].world_from_object;
  pose.rotation = normalized(quaternion_of_rotation_vector(tilt) * pose.rotation);
  double lowest = HUGE_VAL;
  for (const Vec3 p : shape_.positions_m())
    lowest = std::min(lowest, truth_.ground->height_m(truth_.bodies[0].place_m(p)));
  pose.translation_m += normal * -lowest;
  manifest::Document d = two_views();
  add_masks(d, {"wedge"});
  const Ended ended = align_document(d, {"--free", "ground", "--html", "page.html"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const manifest::Document found = document_of(ended);
  near_truth(found, "wedge", 0, 2e-3, 3e-4);
  const ObjectPose& table = *object_of(found, "table").world_from_object;
  ASSERT_TRUE(table.sigma);
  const auto& turn = table.sigma->rotation_rad;
  const Vec3 off = cross(matrix_of(table.rotation) * Vec3{0, 0, 1}, normal);  // the turn that is missing
  EXPECT_LT(std::max(turn[0], turn[1]), 0.01);
  EXPECT_NEAR(off.x, 0, 3 * turn[0]);
  EXPECT_NEAR(off.y, 0, 3 * turn[1]);
  EXPECT_NEAR(truth_.ground->height_m(table.translation_m), 0, 3 * table.sigma->translation_m[2]);
  EXPECT_LT(table.sigma->translation_m[2], 1e-3);
  shows(read_file(folder_ / "page.html"), {"tilt of table"});
}

TEST_F(AlignWhole, ThePageShowsHowEachStartCameDownAndMasksBeforeAndAfter) {
  const Ended ended = align(scene(), {"--from", "nothing", "--html", "page.html"}),
              plain = align(scene(), {"--from", "nothing"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(document_of(ended).objects[0].world_from_object->rotation,
            document_of(plain).objects[0].world_from_object->rotation);  // looking on changes nothing
  const std::string page = read_file(folder_ / "page.html");
  shows(page, {"Convergence of wedge", "taken: searched, 1", ">dropped<", "v, as stated", "v, as the fit ended",
               "of the pixels wrong, IoU 0.", "of the pixels wrong, IoU 1.000"});
}

}  // namespace
}  // namespace gonio::tests
