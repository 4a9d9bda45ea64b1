// What steps ask of screens: the file's path, once, black where nothing is asked and at the end.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "acquisition/run/screen_switch.h"
#include "base/atomic_file.h"
#include "base/error.h"
#include "data.h"
#include "manifest/document.h"
#include "manifest/sections/laboratory.h"

namespace gonio::acquisition {
namespace {

struct NotingScreen : ScreenDevice {
  explicit NotingScreen(std::vector<std::string>& notes) : notes_(notes) {}
  void show(const std::string& path) override { notes_.push_back(path); }

 private:
  std::vector<std::string>& notes_;
};

TEST(Screens, ShowWhatAStepAsksAndAreBlackElse) {
  const tests::ScratchFolder folder;
  write_file(folder / "stripes.png", "a picture");
  const manifest::Document d = manifest::parse_document(R"({"gonio": 1, "files": {"stripes": {"path": "stripes.png"}},
    "laboratory": {"screens": {"lcd": {"url": "sim://", "kind": "lcd", "width_px": 4, "height_px": 3},
                               "beamer": {"url": "sim://", "kind": "projector", "width_px": 4, "height_px": 3}}}})",
                                                        "lab.json", folder.path());
  std::vector<std::string> lcd, beamer;
  Instrument instrument;
  instrument.screens["lcd"] = std::make_unique<NotingScreen>(lcd);
  instrument.screens["beamer"] = std::make_unique<NotingScreen>(beamer);
  ScreenSwitch screens(instrument, d);
  screens.show({{"lcd", "stripes"}}, "step 1");
  screens.show({{"lcd", "stripes"}}, "step 2");  // stays
  screens.show({{"beamer", "stripes"}}, "step 3");
  screens.show({}, "plan");
  const std::string path = (folder / "stripes.png").string();
  EXPECT_EQ(lcd, (std::vector<std::string>{path, ""}));
  EXPECT_EQ(beamer, (std::vector<std::string>{"", path, ""}));
  for (const auto& [wanted, words] : {std::pair<std::map<std::string, std::string>, const char*>{
                                          {{"wall", "stripes"}}, "which is no screen of the laboratory"},
                                      {{{"lcd", "dots"}}, "dots"}}) {
    try {
      screens.show(wanted, "step 4");
      ADD_FAILURE() << words;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Exit::data);
      EXPECT_THAT(error.what(), testing::HasSubstr(words));
    }
  }
}

}  // namespace
}  // namespace gonio::acquisition
