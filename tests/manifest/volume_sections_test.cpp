// Sections about volumes and markers: typed, checked, changed entry by entry.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "manifest/document.h"
#include "manifest/sections/file.h"
#include "manifest/sections/volume.h"

namespace gonio::manifest {
namespace {

TEST(VolumeSections, StandInADocument) {
  Document d;
  d.files["f"].path = "pot.nrrd";
  Volume& pot = d.volumes["pot"];
  pot.file = "f", pot.size = {4, 5, 6}, pot.spacing_m = {1e-4, 1e-4, 2e-4};
  pot.volume_from_index = IndexMap{{{1e-4, 0, 0, 0}, {0, 1e-4, 0, 0}, {0, 0, 2e-4, 0}, {0, 0, 0, 1}}};
  pot.steps.push_back({.name = "threshold", .how = "half-way", .figures = {{"value", 0.3}}, .picture = ""});
  d.markers.push_back({.id = "a", .volume = "pot", .centre_m = {0, 0, 1e-3}, .radius_m = 2.5e-3});
  const Document again = parse_document(print_document(d, "."), "m", ".");
  EXPECT_EQ(again.volumes.at("pot").steps.at(0).figures.at("value"), 0.3);
  EXPECT_EQ(again.volumes.at("pot").volume_from_index->matrix.size(), 4u);
  EXPECT_EQ(again.markers.at(0).radius_m, 2.5e-3);
  EXPECT_NE(content_id(d), content_id(Document()));
}

TEST(VolumeSections, RefuseWhatDoesNotExistOrHasAnotherShape) {
  const auto refusal = [](const std::string& section) {
    try {
      parse_document(R"({"gonio": 1, "files": {"f": {"path": "a"}}, )" + section + "}", "m.json", ".");
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string("none");
  };
  using testing::HasSubstr;
  EXPECT_THAT(refusal(R"("volumes": {"a": {"file": "g"}})"), HasSubstr("m.json#/volumes/a/file: names \"g\""));
  EXPECT_THAT(refusal(R"("volumes": {"a": {"file": "f", "size": [4, 4]}})"),
              HasSubstr("/volumes/a/size: has 2 numbers, needs 3"));
  EXPECT_THAT(refusal(R"("volumes": {"a": {"file": "f", "spacing_m": [1e-4, 0, 1e-4]}})"), HasSubstr("/spacing_m"));
  EXPECT_THAT(refusal(R"("volumes": {"a": {"file": "f", "volume_from_index": {"matrix": [[1, 2]]}}})"),
              HasSubstr("/volume_from_index/matrix"));
  EXPECT_THAT(refusal(R"("volumes": {"a": {"file": "f", "mesh": "m"}})"), HasSubstr("/volumes/a/mesh"));
  EXPECT_THAT(refusal(R"("markers": [{"id": "m", "centre_m": [0, 0]}])"), HasSubstr("/markers/0/centre_m"));
  EXPECT_THAT(refusal(R"("markers": [{"id": "m", "centre_m": [0, 0, 0], "covariance_m2": [1]}])"),
              HasSubstr("/markers/0/covariance_m2"));
  EXPECT_THAT(refusal(R"("markers": [{"id": "m", "centre_m": [0, 0, 0], "volume": "v"}])"),
              HasSubstr("/markers/0/volume"));
  EXPECT_THAT(refusal(R"("markers": [{"id": "m", "centre_m": [0, 0, 0]}, {"id": "m", "centre_m": [0, 0, 0]}])"),
              HasSubstr("/markers"));
  EXPECT_EQ(refusal(R"("volumes": {"a": {"file": "f"}})"), "none");
}

}  // namespace
}  // namespace gonio::manifest
