// Recorded data for tests: folders below $GONIO_DATA, by default ../shared/data beside the source tree. Where a set is
// missing the test is skipped; with GONIO_REQUIRE_DATA=1, as on the build server, it fails.
#pragma once
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

namespace gonio::tests {

inline std::filesystem::path data_root() {
  if (const char* given = std::getenv("GONIO_DATA"); given != nullptr && *given != 0) return given;
  return std::filesystem::path(GONIO_SOURCE).parent_path() / "shared" / "data";
}

inline bool data_is_required() {
  const char* required = std::getenv("GONIO_REQUIRE_DATA");
  return required != nullptr && std::string_view(required) == "1";
}

// The folder or file of a set ("calibration/charuco_flir_left"); it need not exist.
inline std::filesystem::path data(const char* set) {
  return data_root() / set;
}

// A folder of this test alone, empty at its start and removed at its end.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "gonio-test-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(std::string_view name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

}  // namespace gonio::tests

// First line of a test that reads recorded data.
#define GONIO_NEEDS_DATA(set)                                                                 \
  do {                                                                                        \
    if (std::filesystem::exists(gonio::tests::data(set))) break;                              \
    if (gonio::tests::data_is_required()) FAIL() << gonio::tests::data(set) << " is missing"; \
    GTEST_SKIP() << gonio::tests::data(set) << " is missing";                                 \
  } while (false)
