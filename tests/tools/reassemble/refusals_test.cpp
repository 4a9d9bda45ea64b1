// Bad input to reassemble: each kind ends it with its exit status and one clear line that names the place and the
// remedy; nothing is half written.
// One process: ReassembleRefuses.*
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <set>

#include "base/atomic_file.h"
#include "data.h"
#include "manifest/document.h"
#include "manifest/value.h"
#include "process.h"
#include "reassembly/specimen.h"

namespace gonio::tests {
namespace {

namespace fs = std::filesystem;
using manifest::Value;
using testing::HasSubstr;
using Spoil = std::function<void(Value&)>;

struct BadInput {
  const char* kind;
  const char* name;  // of what is spoilt: "rig.json" or "lid.json"
  Spoil spoil;       // null: nothing
  Process::Words words;
  int status;
  std::vector<std::string> mentions;
};

class ReassembleRefuses : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    manifest::Document rig = reassembly::specimen(folder().path(), {.width_px = 64, .height_px = 48, .spp = 1});
    write_file(folder() / "rig.json", manifest::print_document(rig, folder().path()));
    write_file(folder() / "cut.exr", read_file(folder() / "left1.exr").substr(0, 900));
    write_file(folder() / "points.ply",
               "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
               "property float z\nend_header\n0 0 0\n");
    write_file(folder() / "text.json", "no manifest\n");
  }
  static ScratchFolder& folder() {
    static ScratchFolder made;
    return made;
  }
  static std::set<std::string> files() {
    std::set<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder().path())) names.insert(entry.path());
    return names;
  }

  static void expect_refused(const BadInput& bad) {
    SCOPED_TRACE(bad.kind);
    for (const char* name : {"rig.json", "lid.json"}) {
      Value document = manifest::parse_json(read_file(folder() / name), name);
      if (bad.spoil && std::string(name) == bad.name) bad.spoil(document);
      write_file(folder() / (std::string("bad-") + name), manifest::print_json(document));
    }
    fs::create_directory(folder() / "o");
    Process::Words words{"reassemble", "bad-rig.json", "--log-level", "error"};
    words.insert(words.end(), bad.words.begin(), bad.words.end());
    const auto before = files();
    const Ended ended = run(words, folder().path());
    EXPECT_EQ(ended.status, bad.status) << ended.err;
    EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
    EXPECT_THAT(ended.err, testing::StartsWith("reassemble: "));
    EXPECT_THAT(ended.err, testing::AnyOf(HasSubstr("; "), HasSubstr(": needs --"))) << "what to do about it";
    for (const std::string& words_in : bad.mentions) EXPECT_THAT(ended.err, HasSubstr(words_in));
    EXPECT_EQ(ended.out, "");
    EXPECT_EQ(files(), before);
  }
};

