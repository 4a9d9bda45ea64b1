// explain on board corners: the whole pipe on real photographs as a person would run it, and the domain's derivatives.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/atomic_file.h"
#include "data.h"
#include "explain/boards/boards_problem.h"
#include "explain/engine.h"
#include "manifest/value.h"
#include "process.h"
#include "schema_check.h"

namespace gonio::explain::tests {
namespace {

using gonio::tests::data;
using gonio::tests::run;
using manifest::Value;

const Value& at(const Value& value, std::string_view key) {
  const Value* found = value.find(key);
  if (found == nullptr) throw std::runtime_error("no key " + std::string(key));
  return *found;
}

std::vector<std::string> names(const Value& document) {
  std::vector<std::string> result;
  for (const Value& n : at(at(document, "explanations").as_array().at(0), "named").as_array())
    result.push_back(at(n, "mechanism").as_string());
  return result;
}

// Six photographs of a large ChArUco board, calibrated as if it were flat: what is left is the board's shape, on views
// that the fit did not see. The camera is at rest: whatever else those few views hold, no motion is named for it.
TEST(ExplainBoards, ABoardThatIsNotFlatIsNamedOnHeldOutViews) {
  GONIO_NEEDS_DATA("handeye/rwhe_kuka_3/images");
  const gonio::tests::ScratchFolder folder;
  std::vector<std::string> words = {"calib-charuco",    "--charuco", "12x9",         "--square", "60mm",
                                    "--marker",         "46mm",      "--dictionary", "5X5_250",  "--model",
                                    "radial-tangential"};
  const std::size_t options = words.size();
  for (const auto& entry : std::filesystem::directory_iterator(data("handeye/rwhe_kuka_3/images")))
    words.push_back(entry.path());
  std::sort(words.begin() + static_cast<std::ptrdiff_t>(options), words.end());
  ASSERT_EQ(words.size(), options + 6);
  const auto calibrated = run(words, folder.path());
  ASSERT_TRUE(calibrated.status == 0 || calibrated.status == 2) << calibrated.err;
  const auto ended = run({"explain", "--allow-outside"}, folder.path(), calibrated.out);
  ASSERT_EQ(ended.status, 0) << ended.err;
  gonio::tests::expect_described(ended.out);
  const Value document = manifest::parse_json(ended.out, "explain");
  const Value& entry = at(document, "explanations").as_array().at(0);
  EXPECT_EQ(names(document), std::vector<std::string>{"board.warp"}) << at(entry, "sentence").as_string();
  EXPECT_EQ(at(at(entry, "located"), "stage").as_string(), "board");
  EXPECT_LT(at(at(entry, "held_out"), "after").as_number(), 0.95 * at(at(entry, "held_out"), "before").as_number());
  const Value& board = at(document, "boards").as_object().at(0).second;
  EXPECT_NEAR(at(at(board, "warp"), "x_m").as_number(), 3.3e-4, 1.5e-4);
}

struct Recorded {
  std::string folder, prefix, ending;
  std::vector<std::string> board;
};
const Recorded left{
    "calibration/opencv_stereo_checkerboard", "left", ".jpg", {"--checkerboard", "9x6", "--square", "25mm"}},
    right{"calibration/opencv_stereo_checkerboard", "right", ".jpg", {"--checkerboard", "9x6", "--square", "25mm"}},
    paper{"calibration/charuco_realsense_mit",
          "calib",
          ".png",
          {"--charuco", "7x5", "--square", "30mm", "--marker", "22mm", "--dictionary", "4X4_50"}};

// Calibrates the photographs with `model`; the manifest as calib-charuco hands it on.
std::string calibrated(const Recorded& recorded, const std::string& model, const std::filesystem::path& folder) {
  std::vector<std::string> words = {"calib-charuco", "--model", model};
  words.insert(words.end(), recorded.board.begin(), recorded.board.end());
  const auto options = static_cast<std::ptrdiff_t>(words.size());
  for (const auto& entry : std::filesystem::directory_iterator(data(recorded.folder.c_str())))
    if (entry.path().filename().string().starts_with(recorded.prefix) && entry.path().extension() == recorded.ending)
      words.push_back(entry.path());
  std::sort(words.begin() + options, words.end());
  const auto ended = run(words, folder);
  EXPECT_TRUE(ended.status == 0 || ended.status == 2) << ended.err;
  return ended.out;
}
Value explained(const Recorded& recorded, const std::string& model, const std::filesystem::path& folder) {
  const auto ended =
      run({"explain", "--allow-outside", "--html", "report.html"}, folder, calibrated(recorded, model, folder));
  EXPECT_EQ(ended.status, 0) << ended.err;
  return manifest::parse_json(ended.out, "explain");
}

// Radial terms, or, listed beside them, another projection that bends as they do.
void expect_a_radial_lens(const Value& document) {
  const Value& entry = at(document, "explanations").as_array().at(0);
  ASSERT_FALSE(names(document).empty()) << at(entry, "sentence").as_string();
  EXPECT_TRUE(names(document)[0] == "lens.radial" || names(document)[0] == "lens.fisheye") << names(document)[0];
  EXPECT_NE(at(entry, "sentence").as_string().find("lens.radial"), std::string::npos);
  EXPECT_EQ(at(at(entry, "located"), "condition").as_string(), "camera.image-radius");
  EXPECT_EQ(at(at(entry, "located"), "stage").as_string(), "lens");
  EXPECT_GT(at(at(entry, "held_out"), "before").as_number(), 1.0);
  EXPECT_LT(at(at(entry, "held_out"), "after").as_number(), 0.25);
}

TEST(ExplainBoards, APinholeLacksItsRadialTermsFirst) {
  GONIO_NEEDS_DATA("calibration/opencv_stereo_checkerboard");
  const gonio::tests::ScratchFolder folder;
  const Value document = explained(left, "pinhole", folder.path());
  expect_a_radial_lens(document);
  const Value& entry = at(document, "explanations").as_array().at(0);
  const Value& camera = at(document, "cameras").as_object().at(0).second;
  EXPECT_NE(at(camera, "model").as_string(), "pinhole");
  // SciPy's least_squares on the same corners, radial terms and each corner's place and each view's motion free: 0.067 px.
  // (With a flat board at rest, 0.168 px, it has 534.0, 534.1, 341.5, 232.9.)
  EXPECT_NEAR(at(camera, "fx_px").as_number(), 537.1, 2);
  EXPECT_NEAR(at(camera, "fy_px").as_number(), 536.2, 2);
  EXPECT_NEAR(at(camera, "cx_px").as_number(), 342.5, 2);
  EXPECT_NEAR(at(camera, "cy_px").as_number(), 241.4, 2);
  EXPECT_GT(at(at(camera, "sigma"), "k1").as_number(), 0);
  const std::string page = read_file(folder.path() / "report.html");
  EXPECT_NE(page.find(at(entry, "sentence").as_string().substr(0, 40)), std::string::npos);
}

TEST(ExplainBoards, SoDoesTheOtherCameraOfThePair) {
  GONIO_NEEDS_DATA("calibration/opencv_stereo_checkerboard");
  const gonio::tests::ScratchFolder folder;
  expect_a_radial_lens(explained(right, "pinhole", folder.path()));
}

// Thirteen views of a sheet of paper. Both cameras of the pair, explained apart, find the same columns beside their
// places; their motions, too, go together from view to view (correlation 0.88 along the rows): the sheet moved in the
// hand while both were read.
TEST(ExplainBoards, TheFullLensLacksNothingButWhatTheBoardDoes) {
  GONIO_NEEDS_DATA("calibration/opencv_stereo_checkerboard");
  const gonio::tests::ScratchFolder folder;
  const std::set<std::string> of_the_board = {"board.warp", "board.shape", "board.print", "camera.rolling-shutter"};
  for (const Recorded& camera : {left, right})
    for (const std::string& name : names(explained(camera, "radial-tangential", folder.path())))
      EXPECT_TRUE(of_the_board.contains(name)) << camera.prefix << ": " << name;
}

// A camera that was calibrated in air, and a board in a tank: the plane of water between them, by its index. A focal
// length could stand in for it, and is listed; with the focal length of the air left free nothing is refracted any
// more.
TEST(ExplainBoards, WaterBetweenCameraAndBoardIsAFlatPort) {
  constexpr const char* set = "explain/refraction_air_water";
  GONIO_NEEDS_DATA(set);
  const gonio::tests::ScratchFolder folder;
  const auto pictures = [&](std::vector<std::string> words, const std::string& medium) {
    const std::size_t options = words.size();
    for (const auto& entry : std::filesystem::directory_iterator(data(set)))
      if (entry.path().filename().string().starts_with(medium)) words.push_back(entry.path());
    std::sort(words.begin() + static_cast<std::ptrdiff_t>(options), words.end());
    return words;
  };
  const auto air =
      run(pictures({"calib-charuco", "--parts", "--checkerboard", "8x7", "--square", "33.8mm", "--no-quality"}, "air_"),
          folder.path());
  ASSERT_EQ(air.status, 0) << air.err;
  write_file(folder.path() / "air.json", air.out);
  const auto water = run(pictures({"calib-charuco", "--parts", "--checkerboard", "8x7", "--square", "33.8mm",
                                   "--cameras", "air.json", "--fix", "intrinsics", "--no-quality"},
                                  "water_"),
                         folder.path());
  ASSERT_EQ(water.status, 2) << water.err;  // corners miss by more than 3 px
  const auto ended = run({"explain", "--allow-outside"}, folder.path(), water.out);
  ASSERT_EQ(ended.status, 0) << ended.err;
  gonio::tests::expect_described(ended.out);
  const Value document = manifest::parse_json(ended.out, "explain");
  const Value& entry = at(document, "explanations").as_array().at(0);
  EXPECT_EQ(names(document), std::vector<std::string>{"camera.flat-port"}) << at(entry, "sentence").as_string();
  const Value::Array& index = at(at(at(entry, "named").as_array().at(0), "interval_95"), "index").as_array();
  EXPECT_LT(index.at(0).as_number(), 1.333);
  EXPECT_GT(index.at(1).as_number(), 1.333);
  EXPECT_LT(index.at(1).as_number() - index.at(0).as_number(), 0.06);
  EXPECT_GT(at(at(entry, "held_out"), "before").as_number(), 3);
  EXPECT_LT(at(at(entry, "held_out"), "after").as_number(), 0.6);
  // What imitates it, and what that would cost: a third longer, the board a quarter nearer.
  EXPECT_NE(at(entry, "sentence").as_string().find("camera.focal-length (relative 3"), std::string::npos);
  EXPECT_NE(at(entry, "sentence").as_string().find("% nearer"), std::string::npos);
}

// A sheet of paper whose printer stretched it along one side. A camera that moved while its rows were read does as much
// to these views: on thirteen of them neither is clearly better (1.2 standard errors), so that both must be listed.
TEST(ExplainBoards, APaperThatThePrinterStretchedIsListed) {
  GONIO_NEEDS_DATA("calibration/charuco_realsense_mit");
  const gonio::tests::ScratchFolder folder;
  const auto ended =
      run({"explain", "--allow-outside"}, folder.path(), calibrated(paper, "radial-tangential", folder.path()));
  ASSERT_EQ(ended.status, 0) << ended.err;
  const Value document = manifest::parse_json(ended.out, "explain");
  const Value& entry = at(document, "explanations").as_array().at(0);
  EXPECT_EQ(at(entry, "verdict").as_string(), "ambiguous");
  EXPECT_NE(at(entry, "sentence").as_string().find("board.scale"), std::string::npos)
      << at(entry, "sentence").as_string();
  EXPECT_LT(at(at(entry, "held_out"), "after").as_number(), 0.8 * at(at(entry, "held_out"), "before").as_number());
}

// A small rig for derivatives: two views of a 4 x 3 board by a lens with every term.
BoardsInput small_rig() {
  BoardsInput input;
  BoardsInput::Camera camera;
  camera.name = "c";
  camera.width_px = 640, camera.height_px = 480;
  camera.intrinsics = {500, 510, 320, 240, {}};
  input.cameras = {camera};
  BoardsInput::Board board;
  board.name = "b";
  board.square_m = 0.03;
  board.extent = {{0.045, 0.03}, {0.045, 0.03}};
  input.boards = {board};
  for (int v = 0; v < 3; ++v) {
    BoardsInput::View view;
    view.image = "view" + std::to_string(v);
    view.camera_from_board.rotation = quaternion_of_rotation_vector({0.3 * v - 0.2, 0.25, 0.1 * v});
    view.camera_from_board.translation_m = {-0.04, -0.03 + 0.01 * v, 0.4};
    for (int k = 0; k < 12; ++k)
      view.corners.push_back({{0.03 * (k % 4), 0.03 * (k / 4)}, {300.0 + k, 200.0 + 2 * k}, 0.1});
    input.views.push_back(view);
  }
  return input;
}

TEST(ExplainBoards, DerivativesAgreeWithDifferences) {
  const auto problem = boards_problem(small_rig());
  const std::size_t count = problem->parameters().size(), rows = 24;
  std::vector<double> values(count);
  for (std::size_t p = 0; p < count; ++p) values[p] = problem->parameters()[p].neutral;
  for (std::size_t p = 0; p < count; ++p) values[p] += problem->parameters()[p].size * (p % 3 == 0 ? 5 : -3);
  std::vector<std::size_t> columns(count);
  for (std::size_t p = 0; p < count; ++p) columns[p] = p;
  std::vector<double> analytic(rows * count), numeric(rows * count);
  problem->jacobian(values, 1, columns, analytic);
  problem->Problem::jacobian(values, 1, columns, numeric);
  // The smallest steps are 1e-8: where a row and a crossing are found by iteration, pixels round to some 1e-13.
  for (std::size_t k = 0; k < analytic.size(); ++k)
    EXPECT_NEAR(analytic[k], numeric[k], 4e-5 * (1 + std::abs(numeric[k]))) << problem->parameters()[k / rows].name;
}

TEST(ExplainBoards, MechanismsAtNeutralLeaveThePredictionBitIdentical) {
  const auto problem = boards_problem(small_rig());
  std::vector<double> values, without(24), with(24);
  for (const Parameter& p : problem->parameters()) values.push_back(p.neutral);
  problem->predict(values, 0, without);
  for (const Candidate& c : problem->candidates()) {
    std::vector<double> moved = values;
    for (const std::size_t p : c.parameters) moved[p] = problem->parameters()[p].size;
    problem->predict(moved, 0, with);
    EXPECT_NE(without, with) << c.id();
    problem->predict(values, 0, with);
    EXPECT_EQ(without, with) << c.id();
  }
}

TEST(ExplainBoards, RefusalsNameThePlaceAndTheRemedy) {
  const std::string head = R"({"gonio":1,"boards":{"b":{"kind":"checkerboard","inner_corners":[4,3],"square_m":0.03}},
    "cameras":{"c":{"model":"pinhole","width_px":640,"height_px":480,"fx_px":500,"fy_px":500,"cx_px":320,"cy_px":240}},
    "images":[{"id":"a","camera":"c","board":"b"}])";
  const auto nothing = run({"explain"}, {}, head + "}");
  EXPECT_EQ(nothing.status, 65) << nothing.err;
  EXPECT_NE(nothing.err.find("nothing to explain"), std::string::npos) << nothing.err;
  const std::string table =
      R"(,"tables":{"t":{"model":"camera","camera":"c","board":"b","columns":{"image":"","corner":"1","board_x_m":"m",
    "board_y_m":"m","u_px":"px","v_px":"px","sigma_px":"px"},"observed":["u_px","v_px"],"sigma":["sigma_px"],
    "rows":[["a",0,0,0,100,100,0.1]]}}})";
  const auto no_pose = run({"explain"}, {}, head + table);
  EXPECT_EQ(no_pose.status, 65) << no_pose.err;
  EXPECT_NE(no_pose.err.find("calibrate first"), std::string::npos) << no_pose.err;
  EXPECT_EQ(run({"explain", "--hypotheses", "lens.imaginary"}, {}, head + table).status, 64);
  const auto list = run({"explain", "--list"});
  EXPECT_EQ(list.status, 0);
  EXPECT_NE(list.out.find("lens.radial"), std::string::npos);
}

}  // namespace
}  // namespace gonio::explain::tests
