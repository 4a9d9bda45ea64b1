// Bodies and printers for tests of dlp-slice, and its calls.
#pragma once
#include <gmock/gmock.h>

#include <fstream>
#include <set>

#include "base/atomic_file.h"
#include "data.h"
#include "manifest/document.h"
#include "manifest/sections/print.h"
#include "process.h"

namespace gonio::tests {

namespace fs = std::filesystem;
using Words = Process::Words;

// A box about the origin, outward, as OBJ; millimetres.
inline std::string box_obj(double x, double y, double z) {
  std::string text;
  for (int k = 0; k < 8; ++k)
    text += "v " + std::to_string(k & 1 ? x : -x) + " " + std::to_string(k & 2 ? y : -y) + " " +
            std::to_string(k & 4 ? z : 0) + "\n";
  for (const char* face : {"1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6"})
    text += std::string("f ") + face + "\n";
  return text;
}

class DlpSlice : public testing::Test {
 protected:
  DlpSlice() {
    write_file(path("box.obj"), box_obj(0.6, 0.4, 0.09));
    write_file(path("printer.json"), printer_text());
  }
  static std::string printer_text(const std::string& more = "") {
    return R"({"gonio": 1, "prints": {"bench": {"pixel_m": [1e-5, 1e-5], "width_px": 200, "height_px": 160,
      "layer_m": 1.8e-5,
      "growth": {"alpha_m": 1.8e-5, "beta_m": 1.024e-5, "gamma": -0.01},
      "process": {"exposure_s": 3, "bottom_exposure_s": 20, "bottom_layers": 2, "lift_m": 0.004,
                  "lift_m_per_s": 0.002}})" +
           more + "}}";
  }
  fs::path path(const std::string& name) const { return folder_ / name; }
  std::set<fs::path> files() const {
    std::set<fs::path> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder_.path()))
      if (!entry.is_directory()) names.insert(entry.path());
    return names;
  }
  Ended call(const Words& options) const {
    Words words{"dlp-slice", "--log-level", "error"};
    words.insert(words.end(), options.begin(), options.end());
    return run(words, folder_.path());
  }
  Ended sliced(const Words& options, const std::string& out = "out") const {
    Words words{"box.obj", "--unit", "mm", "--printer", "printer.json", "--out", out, "-o", out + ".json"};
    words.insert(words.end(), options.begin(), options.end());
    return call(words);
  }
  void expect_refused(const Words& options, int status, const std::string& mentions) const {
    const auto before = files();
    const Ended ended = call(options);
    EXPECT_EQ(ended.status, status) << ended.err;
    EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
    EXPECT_THAT(ended.err, testing::StartsWith("dlp-slice: "));
    EXPECT_THAT(ended.err, testing::HasSubstr(mentions));
    EXPECT_EQ(ended.out, "");
    EXPECT_EQ(files(), before);
  }
  manifest::Document document(const std::string& name) const { return manifest::read_document(path(name)); }

  ScratchFolder folder_;
};

}  // namespace gonio::tests