Value& first_marker(Value& d) {
  return d["markers"].as_array().front();
}
Value& first_image(Value& d) {
  return d["images"].as_array().front();
}
const Process::Words usual{"--piece", "lid=bad-lid.json", "--out", "o"};
Process::Words with(std::initializer_list<std::string> more) {
  Process::Words words = usual;
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

TEST_F(ReassembleRefuses, CommandLinesThatSayTooLittleOrTooMuch) {
  const BadInput all[]{
      {"no folder", "", {}, {"--piece", "lid.json"}, 64, {"--out", "give --out DIR"}},
      {"no piece", "", {}, {"--out", "o"}, 65, {"no object has markers", "--piece NAME=FILE"}},
      {"piece missing", "", {}, {"--piece", "none.json", "--out", "o"}, 66, {"none.json: is not there"}},
      {"piece without a name", "", {}, {"--piece", "=lid.json", "--out", "o"}, 64, {"names no file"}},
      {"object that the piece has not", "", {}, {"--piece", "a=lid.json#pot", "--out", "o"}, 65, {"not pot"}},
      {"one name twice",
       "",
       {},
       {"--piece", "a=lid.json", "--piece", "a=bowl.json", "--out", "o"},
       65,
       {"\"a\" is in the scene already"}},
      {"unknown image", "", {}, with({"--image", "left9"}), 64, {"\"left9\" is not in images"}},
      {"radius zero", "", {}, with({"--marker-radius", "0mm"}), 64, {"--marker-radius: is 0"}},
      {"radius without a unit", "", {}, with({"--marker-radius", "2.5"}), 64, {"--marker-radius"}},
      {"sizes the wrong way round", "", {}, with({"--smallest", "9", "--largest", "8"}), 64, {"8 px is not above"}},
      {"unknown surface of markers", "", {}, with({"--marker-surface", "chalk"}), 64, {"\"chalk\" is not in surfaces"}},
      {"no vertical", "", {}, with({"--up", "0,0,0"}), 64, {"is no direction"}},
      {"background missing", "", {}, with({"--background", "none.ply"}), 66, {"none.ply"}},
      {"background of points", "", {}, with({"--background", "points.ply"}), 65, {"has no faces"}},
      {"contact without a background", "", {}, with({"--contact", "push"}), 64, {"--contact: needs --background"}},
      {"unknown surface of labels",
       "",
       {},
       with({"--background", "table.ply", "--labels", "--label-surface", "chalk"}),
       64,
       {"\"chalk\" is not in surfaces"}},
      {"seeds of no image",
       "",
       {},
       with({"--background", "table.ply", "--labels", "--label-surface", "background", "--seeds", "seeds.png"}),
       64,
       {"is not IMAGE=FILE"}}};
  for (const BadInput& bad : all) expect_refused(bad);
}

TEST_F(ReassembleRefuses, PiecesThatCannotBe) {
  const char* const lid = "lid.json";
  const BadInput all[]{
      {"no manifest", "", {}, {"--piece", "text.json", "--out", "o"}, 65, {"text.json"}},
      {"without markers", lid, [](Value& d) { d["markers"] = Value::array(); }, usual, 65, {"no object has markers"}},
      {"marker without covariance",
       lid,
       [](Value& d) {
         Value marker = Value::object();
         for (const auto& [key, member] : first_marker(d).as_object())
           if (key != "covariance_m2") marker[key] = member;
         first_marker(d) = marker;
       },
       usual,
       65,
       {"/markers/0", "has no covariance_m2"}},
      {"covariance that is none",
       lid,
       [](Value& d) { first_marker(d)["covariance_m2"].as_array()[4] = -1e-9; },
       usual,
       65,
       {"is no covariance"}},
      {"covariance that leans",
       lid,
       [](Value& d) { first_marker(d)["covariance_m2"].as_array()[1] = 5e-11; },
       usual,
       65,
       {"is no covariance"}},
      {"centre of two numbers",
       lid,
       [](Value& d) { first_marker(d)["centre_m"].as_array().pop_back(); },
       usual,
       65,
       {"bad-lid.json#/markers/0/centre_m"}},
      {"mesh missing", lid, [](Value& d) { d["files"]["lid"]["path"] = "none.ply"; }, usual, 66, {"none.ply"}},
      {"mesh of other content",
       lid,
       [](Value& d) { d["files"]["lid"]["sha256"] = std::string(64, '0'); },
       usual,
       65,
       {"SHA-256"}},
      {"surface that differs",
       lid,
       [](Value& d) { d["surfaces"]["porcelain"]["albedo"] = 0.7; },
       usual,
       65,
       {"bad-lid.json#/surfaces/porcelain", "another surface"}}};
  for (const BadInput& bad : all) expect_refused(bad);
}

TEST_F(ReassembleRefuses, PhotographsThatCannotBe) {
  const char* const rig = "rig.json";
  const BadInput all[]{
      {"no photographs", rig, [](Value& d) { d["images"] = Value::array(); }, usual, 65, {"/images: is empty"}},
      {"no pose",
       rig,
       [](Value& d) {
         Value image = Value::object();
         for (const auto& [key, member] : first_image(d).as_object())
           if (key != "world_from_camera") image[key] = member;
         first_image(d) = image;
       },
       usual,
       65,
       {"bad-rig.json#/images/0: has no world_from_camera", "handeye"}},
      {"pose that is no rotation",
       rig,
       [](Value& d) {
         first_image(d)["world_from_camera"]["rotation"] = Value(std::vector<Value>{1.0, 1.0, 0.0, 0.0});
       },
       usual,
       65,
       {"/images/0/world_from_camera"}},
      {"camera not said", rig, [](Value& d) { first_image(d)["camera"] = ""; }, usual, 65, {"/images/0/camera"}},
      {"camera unknown", rig, [](Value& d) { first_image(d)["camera"] = "top"; }, usual, 65, {"\"top\""}},
      {"picture missing",
       rig,
       [](Value& d) {
         d["files"][first_image(d)["file"].as_string()] = Value::object({{"path", "none.exr"}});
       },
       usual,
       66,
       {"none.exr"}},
      {"picture cut off",
       rig,
       [](Value& d) {
         d["files"][first_image(d)["file"].as_string()] = Value::object({{"path", "cut.exr"}});
       },
       usual,
       65,
       {"cut.exr"}},
      {"picture of another size",
       rig,
       [](Value& d) {
         for (const char* camera : {"left", "right"}) d["cameras"][camera]["width_px"] = 65;
       },
       usual,
       65,
       {"is 64 x 48 pixels, its camera has 65 x 48"}}};
  for (const BadInput& bad : all) expect_refused(bad);
}

}  // namespace
}  // namespace gonio::tests
