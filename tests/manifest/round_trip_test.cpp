// Random documents: what is written reads back the same, an edit changes nothing but itself, and damaged text is
// refused in one line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "base/random.h"
#include "manifest/document.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/file.h"
#include "manifest/sections/image.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"

namespace gonio::manifest {
namespace {

std::string name(const char* stem, std::size_t i) {
  return stem + std::to_string(i);
}

Parameter parameter(Random& random, double low, double high) {
  Parameter p(random.uniform(low, high));
  if (random.below(2) == 0) return p;
  p.free = true;
  if (random.below(2) == 0) p.min = low - 1;
  if (random.below(2) == 0) p.sigma = random.uniform();
  if (random.below(3) == 0) p.share = "tied";
  return p;
}

template <class P>
P pose(Random& random) {
  P p;
  p.rotation = normalized(Quaternion{random.normal(), random.normal(), random.normal(), random.normal()});
  p.translation_m = {random.normal(), random.normal(), random.normal()};
  return p;
}

void add_things(Document& d, std::size_t i, Random& random) {
  d.surfaces[name("s", i)].parameters["albedo"] =
      std::vector<double>{random.uniform(), random.uniform(), random.uniform()};
  d.lights[name("l", i)].parameters = {
      {"position_m", std::vector<double>{random.normal(), random.normal(), random.normal()}},
      {"watt_per_sr", std::vector<double>{1, 2, random.uniform(0, 9)}}};
  d.meshes[name("m", i)].sphere_radius_m = random.uniform();
  Object o{.id = name("o", i), .mesh = name("m", i), .surface = name("s", i), .world_from_object = {}};
  if (random.below(2) == 0) o.world_from_object = pose<Pose<frame::World, frame::Object>>(random);
  d.objects.push_back(o);
}

Document document(Random& random) {
  Document d;
  for (std::size_t i = 0; i < 1 + random.below(3); ++i) {
    d.files[name("f", i)] = {.path = "dir/" + name("f", i) + ".ply", .bytes = random.next(), .sha256 = ""};
    Camera c;
    c.model = "radial-tangential";
    c.width_px = 1 + static_cast<int>(random.below(4000));
    c.height_px = 1 + static_cast<int>(random.below(4000));
    c.fx_px = parameter(random, 100, 5000);
    c.distortion["k1"] = parameter(random, -0.5, 0.5);
    c.sigma["fx_px"] = {random.uniform()};
    d.cameras[name("c", i)] = c;
    add_things(d, i, random);
    ImageEntry image;
    image.id = name("i", i);
    image.camera = name("c", i);
    image.light = {name("l", 0)};
    image.world_from_camera = pose<Pose<frame::World, frame::Camera>>(random);
    image.exposure_s = random.uniform();
    d.images.push_back(image);
  }
  return d;
}

TEST(RoundTrip, RandomDocumentsReadBackToTheSameText) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    Random random(seed);
    const std::string text = print_document(document(random), ".");
    const Document read = parse_document(text, "random.json", ".");
    EXPECT_EQ(print_document(read, "."), text) << "seed " << seed;
    EXPECT_EQ(content_id(read), content_id(parse_document(text, "again.json", "."))) << "seed " << seed;
  }
}

TEST(RoundTrip, AnEditChangesNothingButItself) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    Random random(seed);
    Value text = to_value(document(random), ".");
    Value& image = text["images"].as_array()[0];
    image["x-mine"] = "kept";
    image["world_from_camera"]["x-deep"] = Value(std::vector<double>{1, 2});
    Document d = parse_document(print_json(text), "edited.json", ".");
    d.images[0].exposure_s = 0.125;
    image["exposure_s"] = 0.125;
    EXPECT_EQ(canonical_json(to_value(d, ".")), canonical_json(text)) << "seed " << seed;
    d.images[0].world_from_camera->translation_m.x += 1;
    const Value moved = to_value(d, ".");
    const Value* pose_written = moved.find("images")->as_array()[0].find("world_from_camera");
    ASSERT_NE(pose_written->find("x-deep"), nullptr);
    EXPECT_EQ(*pose_written->find("rotation"), *image["world_from_camera"].find("rotation"));
  }
}

