// Meshes in other units, mirrored or turned, poses the wrong way round, flipped pictures, files of another scene: said
// first and in words. The recordings are those of one body; what the manifest or the files say of it is changed after.
#include "explain/images/misread.h"

#include <gmock/gmock.h>

#include "ball_world.h"
#include "base/random.h"
#include "explain/explain_document.h"
#include "explain/images/images_problem.h"
#include "io/picture.h"
#include "io/ply.h"
#include "manifest/document.h"
#include "manifest/sections/file.h"
#include "manifest/sections/image.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/surface.h"
#include "render/path_tracer.h"
#include "render/ray_caster.h"
#include "scene/scene.h"

namespace gonio::tests {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

void add_box(Vec3 low, Vec3 high, io::TriangleMesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.positions_m.size());
  for (int k = 0; k < 8; ++k)
    mesh.positions_m.push_back({k & 1 ? high.x : low.x, k & 2 ? high.y : low.y, k & 4 ? high.z : low.z});
  const std::uint32_t sides[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                     {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& s : sides) {
    mesh.triangles.push_back({first + s[0], first + s[1], first + s[2]});
    mesh.triangles.push_back({first + s[0], first + s[2], first + s[3]});
  }
}

// A foot, a tower at its one end and an arm to one side: no mirror maps it onto itself.
io::TriangleMesh body() {
  io::TriangleMesh mesh;
  add_box({-0.08, -0.03, 0}, {0.07, 0.03, 0.04}, mesh);
  add_box({0.02, -0.02, 0.04}, {0.07, 0.03, 0.14}, mesh);
  add_box({-0.07, 0.03, 0.01}, {-0.03, 0.09, 0.035}, mesh);
  return mesh;
}

// As the mesh in the file has it, in all views; once for all that is said of it afterwards.
const std::vector<io::Image>& rendered_body(const manifest::Document& document) {
  static std::vector<io::Image> pictures;
  if (!pictures.empty()) return pictures;
  const scene::Scene scene = scene::build_scene(document);
  const render::RayCaster caster(scene.instances);
  for (std::size_t v = 0; v < scene.views.size(); ++v)
    pictures.push_back(render::render(scene, v, caster, {.spp = 24, .seed = 3, .geometry = false}));
  return pictures;
}

class Misread : public testing::Test {
 protected:
  // `change`: of the vertices in the file, after everything was recorded.
  manifest::Document recorded(const std::function<Vec3(Vec3)>& change = {}) {
    manifest::Document document = manifest::parse_document(ball_manifest(""), "body", folder_.path());
    document.files["body"].path = "body.ply";
    document.meshes.at("ball") = {.file = "body", .normals = "flat"};
    io::TriangleMesh mesh = body();
    io::write_ply(folder_ / "body.ply", mesh);
    const std::vector<io::Image>& pictures = rendered_body(document);
    for (std::size_t v = 0; v < pictures.size(); ++v) {
      const io::Image& rendered = pictures[v];
      io::Image picture(rendered.width, rendered.height, {"R", "G", "B"});
      Random random(5, v);
      for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x)
          for (int c = 0; c < 3; ++c)
            picture.data[picture.index(x, y, c)] = rendered.at(x, y, c) + static_cast<float>(0.002 * random.normal());
      io::write_picture(folder_ / (document.images[v].id + ".exr"), picture);
    }
    if (change) {
      for (Vec3& p : mesh.positions_m) p = change(p);
      io::write_ply(folder_ / "body.ply", mesh);
    }
    return document;
  }
  // The picture's file, x and y mapped by `from`.
  void rewrite(const std::string& id, const std::function<float(const io::Image&, int x, int y, int c)>& from) {
    const io::Image before = io::read_picture(folder_ / (id + ".exr"));
    io::Image after = before;
    for (int y = 0; y < before.height; ++y)
      for (int x = 0; x < before.width; ++x)
        for (int c = 0; c < 3; ++c) after.data[after.index(x, y, c)] = from(before, x, y, c);
    io::write_picture(folder_ / (id + ".exr"), after);
  }
  static explain::Misplaced found(const manifest::Document& document) {
    const explain::images::ImagesProblem problem(document, {.pixels = 1500});
    explain::Explanation e;
    problem.conclude(e);
    EXPECT_EQ(problem.candidates().empty(), !e.misplaced.files.empty());
    return e.misplaced;
  }
  ScratchFolder folder_;
};

TEST_F(Misread, AsItIsMeantNothingIsSaid) {
  EXPECT_EQ(found(recorded()).sentence, "");
}

TEST_F(Misread, MeshesInOtherUnits) {
  for (const auto& [scale, words] :
       std::vector<std::pair<double, std::string>>{{1000, "to be in millimetres: scaled by 0.001"},
                                                   {100, "to be in centimetres: scaled by 0.01"},
                                                   {1 / 0.0254, "to be in inches: scaled by 0.0254"},
                                                   {0.1, "to be ten times too small: scaled by 10"},
                                                   {0.001, "to be a thousand times too small: scaled by 1000"}}) {
    const explain::Misplaced m = found(recorded([s = scale](Vec3 p) { return p * s; }));
    EXPECT_THAT(m.sentence, StartsWith("The mesh of `ball` seems " + words + ", the relative error of the pictures "))
        << scale;
    ASSERT_EQ(m.files.size(), 6u);
    EXPECT_LT(m.files[0].other, 0.1);
    EXPECT_GT(m.files[0].own, 0.15);
    EXPECT_EQ(m.files[0].shows, "00 with the mesh of `ball` scaled by " + words.substr(words.rfind(' ') + 1));
  }
}

