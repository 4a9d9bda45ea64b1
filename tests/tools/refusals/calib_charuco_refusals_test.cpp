// What people give calib-charuco by mistake: the right exit status, one line that says what is wrong, nothing written.
#include <gmock/gmock.h>

#include <limits>
#include <set>

#include "base/atomic_file.h"
#include "camera/synthetic_board.h"
#include "data.h"
#include "io/picture.h"
#include "process.h"

namespace gonio::tests {
namespace {

namespace fs = std::filesystem;
using Words = Process::Words;

constexpr int width = 320, height = 240;

class CalibCharuco : public testing::Test {
 protected:
  CalibCharuco() {
    const camera::Board board{camera::BoardKind::charuco, 6, 4, 0.03, 0.022, "4X4_50", {}};
    const camera::Lens lens{350, 350, 159.5, 119.5};
    int n = 0;
    for (const Vec3 turn : {Vec3{0.4, 0.1, 0}, Vec3{-0.3, 0.3, 0.2}}) {
      const auto pose = camera::pose_at(board, turn, 0.33);
      views_.push_back(camera::photograph(board, lens, pose, width, height, {0.6, 0.005, 4, 1}));
      io::write_picture(path("v" + std::to_string(n++) + ".png"), views_.back());
    }
  }
  fs::path path(const std::string& name) const { return folder_ / name; }
  std::set<fs::path> files() const {
    std::set<fs::path> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder_.path()))
      if (!entry.is_directory()) names.insert(entry.path());
    return names;
  }
  void expect_refused(const Words& options, int status, const std::string& mentions) const {
    Words words{"calib-charuco", "--log-level", "error"};
    words.insert(words.end(), options.begin(), options.end());
    const auto before = files();
    const Ended ended = run(words, folder_.path());
    EXPECT_EQ(ended.status, status) << ended.err;
    EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
    EXPECT_THAT(ended.err, testing::StartsWith("calib-charuco: "));
    EXPECT_THAT(ended.err, testing::HasSubstr(mentions));
    EXPECT_EQ(ended.out, "");
    EXPECT_EQ(files(), before);
  }
  void expect_pictures_refused(const Words& pictures, int status, const std::string& mentions) const {
    Words words = board_;
    words.insert(words.end(), pictures.begin(), pictures.end());
    expect_refused(words, status, mentions);
  }

  ScratchFolder folder_;
  std::vector<io::Image> views_;
  const Words board_{"--charuco", "7x5", "--square", "30mm", "--marker", "22mm", "--dictionary", "4X4_50"};
};

TEST_F(CalibCharuco, PicturesWithoutTheBoard) {
  io::write_picture(path("grey.png"), io::Image(width, height, {"Y"}));
  expect_pictures_refused({"grey.png"}, 65, "none of 1 picture");
  io::Image nowhere(width, height, {"R", "G", "B"});
  for (float& v : nowhere.data) v = std::numeric_limits<float>::quiet_NaN();
  io::write_picture(path("nan.exr"), nowhere);
  expect_pictures_refused({"nan.exr"}, 65, "none of 1 picture");
}

TEST_F(CalibCharuco, MirroredRepeatedAndMixedPictures) {
  io::Image mirrored = views_[0];
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) mirrored.at(x, y, 0) = views_[0].at(width - 1 - x, y, 0);
  }
  io::write_picture(path("m.png"), mirrored);
  expect_pictures_refused({"m.png"}, 65, "mirrored");
  fs::copy_file(path("v0.png"), path("again.png"));
  expect_pictures_refused({"v0.png", "v1.png", "again.png"}, 65, "again is the same photograph as v0");
  io::Image cropped(width - 20, height, {"Y"});
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width - 20; ++x) cropped.at(x, y, 0) = views_[1].at(x, y, 0);
  }
  io::write_picture(path("cropped.png"), cropped);
  expect_pictures_refused({"v0.png", "cropped.png"}, 65, "300 x 240 pixels, others");
}

