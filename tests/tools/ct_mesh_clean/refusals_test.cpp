// What ct-mesh-clean refuses: one clear line, the right code, nothing written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/atomic_file.h"
#include "data.h"
#include "process.h"
#include "tools/ct_mesh_clean/shapes.h"

namespace gonio::tests {
namespace {

using testing::HasSubstr;

class Refusals : public testing::Test {
 protected:
  static const std::filesystem::path& folder() {
    static const ScratchFolder scratch;
    static const bool made = [&] {
      const io::VolumeData ball_volume = volume_of(24, {ball({11.5, 11.5, 11.5}, 7, 2100)}, 30, 1);
      io::write_nrrd(scratch / "ball.nrrd", ball_volume);
      io::write_nrrd(scratch / "bare.nrrd", volume_of(24, {ball({11.5, 11.5, 11.5}, 7, 2100)}, 30, 1, {}));
      io::write_nrrd(scratch / "flat.nrrd", volume_of(16, {}, 0, 1));
      const std::string whole = read_file(scratch / "ball.nrrd");
      write_file(scratch / "short.nrrd", whole.substr(0, whole.size() - 1000));
      write_file(scratch / "huge.nrrd",
                 "NRRD0004\ntype: uint16\ndimension: 3\nsizes: 4000000 4000000 4000000\n"
                 "endian: little\nencoding: raw\n\n1234");
      write_file(scratch / "text.txt", "no volume at all");
      io::VolumeData holes = ball_volume;
      holes.head.type = io::VoxelType::f32;
      holes.values[500] = std::numeric_limits<float>::quiet_NaN();
      write_file(scratch / "nan.raw",
                 std::string(reinterpret_cast<const char*>(holes.values.data()), 4 * holes.values.size()));
      return true;
    }();
    (void)made;
    return scratch.path();
  }

  static void refused(std::vector<std::string> words, int status, const std::string& says) {
    words.insert(words.begin(), "ct-mesh-clean");
    if (status != 64 && std::ranges::find(words, "--out") == words.end()) words.insert(words.end(), {"--out", "o"});
    const auto before = std::filesystem::recursive_directory_iterator(folder());
    std::size_t files = 0, after = 0;
    for (const auto& e : before) files += e.is_regular_file();
    const Ended ended = run(words, folder());
    std::string line;
    for (const std::string& w : words) line += w + " ";
    EXPECT_EQ(ended.status, status) << line << ended.err;
    EXPECT_THAT(ended.err, HasSubstr(says)) << line;
    EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << line << ended.err;
    EXPECT_EQ(ended.out, "") << line;
    for (const auto& e : std::filesystem::recursive_directory_iterator(folder())) after += e.is_regular_file();
    EXPECT_EQ(files, after) << line;
  }
};

TEST_F(Refusals, CommandLines) {
  refused({"--voxel", "12", "ball.nrrd"}, 64, "--voxel");
  refused({"--voxel", "1kg", "ball.nrrd"}, 64, "--voxel");
  refused({"--voxel", "0mm", "ball.nrrd"}, 64, "--voxel");
  refused({"--voxel", "1mm,2mm", "ball.nrrd"}, 64, "2 lengths");
  refused({"--size", "24x24", "ball.nrrd"}, 64, "--size");
  refused({"--tiles", "ax4", "ball.nrrd"}, 64, "--tiles");
  refused({"--type", "uint7", "ball.nrrd"}, 64, "--type");
  refused({"--threshold", "somewhere", "ball.nrrd"}, 64, "--threshold");
  refused({"--threshold", "reference", "ball.nrrd"}, 64, "known diameter");
  refused({"--threshold", "nan", "ball.nrrd"}, 64, "--threshold");
  refused({"--threshold", "inf", "ball.nrrd"}, 64, "--threshold");
  refused({"--box", "1,2,3", "ball.nrrd"}, 64, "--box");
  refused({"--box", "nan,0,0,9,9,9", "ball.nrrd"}, 64, "--box");
  refused({"--markers", "-1mm", "ball.nrrd"}, 64, "--markers");
  refused({"--marker-threshold", "4", "ball.nrrd"}, 64, "--markers");
  refused({"--within", "0.2", "ball.nrrd"}, 64, "--within");
  refused({"--within", "0voxel", "ball.nrrd"}, 64, "--within");
  refused({"--limit-distance", "far", "ball.nrrd"}, 64, "--limit-distance");
  refused({"--faces", "3", "ball.nrrd"}, 64, "--faces");
  refused({"--index", "0.5", "ball.nrrd"}, 64, "--index");
  refused({}, 64, "VOLUME");
  refused({"--specimen", "ornament"}, 64, "--out");
  refused({"ball.nrrd"}, 64, "--out");
  refused({"--specimen", "teapot", "--out", "o"}, 64, "--specimen");
}

// Folders that were there, or hold something, stay.
TEST_F(Refusals, NoFolderIsLeftBehind) {
  refused({"--threshold", "9000", "--out", "deep/er/o", "ball.nrrd"}, 65, "nothing inside");
  EXPECT_FALSE(std::filesystem::exists(folder() / "deep"));
  std::filesystem::create_directory(folder() / "mine");
  refused({"--threshold", "9000", "--out", "mine", "ball.nrrd"}, 65, "nothing inside");
  refused({"--threshold", "9000", "--out", "mine/o", "ball.nrrd"}, 65, "nothing inside");
  EXPECT_TRUE(std::filesystem::exists(folder() / "mine"));
  EXPECT_FALSE(std::filesystem::exists(folder() / "mine/o"));
}

TEST_F(Refusals, Files) {
  refused({"absent.nrrd"}, 66, "absent.nrrd");
  refused({"text.txt"}, 65, "text.txt");
  refused({"short.nrrd"}, 65, "short.nrrd");
  refused({"huge.nrrd"}, 65, "huge.nrrd");
  refused({"bare.nrrd"}, 65, "--voxel 120um");
  refused({"--voxel", "1mm", "nan.raw"}, 65, "nan.raw");
  refused({"--voxel", "1mm", "--size", "24x24x24", "--type", "float32", "nan.raw"}, 65, "nan.raw");
  refused({"--voxel", "1mm", "--size", "24x24x25", "--type", "float32", "nan.raw"}, 65, "nan.raw");
  refused({"--voxel", "0.3mm", "ball.nrrd"}, 65, "ball.nrrd");
}

TEST_F(Refusals, VolumesThatHoldNoObject) {
  refused({"flat.nrrd"}, 65, "flat.nrrd");
  refused({"--threshold", "9000", "ball.nrrd"}, 65, "nothing inside");
  refused({"--threshold", "-5", "ball.nrrd"}, 65, "nothing outside");
  refused({"--at-least", "100000", "ball.nrrd"}, 65, "none of its");
  refused({"--brighter", "5000", "ball.nrrd"}, 65, "none of its");
  refused({"--markers", "5mm", "ball.nrrd"}, 65, "marker");
  refused({"--markers", "0.4mm", "--marker-threshold", "9000", "ball.nrrd"}, 65, "ball.nrrd");
}

}  // namespace
}  // namespace gonio::tests
