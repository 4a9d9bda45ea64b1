// Marked corners, from CSV files and from tables of the manifest (contrast/measure/corner_marks.h).
#include "contrast/measure/corner_marks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "base/error.h"
#include "base/text.h"
#include "camera/intrinsics.h"
#include "io/csv.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/table.h"

namespace gonio::contrast {
namespace {

struct Columns {
  std::size_t image, corner, u, v;
  std::optional<std::size_t> sigma;
};

Columns columns_of(const std::vector<std::string>& names, const std::string& place) {
  const auto find = [&](const char* name) -> std::optional<std::size_t> {
    const auto at = std::ranges::find(names, name);
    if (at == names.end()) return std::nullopt;
    return static_cast<std::size_t>(at - names.begin());
  };
  const auto needed = [&](const char* name) {
    const auto at = find(name);
    if (!at)
      throw Error(Exit::data, place, std::string("has no column \"") + name + "\"",
                  "corners are a table of image, corner, u_px, v_px, and sigma_px if known");
    return *at;
  };
  return {needed("image"), needed("corner"), needed("u_px"), needed("v_px"), find("sigma_px")};
}

void check_in_picture(const CornerMark& mark, const std::string& camera, const manifest::Document& document) {
  const auto [width, height] = camera::picture_size_px(document, camera);
  if (width == 0) return;
  if (mark.pixel.x < -0.5 || mark.pixel.y < -0.5 || mark.pixel.x > width - 0.5 || mark.pixel.y > height - 0.5)
    throw Error(Exit::data, mark.place,
                format("puts corner %d at (%g, %g) px, outside the picture of %d x %d px", mark.corner, mark.pixel.x,
                       mark.pixel.y, width, height),
                "mark corners that the picture shows, and leave out the others");
}

CornerMark mark_of(const std::vector<std::string>& row, const Columns& columns, const std::string& place,
                   const manifest::Document& document) {
  CornerMark mark;
  mark.place = place;
  mark.image = row[columns.image];
  const auto image = manifest::index_of_image(document, mark.image);
  if (!image) {
    const auto listed = names_in(document, "images");
    throw Error(Exit::data, place, "names the image \"" + mark.image + "\", which is not in the manifest",
                listed.empty() ? "" : "its first image is \"" + listed.front() + "\"");
  }
  const double corner = io::csv_number(row[columns.corner], place);
  if (corner != 0 && corner != 1 && corner != 2 && corner != 3)
    throw Error(Exit::data, place, "has the corner " + row[columns.corner],
                "corners are 0, 1, 2, 3: clockwise from the sample's top left");
  mark.corner = static_cast<int>(corner);
  mark.pixel = {io::csv_number(row[columns.u], place), io::csv_number(row[columns.v], place)};
  if (columns.sigma) {
    mark.sigma_px = io::csv_number(row[*columns.sigma], place);
    if (!(mark.sigma_px > 0))
      throw Error(Exit::data, place, "has sigma_px = " + row[*columns.sigma], "a standard deviation is above 0 px");
  }
  check_in_picture(mark, manifest::camera_of_image(document, *image), document);
  return mark;
}

std::string text_of(const manifest::Value& cell, const std::string& place) {
  if (cell.is_string()) return cell.as_string();
  if (cell.is_number()) return shortest_text(cell.as_number());
  throw Error(Exit::data, place, "is neither a number nor a name");
}

}  // namespace

std::vector<CornerMark> read_marks(const std::filesystem::path& path, const manifest::Document& document) {
  const io::Csv csv = io::read_csv(path);
  const Columns columns = columns_of(csv.header, csv.name);
  std::vector<CornerMark> marks;
  for (std::size_t row = 0; row < csv.rows.size(); ++row)
    marks.push_back(mark_of(csv.rows[row], columns, csv.place(row), document));
  check_marks(marks);
  return marks;
}

std::vector<CornerMark> table_marks(const manifest::Document& document, const std::string& name) {
  const auto found = document.tables.find(name);
  const std::string place = manifest::place(document, "/tables/" + name);
  if (found == document.tables.end())
    throw Error(Exit::data, place, "is not in the manifest", "enter the marked corners there, or give --corners FILE");
  const manifest::Table& table = found->second;
  if (!table.file.empty())
    return read_marks(manifest::resolve(document, table.file, "/tables/" + name + "/file"), document);
  std::vector<std::string> names;
  for (const auto& [column, unit] : table.columns) names.push_back(column);
  const Columns columns = columns_of(names, place);
  std::vector<CornerMark> marks;
  if (!table.rows.is_array()) throw Error(Exit::data, place, "has neither a file nor rows");
  for (std::size_t i = 0; i < table.rows.as_array().size(); ++i) {
    const manifest::Value& row = table.rows.as_array()[i];
    const std::string at = place + "/rows/" + std::to_string(i);
    if (!row.is_array() || row.as_array().size() != names.size())
      throw Error(Exit::data, at,
                  "does not have one value for each of the " + std::to_string(names.size()) + " columns");
    std::vector<std::string> cells;
    for (const manifest::Value& cell : row.as_array()) cells.push_back(text_of(cell, at));
    marks.push_back(mark_of(cells, columns, at, document));
  }
  check_marks(marks);
  return marks;
}

void check_marks(const std::vector<CornerMark>& marks) {
  std::map<std::string, std::array<const CornerMark*, 4>> by_image;
  for (const CornerMark& mark : marks) {
    const CornerMark*& seen = by_image[mark.image][static_cast<std::size_t>(mark.corner)];
    if (seen != nullptr)
      throw Error(Exit::data, mark.place,
                  "marks corner " + std::to_string(mark.corner) + " of \"" + mark.image +
                      "\" again (first: " + seen->place + ")",
                  "mark every corner of an image once");
    seen = &mark;
  }
  for (const auto& [image, four] : by_image) {
    if (std::ranges::find(four, nullptr) != four.end()) continue;
    for (std::size_t k = 0; k < 4; ++k) {  // y points down: clockwise as seen turns from x to y
      const Vec2 a = four[(k + 1) % 4]->pixel - four[k]->pixel, b = four[(k + 2) % 4]->pixel - four[(k + 1) % 4]->pixel;
      if (!(a.x * b.y - a.y * b.x > 0))
        throw Error(Exit::data, four[0]->place, "begins corners of \"" + image + "\" that do not go round clockwise",
                    "number the corners 0 to 3 clockwise as seen, from the sample's top left");
    }
  }
}

}  // namespace gonio::contrast