TEST(RoundTrip, AnotherFieldOfTheEntryLeavesAMatrixAlone) {
  const std::string text =
      R"({"gonio":1,"images":[{"id":"a","world_from_camera":{"matrix":[[1,0,0,0.1],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}}]})";
  Document d = parse_document(text, "m.json", ".");
  d.images[0].weight = 0.5;
  const Value image = to_value(d, ".").find("images")->as_array()[0];
  EXPECT_NE(image.find("world_from_camera")->find("matrix"), nullptr);
  d.images[0].world_from_camera->translation_m.x = 0.2;
  const Value moved = to_value(d, ".").find("images")->as_array()[0];
  EXPECT_EQ(moved.find("world_from_camera")->find("matrix"), nullptr);
  EXPECT_NE(moved.find("world_from_camera")->find("translation_m"), nullptr);
}

// Prefixes of a document are refused; none is accepted or crashed on.
TEST(RoundTrip, DamagedTextIsRefusedInOneLine) {
  Random random(7);
  const std::string whole = print_document(document(random), ".");
  const auto expect_refused = [](const std::string& text) {
    try {
      parse_document(text, "cut.json", ".");
      ADD_FAILURE() << "accepted";
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), Exit::data);
      EXPECT_THAT(e.what(), testing::StartsWith("cut.json"));
      EXPECT_THAT(e.what(), testing::Not(testing::HasSubstr("\n")));
    }
  };
  for (std::size_t n = 0; n + 2 < whole.size(); n += 1 + random.below(9)) expect_refused(whole.substr(0, n));
}

std::string refusal(const std::string& text) {
  try {
    parse_document(text, "t.json", ".");
  } catch (const Error& e) {
    return e.what();
  }
  return "accepted";
}

TEST(Refusal, TablesKeepTheirUnits) {
  const auto table = [](const char* columns, const char* rows) {
    return std::string(R"({"gonio":1,"tables":{"t":{"columns":)") + columns + R"(,"observed":["u_px"],"rows":)" + rows +
           "}}}";
  };
  EXPECT_EQ(refusal(table(R"({"u_px":"px","f":"1/sr"})", "[[1,2]]")), "accepted");
  EXPECT_THAT(refusal(table(R"({"u_px":"m","f":"1/sr"})", "[[1,2]]")), testing::HasSubstr("its name says px"));
  EXPECT_THAT(refusal(table(R"({"u_px":"px","f":"deg"})", "[[1,2]]")),
              testing::HasSubstr("is not SI; convert the column to rad"));
  EXPECT_THAT(refusal(table(R"({"u_px":"px","f":"1"})", "[[1,2],[1]]")), testing::HasSubstr("t.json#/tables/t/rows/1"));
  EXPECT_THAT(refusal(table(R"({"v_px":"px"})", "[[1]]")), testing::HasSubstr("did you mean \"v_px\"?"));
}

TEST(Refusal, NamesTheLineAndAnotherUnit) {
  EXPECT_THAT(refusal("{\"gonio\": 1,\n \"files\": {\"a\": {\"path\": \"p\"},\n  \"a\": {}}}"),
              testing::HasSubstr("(line 3, column "));
  EXPECT_THAT(refusal(R"({"gonio":1,"cameras":{"c":{"width_mm":4}}})"),
              testing::HasSubstr("did you mean \"width_px\"?"));
  EXPECT_THAT(refusal(std::string(100, '[')), testing::HasSubstr("deeper than 64"));
}

TEST(ContentId, DependsOnContentNotOnPlaceOrTime) {
  const std::string hash(64, 'a');
  const auto at = [&](const std::string& path) {
    return parse_document(R"({"gonio":1,"files":{"f":{"path":")" + path + R"(","sha256":")" + hash + R"("}}})",
                          "t.json", ".");
  };
  EXPECT_EQ(content_id(at("one.ply")), content_id(at("two/one.ply")));
  Document plain = at("one.ply"), stamped = plain;
  Step step{.program = "render", .version = "1", .options = Value::object(), .input_hashes = {}, .input_id = ""};
  record_step(plain, step);
  step.time = "2026-01-01T00:00:00Z";
  step.host = "desk";
  record_step(stamped, step);
  EXPECT_EQ(content_id(plain), content_id(stamped));
  EXPECT_NE(print_document(plain, "."), print_document(stamped, "."));
}

}  // namespace
}  // namespace gonio::manifest
