// What no program need load before it is asked for something.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>

namespace gonio {
namespace {

// As ldd does it: the loader lists what it would load before this executable starts.
std::string libraries_at_start() {
  const std::string own = std::filesystem::read_symlink("/proc/self/exe").string();
  std::string text;
  std::FILE* const pipe = ::popen(("LD_TRACE_LOADED_OBJECTS=1 '" + own + "'").c_str(), "r");
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) text += static_cast<char>(c);
  EXPECT_EQ(::pclose(pipe), 0);
  return text;
}

// OpenCV's codecs bring GDAL along, which takes longer to load than most tests run; io/opencv_codecs.h.
TEST(Startup, PictureCodecsAreNotLoaded) {
  const std::string libraries = libraries_at_start();
  EXPECT_THAT(libraries, testing::HasSubstr("/libopencv_core"));
  EXPECT_THAT(libraries, testing::Not(testing::HasSubstr("/libopencv_imgcodecs")));
  EXPECT_THAT(libraries, testing::Not(testing::HasSubstr("/libgdal")));
}

// What modules (base/loaded_library.h) are linked with, and what that brings along. This program reads photographs, and
// what it is linked with all programs are: with these libraries the start of each took 0.1 s of processor time.
TEST(Startup, LibrariesOfModulesAreNotLoaded) {
  const std::string libraries = libraries_at_start();
  for (const char* name : {"/libpcl_", "/libvtk", "/libfcl", "/libompl", "/libgdcm", "/libopencv_video",
                           "/libopencv_dnn", "/libprotobuf", "/libmatio", "/libhdf5", "/libcurl"})
    EXPECT_THAT(libraries, testing::Not(testing::HasSubstr(name)));
}

}  // namespace
}  // namespace gonio