TEST_F(CalibCharuco, FilesThatAreNoPictures) {
  const std::string whole = read_file(path("v0.png"));
  write_file(path("cut.png"), whole.substr(0, whole.size() / 2));
  expect_pictures_refused({"v1.png", "cut.png"}, 65, "cut.png: the PNG file is cut off");
  write_file(path("empty.png"), "");
  expect_pictures_refused({"empty.png"}, 65, "empty.png");
  fs::create_directory(path("folder.png"));
  expect_pictures_refused({"folder.png"}, 66, "folder.png");
  expect_pictures_refused({"none.png"}, 66, "none.png");
  write_file(path("v.bmp"), "BM");
  expect_pictures_refused({"v.bmp"}, 65, "v.bmp: is neither PNG");
  write_file(path("v.gif"), "GIF89a");
  expect_pictures_refused({"v.gif"}, 65, "'.gif' is not a picture");
}

TEST_F(CalibCharuco, BoardsThatCannotBeOrAreOthers) {
  const auto with = [](const char* square, const char* marker, const char* dictionary) {
    return Words{"--charuco", "7x5", "--square", square, "--marker", marker, "--dictionary", dictionary, "v0.png"};
  };
  expect_refused(with("-30mm", "22mm", "4X4_50"), 64, "--square");
  expect_refused(with("0mm", "22mm", "4X4_50"), 64, "--square");
  expect_refused(with("30mm", "30mm", "4X4_50"), 64, "the marker does not fit into its square");
  expect_refused(with("30mm", "22mm", "9X9_50"), 64, "9X9_50");
  expect_refused(with("30mm", "22mm", "6X6_50"), 65, "17 markers of 4X4_50");
  expect_refused({"--charuco", "25x18", "--square", "30mm", "--marker", "22mm", "--dictionary", "4X4_50", "v0.png"}, 64,
                 "the board needs 225");
  expect_refused({"--charuco", "7x5", "--square", "30mm", "--marker", "22mm", "v0.png"}, 64, "dictionary");
  expect_refused({"--checkerboard", "6x4", "v0.png"}, 64, "--square");
}

TEST_F(CalibCharuco, DictionariesOfOnesOwn) {
  const Words board{"--charuco", "7x5", "--square", "30mm", "--marker", "22mm", "--dictionary-file"};
  const auto with = [&](const char* file) {
    Words words = board;
    words.insert(words.end(), {file, "v0.png"});
    return words;
  };
  expect_refused(with("none.yml"), 66, "none.yml");
  write_file(path("few.yml"), "nmarkers: 2\nmarkersize: 3\nmarker_0: 110000010\nmarker_1: 101010010\n");
  expect_refused(with("few.yml"), 64, "few.yml has 2 markers, the board needs 17");
  write_file(path("same.yml"), "nmarkers: 2\nmarkersize: 3\nmarker_0: 110000010\nmarker_1: 001101000\n");
  expect_refused(with("same.yml"), 65, "are the same but for a turn");
  Words both = with("few.yml");
  both.insert(both.begin(), {"--dictionary", "4X4_50"});
  expect_refused(both, 64, "--dictionary");
}

TEST_F(CalibCharuco, ManifestsWithLooseEnds) {
  const std::string boards =
      R"("boards": {"b": {"kind": "charuco", "squares": [7, 5], "square_m": 0.03, "marker_m": 0.022, )"
      R"("dictionary": "4X4_50"}})";
  const auto manifest = [&](const std::string& rest) {
    write_file(path("m.json"), R"({"gonio": 1, "files": {"f": {"path": "v0.png"}}, )" + boards + ", " + rest + "}");
    return Words{"-i", "m.json"};
  };
  expect_refused(manifest(R"("images": [{"id": "i", "file": "f", "camera": "other"}], "cameras": {"c": {}})"), 65,
                 "m.json#/images/0/camera");
  expect_refused(manifest(R"("images": [{"id": "i", "file": "g"}])"), 65, "m.json#/images/0/file");
  expect_refused(manifest(R"("images": [{"id": "i", "file": "f", "board": "d"}])"), 65, "m.json#/images/0/board");
  expect_refused(manifest(R"("images": [])"), 65, "m.json#/images");
}

}  // namespace
}  // namespace gonio::tests
