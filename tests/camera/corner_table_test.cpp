// The table of corners: what is written is what is read, inline and as CSV, and broken rows are named.
#include "camera/corner_table.h"

#include <gmock/gmock.h>

#include "base/atomic_file.h"
#include "base/error.h"
#include "data.h"
#include "manifest/document.h"
#include "manifest/sections/file.h"
#include "manifest/sections/table.h"

namespace gonio::camera {
namespace {

CornerTable example() {
  return {"c",
          "b",
          {{"left, \"01\"", {{0, {0, 0}, {100.1, 200.2}, 0.1}, {7, {0.025, 0.05}, {1.0 / 3, -2e-7}, 0.15, 0.25}}},
           {"left02", {{3, {0.075, 0}, {5, 6}, 0.2}}}}};
}

void expect_same(const CornerTable& a, const CornerTable& b) {
  EXPECT_EQ(a.camera, b.camera);
  EXPECT_EQ(a.board, b.board);
  ASSERT_EQ(a.images.size(), b.images.size());
  for (std::size_t i = 0; i < a.images.size(); ++i) {
    EXPECT_EQ(a.images[i].image, b.images[i].image);
    ASSERT_EQ(a.images[i].corners.size(), b.images[i].corners.size());
    for (std::size_t k = 0; k < a.images[i].corners.size(); ++k) {
      const TableCorner &p = a.images[i].corners[k], &q = b.images[i].corners[k];
      EXPECT_EQ(p.id, q.id);
      EXPECT_EQ(p.board_m, q.board_m);
      EXPECT_EQ(p.pixel, q.pixel);
      EXPECT_EQ(p.sigma_px, q.sigma_px);
      EXPECT_EQ(p.weight, q.weight);
    }
  }
}

TEST(CornerTable, InlineRowsReadBackTheSame) {
  manifest::Document document;
  write_corners(example(), "corners", {}, document);
  EXPECT_EQ(document.tables["corners"].model, "camera");
  expect_same(read_corners(document, "corners"), example());
}

TEST(CornerTable, CsvReadsBackTheSame) {
  const tests::ScratchFolder folder;
  manifest::Document document;
  document.folder = folder.path();
  write_corners(example(), "corners", folder / "corners.csv", document);
  EXPECT_FALSE(document.tables["corners"].rows.is_array());
  expect_same(read_corners(document, "corners"), example());
}

void expect_refused(const std::string& csv, const std::string& words) {
  const tests::ScratchFolder folder;
  manifest::Document document;
  document.folder = folder.path();
  write_corners(example(), "corners", folder / "corners.csv", document);
  write_file(folder / "corners.csv", csv);
  document.files.begin()->second.bytes.reset();
  document.files.begin()->second.sha256.clear();
  try {
    read_corners(document, "corners");
    FAIL() << "accepted: " << csv;
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), Exit::data);
    EXPECT_THAT(e.what(), testing::HasSubstr(words));
  }
}

TEST(CornerTable, BrokenRowsAreNamed) {
  const std::string header = "image,corner,board_x_m,board_y_m,u_px,v_px,sigma_px\n";
  expect_refused("image,corner,board_x_m,board_y_m,u_px,v_px\n", "sigma_px is missing");
  expect_refused(header + "a,1,0,0,3,4,0.1\na,2,0,0,3,4\n", "corners.csv:3");
  expect_refused(header + "a,1,0,0,3,four,0.1\n", "\"four\"");
  expect_refused(header + "a,1,0,0,3,nan,0.1\n", "v_px");
  expect_refused(header + "a,1,0,0,3,4,0\n", "sigma_px");
  expect_refused(header + "a,1e300,0,0,3,4,1\n", "corner");
  expect_refused("image,corner,board_x_m,board_y_m,u_px,v_px,sigma_px,weight\na,1,0,0,3,4,1,-1\n", "weight");
  manifest::Document none;
  EXPECT_THROW(read_corners(none, "corners"), Error);
}

}  // namespace
}  // namespace gonio::camera
