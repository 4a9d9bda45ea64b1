// Pictures of a rig find their cameras and shots by name, or the program says which name it cannot read.
#include <gtest/gtest.h>

#include "base/atomic_file.h"
#include "base/error.h"
#include "camera/calibrate_document.h"
#include "data.h"
#include "manifest/document.h"
#include "manifest/sections/image.h"

namespace gonio::camera {
namespace {

struct Entered {
  std::string camera, shot;
};

std::vector<Entered> entered(const std::vector<std::string>& cameras, const std::vector<std::string>& names) {
  const tests::ScratchFolder folder;
  manifest::Document document;
  document.allow_outside = true;
  std::vector<std::string> paths;
  for (const std::string& name : names) {
    const std::filesystem::path path = folder / name;
    std::filesystem::create_directories(path.parent_path());
    write_file(path, "x");
    paths.push_back(path.string());
  }
  enter_rig(cameras, paths, "pinhole", document);
  std::vector<Entered> list;
  for (const manifest::ImageEntry& image : document.images) list.push_back({image.camera, image.shot});
  return list;
}

TEST(RigNames, FilesOrFoldersNameTheCamera) {
  const auto files = entered({"left", "right"}, {"left01.jpg", "left02.jpg", "right02.jpg", "right01.jpg"});
  ASSERT_EQ(files.size(), 4U);
  EXPECT_EQ(files[0].camera, "left");
  EXPECT_EQ(files[3].camera, "right");
  EXPECT_EQ(files[0].shot, files[3].shot);
  EXPECT_EQ(files[1].shot, files[2].shot);
  EXPECT_NE(files[0].shot, files[1].shot);
  const auto folders = entered({"cam1", "cam10"}, {"cam1/000.png", "cam10/000.png"});
  EXPECT_EQ(folders[0].camera, "cam1");
  EXPECT_EQ(folders[1].camera, "cam10");
  EXPECT_EQ(folders[0].shot, folders[1].shot);
}

TEST(RigNames, DoubtIsRefused) {
  EXPECT_THROW(entered({"left", "right"}, {"left01.jpg", "middle01.jpg"}), Error);
  EXPECT_THROW(entered({"left", "right"}, {"left-right01.jpg"}), Error);
  EXPECT_THROW(entered({"left", "right"}, {"left01.jpg", "right02.jpg"}), Error);
  EXPECT_THROW(entered({"left", "right"}, {"left01.jpg", "left01.png", "right01.jpg"}), Error);
}

}  // namespace
}  // namespace gonio::camera