TEST_F(Misread, IsTheAnswerAndNoPhysicsIsFitted) {
  const manifest::Document document = recorded([](Vec3 p) { return p * 1000; });
  manifest::Document explained = document;
  explain::ExplainRequest request;
  request.options.draws = 99;
  request.options.negative_controls = 2;
  EXPECT_EQ(explain_document(explained, request), Exit::negative);
  manifest::Value entry = explained.explanations.at(0);
  EXPECT_EQ(entry["verdict"].as_string(), "unknown");
  EXPECT_THAT(entry["sentence"].as_string(), StartsWith("The mesh of `ball` seems to be in millimetres"));
  EXPECT_EQ(entry["misplaced"].as_array().size(), 6u);
  EXPECT_EQ(explained.surfaces.at("ball").parameters.at("albedo").value,
            document.surfaces.at("ball").parameters.at("albedo").value);
}

// Coats, light beneath the surface, a room, large lamps and dark corners are no misreadings.
TEST_F(Misread, NothingIsSaidOfPracticeRecordings) {
  GONIO_NEEDS_DATA("recordings");
  for (int k = 1; k <= 6; ++k) {
    const std::string file = "practice-" + std::to_string(k) + ".json";
    EXPECT_EQ(found(manifest::read_document(tests::data("recordings") / file)).sentence, "") << file;
  }
}

TEST_F(Misread, MirroredAndTurnedMeshes) {
  EXPECT_THAT(found(recorded([](Vec3 p) {
                return Vec3{-p.x, p.y, p.z};
              })).sentence,
              StartsWith("The mesh of `ball` seems to be mirrored in x: with x negated"));
  EXPECT_THAT(found(recorded([](Vec3 p) {
                return Vec3{p.x, -p.y, p.z};
              })).sentence,
              StartsWith("The mesh of `ball` seems to be mirrored in y: with y negated"));
  EXPECT_THAT(found(recorded([](Vec3 p) {
                return Vec3{p.x, p.z, p.y};
              })).sentence,
              StartsWith("The mesh of `ball` seems to have the axes y and z exchanged"));
  EXPECT_THAT(found(recorded([](Vec3 p) {
                return Vec3{p.x, p.z, -p.y};
              })).sentence,
              StartsWith("The mesh of `ball` seems to have y up where z is: turned by 90 degrees about x"));
}

TEST_F(Misread, PosesTheWrongWayRound) {
  manifest::Document inverted = recorded(), back = inverted, far = inverted;
  for (manifest::ImageEntry& image : inverted.images) {
    const auto other = inverse(
        Rigid<frame::World, frame::Camera>{image.world_from_camera->rotation, image.world_from_camera->translation_m});
    image.world_from_camera->rotation = other.rotation;
    image.world_from_camera->translation_m = other.translation_m;
  }
  EXPECT_THAT(found(inverted).sentence,
              StartsWith("The poses seem to be camera_from_world, not world_from_camera: inverted"));
  for (manifest::ImageEntry& image : back.images)
    image.world_from_camera->rotation = image.world_from_camera->rotation * Quaternion{0, 1, 0, 0};
  EXPECT_THAT(found(back).sentence, StartsWith("The poses seem to be of a camera that has y up and looks along -z"));
  for (manifest::ImageEntry& image : far.images)
    image.world_from_camera->translation_m = image.world_from_camera->translation_m * 1000;
  EXPECT_THAT(found(far).sentence, StartsWith("The places of the cameras seem to be in millimetres: scaled by 0.001"));
}

TEST_F(Misread, FlippedPictures) {
  const manifest::Document document = recorded();
  const auto flip = [](const io::Image& p, int x, int y, int c) { return p.at(p.width - 1 - x, y, c); };
  rewrite("10", flip);
  EXPECT_THAT(found(document).sentence, StartsWith("The picture of `10` seems to be flipped left to right"));
  for (const char* id : {"00", "01", "02", "11", "12"}) rewrite(id, flip);
  EXPECT_THAT(found(document).sentence, StartsWith("The pictures seem to be flipped left to right: flipped back"));
  for (const char* id : {"00", "01", "02", "10", "11", "12"})
    rewrite(id, [](const io::Image& p, int x, int y, int c) { return p.at(p.width - 1 - x, p.height - 1 - y, c); });
  EXPECT_THAT(found(document).sentence, StartsWith("The pictures seem to be upside down"));
}

TEST_F(Misread, FilesOfAnotherScene) {
  const manifest::Document document = recorded();
  const auto stripes = [](const io::Image&, int x, int y, int) { return (x / 5 + y / 7) % 2 ? 0.5f : 0.1f; };
  rewrite("01", stripes);
  EXPECT_THAT(found(document).sentence,
              testing::AllOf(StartsWith("Image `01` is not explained by this scene better than by an even grey"),
                             HasSubstr("is it the wrong file?")));
  for (const char* id : {"00", "02", "10", "11", "12"}) rewrite(id, stripes);
  const explain::Misplaced all = found(document);
  EXPECT_THAT(all.sentence, StartsWith("No picture is explained by this scene better than by an even grey"));
  EXPECT_EQ(all.files.size(), 6u);
}

}  // namespace
}  // namespace gonio::tests
