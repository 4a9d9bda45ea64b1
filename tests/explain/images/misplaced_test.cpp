// Files of other pictures in a set of images: said first and before any physics, with the scene left as it was given.
// One process: Misplaced.*
#include <gmock/gmock.h>

#include "ball_world.h"
#include "base/atomic_file.h"
#include "explain/explain_document.h"
#include "explain/images/images_problem.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "manifest/sections/image.h"
#include "manifest/sections/surface.h"
#include "schema_check.h"

namespace gonio::tests {
namespace {

using testing::HasSubstr;

// Every picture once, in little time: the files are exchanged in the manifest.
class Misplaced : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder() = new ScratchFolder();
    taken() = new manifest::Document(record_ball(*folder(), "", "", 24, 3));
  }
  static void TearDownTestSuite() {
    delete taken();
    delete folder();
  }
  // The file of the first is that of the second, and so on.
  static manifest::Document with(const std::vector<std::pair<std::string, std::string>>& files) {
    manifest::Document document = *taken();
    for (const auto& [image, file] : files)
      for (manifest::ImageEntry& entry : document.images)
        if (entry.id == image) entry.file = file;
    return document;
  }
  static explain::ExplainRequest request() {
    explain::ExplainRequest request;
    request.options.draws = 99;
    request.options.negative_controls = 2;
    request.page = *folder() / "page.html";
    return request;
  }
  static ScratchFolder*& folder() {
    static ScratchFolder* one = nullptr;
    return one;
  }
  static manifest::Document*& taken() {
    static manifest::Document* one = nullptr;
    return one;
  }
};

TEST_F(Misplaced, FilesInTheirPlacesKeepTheirHypotheses) {
  const explain::images::ImagesProblem problem(*taken());
  EXPECT_FALSE(problem.candidates().empty());
}

TEST_F(Misplaced, TwoViewsSwapped) {
  manifest::Document document = with({{"00", "10"}, {"10", "00"}});
  const auto before = document.surfaces.at("ball").parameters.at("albedo");
  EXPECT_EQ(explain_document(document, request()), Exit::negative);
  expect_described(manifest::print_document(document, document.folder));
  manifest::Value entry = document.explanations.at(0);
  EXPECT_EQ(entry["verdict"].as_string(), "unknown");
  ASSERT_EQ(entry["misplaced"].as_array().size(), 2u);
  EXPECT_EQ(entry["misplaced"].as_array()[0]["group"].as_string(), "00");
  EXPECT_EQ(entry["misplaced"].as_array()[0]["shows"].as_string(), "10");
  EXPECT_THAT(entry["sentence"].as_string(),
              testing::StartsWith("The file of image `00` fits what `10` should show (error"));
  EXPECT_THAT(entry["sentence"].as_string(), HasSubstr("are two file names swapped? No physics is asked before that"));
  EXPECT_EQ(document.surfaces.at("ball").parameters.at("albedo").value, before.value);
  const std::string page = read_file(*folder() / "page.html");
  EXPECT_THAT(page, HasSubstr("Which files belong elsewhere"));
  EXPECT_THAT(page, HasSubstr("are two file names swapped?"));
}

TEST_F(Misplaced, LampsSwappedInEveryView) {
  const explain::images::ImagesProblem problem(with({{"00", "01"}, {"01", "00"}, {"10", "11"}, {"11", "10"}}));
  explain::Explanation e;
  problem.conclude(e);
  EXPECT_THAT(e.misplaced.sentence, testing::StartsWith("In two views the file under `lamp-0` fits what should be seen "
                                                        "under `lamp-1`, and the reverse"));
  EXPECT_TRUE(problem.candidates().empty());
}

TEST_F(Misplaced, ThreeInACycleAndOneUsedTwice) {
  const explain::images::ImagesProblem cycle(with({{"00", "11"}, {"11", "02"}, {"02", "00"}}));
  explain::Explanation e;
  cycle.conclude(e);
  EXPECT_THAT(e.misplaced.sentence, testing::EndsWith("are three file names mixed up?"));
  const explain::images::ImagesProblem twice(with({{"00", "12"}}));
  twice.conclude(e);
  EXPECT_THAT(e.misplaced.sentence, testing::EndsWith("so does the file of `12` itself: was one file used twice?"));
}

}  // namespace
}  // namespace gonio::tests
